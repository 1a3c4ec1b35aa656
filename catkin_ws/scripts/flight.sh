# shellcheck shell=bash
# From problem files to maps, from maps to a recorded flight, from the flight to a report.

map_axes="longitudinal lateral vertical"

# mapKey PROBLEM: changes when the problem file or the solver does.
mapKey() { cat "$1" build/bin/offline_mpt | sha256sum | cut -d ' ' -f 1; }

# solveMap PROBLEM MAP: solves unless the map was made from the same problem file by the same tool.
solveMap() {
  local key
  key=$(mapKey "$1")
  if [ -s "$2" ] && [ "$(cat "$2.key" 2> /dev/null)" = "$key" ]; then
    echo "$2 is up to date."
    return 0
  fi
  rm -f "$2.key"
  build/bin/offline_mpt solve "$1" -o "$2" --threads "$(nproc)" --stats "${2%.map}.stats.json" || return
  echo "$key" > "$2.key"
}

# solveAxes [PROBLEMS MAPS [VEHICLE]]: the three axes, from a folder of problem files into a folder of maps.
solveAxes() {
  local axis problems=${1:-region_maps/problems} maps=${2:-build/demo/maps} vehicle=${3:-multirotor}
  own demo
  mkdir -p "$maps"
  for axis in $map_axes; do
    solveMap "$problems/${vehicle}_$axis.yaml" "$maps/${vehicle}_$axis.map" || return
  done
}

# fly FOLDER MAPS [roslaunch argument...]: one flight, recorded in FOLDER/flight.bag, under a ROS master of its own.
fly() {
  local folder=$1 maps=$2 port
  shift 2
  mkdir -p "$folder"
  rm -f "$folder/flight.bag" "$folder/flight.bag.active"
  port=$(freePort)
  unset ROS_HOSTNAME
  export ROS_MASTER_URI=http://127.0.0.1:$port ROS_IP=127.0.0.1
  inWorkspace timeout --signal=INT --kill-after=10 300 roslaunch --port="$port" polyfly_launch demo.launch \
    maps_dir:="$(realpath "$maps")" bag:="$(realpath "$folder")/flight.bag" "$@" || return
  if [ ! -s "$folder/flight.bag" ]; then
    echo "the flight left no bag: $folder/flight.bag" >&2
    return 1
  fi
}

# validateFlight FOLDER MAPS [validate_bag option...]: FOLDER/summary.json and FOLDER/report/index.html.
validateFlight() {
  local folder=$1 maps=$2 axis
  local -a options=()
  shift 2
  for axis in $map_axes; do
    options+=(--map "$maps/multirotor_$axis.map")
  done
  build/bin/validate_bag --bag "$folder/flight.bag" "${options[@]}" --options launch/config/firefly.yaml --json "$folder/summary.json" \
    --report "$folder/report" "$@"
}

# exploreFlight FOLDER MAPS: a page for each map with the samples of the flight, beside the report.
exploreFlight() {
  local axis
  for axis in $map_axes; do
    build/bin/offline_mpt explore "$2/multirotor_$axis.map" --samples "$1/report/samples_$axis.csv" \
      -o "$1/report/explore_$axis.html" || return
  done
}

# sayResult FOLDER: the numbers that matter and where to look.
sayResult() {
  python3 - "$1" <<'PY'
import json, sys
folder = sys.argv[1]
with open(folder + "/summary.json") as file:
    summary = json.load(file)
for key, unit in [("regions", ""), ("regions_visited", ""), ("tracking_rms_m", "m"), ("constraint_violations", ""),
                  ("coverage", ""), ("outside_map_samples", ""), ("max_qp_difference", ""), ("lookup_ns_p50", "ns"), ("lookup_ns_p99", "ns")]:
    if key in summary:
        print(f"  {key:24} {summary[key]:.6g} {unit}".rstrip())
for name, value, unit in summary.get("headline", []):
    print(f"  {name:40} {value:.6g} {unit}".rstrip())
PY
  say "  report: $1/report/index.html"
  say "  maps: $1/report/explore_lateral.html and the other axes"
  say "  numbers: $1/summary.json"
}
