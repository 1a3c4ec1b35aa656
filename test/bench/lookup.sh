# shellcheck shell=bash
# One look-up in each map of the demo.
solveAxes
for axis in $map_axes; do maps+=("build/demo/maps/multirotor_$axis.map"); done
build/bin/bench_lookup --seed 1 --samples 200000 "${maps[@]}" > "$output"
