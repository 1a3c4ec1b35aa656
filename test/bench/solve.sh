# shellcheck shell=bash
# The parametric solver, one thread: the demo's problems and, where they are at hand, reference problems.
python3 test/bench/solve.py "$output"
