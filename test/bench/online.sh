# shellcheck shell=bash
# What is solved in flight: quadratic programs, where the reference problems are at hand, and the laws.
build/bin/bench_online region_maps/problems "${POLYFLY_DATA:-../shared/data}/online_qps" > "$output"
