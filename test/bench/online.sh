# shellcheck shell=bash
# What is solved in flight: quadratic programs, where the reference problems are at hand.
build/bin/bench_online "${POLYFLY_DATA:-../shared/data}/online_qps" > "$output"
