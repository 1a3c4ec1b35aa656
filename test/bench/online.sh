# shellcheck shell=bash
# What is solved in flight: quadratic programs, where the reference problems are at hand, the multirotor's laws, and the
# fixed wing's.
build/bin/bench_online region_maps/problems "${POLYFLY_DATA:-../shared/data}/online_qps" > "$output"
python3 test/bench/fixedwing.py "$output" --append
