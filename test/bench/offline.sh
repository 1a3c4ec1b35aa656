# shellcheck shell=bash
# The parametric solver alone, one thread, median CPU seconds of five runs: generated problems and, where they are at
# hand, reference problems.
build/bin/bench_offline > "$output"
