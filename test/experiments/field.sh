# shellcheck shell=bash
# A day in the field: a vehicle whose inner loops are not those of the problem files. It is flown with the maps as they are,
# excited on three flights in wind, of which the last one ends in a tumble, and calibrated from all three. Then it is flown
# with maps of the calibrated problems, and in the ranges that the validation of that flight proposes. At last the bag of that
# flight is damaged: its validation must not be green.
rm -rf "$output"
mkdir -p "$output/problems" "$output/maps" "$output/report"

# What the tools are not told: slower and weaker loops than the problem files say (0.9, 0.25 s; 0.9, 0.255 s). Without the
# demo's push, whose answer is no tracking of a reference.
hidden="$output/hidden.yaml"
cat > "$hidden" << 'YAML'
plant:
  vehicle: {roll_gain: 0.68, roll_time: 0.42, pitch_gain: 0.72, pitch_time: 0.38, kick_time: 0.0}
YAML

# The same vehicle loses a rotor at this time [s].
loseRotorAt() {
  cat << YAML
plant:
  vehicle: {roll_gain: 0.68, roll_time: 0.42, pitch_gain: 0.72, pitch_time: 0.38, kick_time: 0.0,
            tumble_start: $1, tumble_time: 100.0}
YAML
}

# plannedDuration: of the plan of launch/config/excitation.yaml [s].
plannedDuration() {
  build/bin/excite --plan launch/config/excitation.yaml > "$output/plan.txt" || return
  awk 'NR == 1 {for (i = 1; i < NF; ++i) if ($(i + 1) == "s") {print $i; exit}}' "$output/plan.txt"
}

# excite NAME DURATION OVERRIDES [roslaunch argument...]: the plan, flown by the exciting node, into NAME.bag.
exciteVehicle() {
  local name=$1 duration=$2 overrides=$3 port
  shift 3
  port=$(freePort)
  unset ROS_HOSTNAME
  export ROS_MASTER_URI=http://127.0.0.1:$port ROS_IP=127.0.0.1
  inWorkspace timeout --signal=INT --kill-after=10 300 roslaunch --port="$port" polyfly_launch excite_demo.launch \
    bag:="$(realpath "$output")/$name.bag" duration:="$duration" overrides:="$(realpath "$overrides")" "$@" || return
  [ -s "$output/$name.bag" ] || { echo "the excitation left no bag: $output/$name.bag" >&2; return 1; }
}

# flyHidden NAME MAPS [validate_bag option...]: the demo's figure with the hidden vehicle.
flyHidden() {
  local name=$1 maps=$2
  shift 2
  fly "$output/$name" "$maps" overrides:="$(realpath "$hidden")" || return
  validateFlight "$output/$name" "$maps" --min-coverage 0 --topics-bag "$output/$name/topics.bag" "$@"
}

# widen PROBLEMS SUMMARY FOLDER: the problems, with the ranges that a validation proposes, into the folder.
widen() {
  python3 - "$@" << 'PY'
import json, os, sys
import yaml
problems, summary, folder = sys.argv[1:]
with open(summary) as file:
    axes = json.load(file)["axes"]
proposed = {use["name"]: use["proposed_range"] for axis in axes for use in axis["parameters"]}
for name in os.listdir(problems):
    with open(os.path.join(problems, name)) as file:
        problem = yaml.safe_load(file)
    for parameter in problem["parameters"]:
        if "range" in parameter and parameter["name"] in proposed:
            parameter["range"] = proposed[parameter["name"]]
    with open(os.path.join(folder, name), "w") as file:
        yaml.safe_dump(problem, file)
PY
}

# damage BAG COPY: a copy in which 4 kB are overwritten at three places, as by bad sectors.
damage() {
  python3 - "$1" "$2" << 'PY'
import sys
with open(sys.argv[1], "rb") as file:
    data = bytearray(file.read())
for part in (1, 2, 3):
    place = part * len(data) // 4
    data[place : place + 4096] = bytes(4096)
with open(sys.argv[2], "wb") as file:
    file.write(data)
PY
}

solveAxes || return
flyHidden uncalibrated build/demo/maps || return

duration=$(plannedDuration) || return
loseRotorAt "$duration" > "$output/tumble.yaml"
exciteVehicle morning "$duration" "$hidden" seed:=1 wind:='[0.4, -0.3, 0.0]' || return
exciteVehicle noon "$duration" "$hidden" seed:=2 wind:='[-0.6, 0.5, 0.1]' || return
exciteVehicle evening "$(awk -v d="$duration" 'BEGIN {print d + 1.5}')" "$output/tumble.yaml" seed:=3 wind:='[0.2, 0.7, -0.1]' || return

flights=("$output/morning.bag" "$output/noon.bag" "$output/evening.bag")
build/bin/calibrate attitude "${flights[@]}" --axis roll --axis pitch -o "$output/calibration.yaml" \
  --report "$output/report/calibration" || return
for axis in longitudinal lateral; do
  build/bin/calibrate apply "$output/calibration.yaml" --problem region_maps/problems/multirotor_$axis.yaml \
    -o "$output/problems/multirotor_$axis.yaml" || return
done
cp region_maps/problems/multirotor_vertical.yaml "$output/problems/"
solveAxes "$output/problems" "$output/maps" || return
flyHidden calibrated "$output/maps" || return
# Weaker loops take greater inputs: what left the maps is covered by the ranges that the validation proposes.
mkdir -p "$output/wider" "$output/wider_maps"
widen "$output/problems" "$output/calibrated/summary.json" "$output/wider" || return
solveAxes "$output/wider" "$output/wider_maps" || return
flyHidden covered "$output/wider_maps" || return

mkdir -p "$output/damaged"
damage "$output/covered/flight.bag" "$output/damaged/flight.bag" || return
if validateFlight "$output/damaged" "$output/wider_maps" --min-coverage 0 --strict; then
  echo "the validation of a damaged bag is green: $output/damaged/flight.bag" >&2
  return 1
fi
for flight in uncalibrated calibrated covered damaged; do cp -r "$output/$flight/report" "$output/report/$flight"; done
inWorkspace python3 test/experiments/field.py "$output"
