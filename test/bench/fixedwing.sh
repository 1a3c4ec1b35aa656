# shellcheck shell=bash
# The fixed wing's real-time iteration: whole, preparation and feedback, by the length of the horizon.
python3 test/bench/fixedwing.py "$output"
