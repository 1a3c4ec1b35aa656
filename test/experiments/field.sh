# shellcheck shell=bash
# The loop from flight to map: a vehicle whose inner loops are not those of the problem files is flown with the maps as
# they are, excited, calibrated, and flown again with maps of the calibrated problems; where that flight left its maps, once
# more with the wider ones that its validation proposes.
rm -rf "$output"
mkdir -p "$output/problems" "$output/maps" "$output/report"

# What the tools are not told: slower and weaker loops than the problem files say (0.9, 0.25 s; 0.9, 0.255 s). Without the
# demo's push, whose answer is no tracking of a reference.
hidden="$output/hidden.yaml"
cat > "$hidden" << 'YAML'
plant:
  vehicle: {roll_gain: 0.68, roll_time: 0.42, pitch_gain: 0.72, pitch_time: 0.38, kick_time: 0.0}
YAML

# exciteVehicle BAG: the plan of launch/config/excitation.yaml, flown by the exciting node against the hidden vehicle.
exciteVehicle() {
  local port duration
  build/bin/excite --plan launch/config/excitation.yaml > "$output/plan.txt" || return
  duration=$(awk 'NR == 1 {for (i = 1; i < NF; ++i) if ($(i + 1) == "s") {print $i; exit}}' "$output/plan.txt")
  port=$(freePort)
  unset ROS_HOSTNAME
  export ROS_MASTER_URI=http://127.0.0.1:$port ROS_IP=127.0.0.1
  inWorkspace timeout --signal=INT --kill-after=10 300 roslaunch --port="$port" polyfly_launch excite_demo.launch \
    bag:="$(realpath "$output")/excitation.bag" duration:="$duration" overrides:="$(realpath "$hidden")" || return
  [ -s "$1" ] || { echo "the excitation left no bag: $1" >&2; return 1; }
}

# flyHidden NAME MAPS [validate_bag option...]: the demo's figure with the hidden vehicle.
flyHidden() {
  local name=$1 maps=$2
  shift 2
  fly "$output/$name" "$maps" overrides:="$(realpath "$hidden")" || return
  validateFlight "$output/$name" "$maps" --min-coverage 0 --topics-bag "$output/$name/topics.bag" "$@"
}

solveAxes || return
flyHidden uncalibrated build/demo/maps || return
exciteVehicle "$output/excitation.bag" || return
build/bin/calibrate attitude "$output/excitation.bag" --axis roll --axis pitch -o "$output/calibration.yaml" \
  --report "$output/report/calibration" || return
for axis in longitudinal lateral; do
  build/bin/calibrate apply "$output/calibration.yaml" --problem region_maps/problems/multirotor_$axis.yaml \
    -o "$output/problems/multirotor_$axis.yaml" || return
done
cp region_maps/problems/multirotor_vertical.yaml "$output/problems/"
solveAxes "$output/problems" "$output/maps" || return
flyHidden calibrated "$output/maps" --propose "$output/wider" || return
# Weaker loops take greater inputs: what left the maps is covered by the ranges that the validation proposes.
mkdir -p "$output/wider" "$output/wider_maps"
cp -n "$output/problems"/*.yaml "$output/wider/"
solveAxes "$output/wider" "$output/wider_maps" || return
flyHidden covered "$output/wider_maps" || return
for flight in uncalibrated calibrated covered; do cp -r "$output/$flight/report" "$output/report/$flight"; done
inWorkspace python3 test/experiments/calibration.py "$output"
