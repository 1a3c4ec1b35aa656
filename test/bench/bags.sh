# shellcheck shell=bash
# A flight hidden in a bag of a gigabyte: time and memory of the tools that read it.
solveAxes
[ -s build/demo/flight.bag ] || fly build/demo build/demo/maps
for axis in $map_axes; do maps+=("build/demo/maps/multirotor_$axis.map"); done
python3 test/bench/bags.py build/demo/flight.bag "${maps[@]}" > "$output"
