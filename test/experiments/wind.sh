# shellcheck shell=bash
# The demo's flight with another wind and another seed: the observer has more to cancel, the maps are the same.
solveAxes
fly "$output" build/demo/maps seed:=7 wind:='[-0.8, 0.6, 0.3]'
validateFlight "$output" build/demo/maps --min-coverage 0  # what this wind leaves of it is the question
