# shellcheck shell=bash
# The Python module: import, a small problem from matrices to its map, look-ups of a whole array.
PYTHONPATH=build/release/python /usr/bin/python3 -B test/bench/python_module.py > "$output"
