# shellcheck shell=bash
# The minimum-peak robust MPC: time to solve and to prove, look-up, and peaks of flights beside LQR and nominal MPC.
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
build/bin/bench_robust region_maps/problems/reference "$folder" > "$output"
