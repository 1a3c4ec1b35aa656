# shellcheck shell=bash
# Safety filter: the benchmark of TinyMPC flown with and without a safe set, and the exported C against an adversary.
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
build/bin/offline_mpt solve region_maps/problems/safety/double_integrator.yaml -o "$folder/filter.map" --quiet
build/bin/offline_mpt verify "$folder/filter.map" --exact --quiet
build/bin/offline_mpt export "$folder/filter.map" -o "$folder/c" --name filter
gcc -std=c99 -O2 -ffp-contract=off "-I$folder/c" test/bench/safety_adversary.c "$folder/c/filter.c" -o "$folder/adversary"
build/bin/bench_safety "$folder/filter.map" > "$folder/rows.json"
"$folder/adversary" "${POLYFLY_ADVERSARIAL_STEPS:-1000000000}" 1 > "$folder/adversary.json" || true
/usr/bin/python3 - "$folder" > "$output" <<'PYTHON'
import json, sys
rows = json.load(open(sys.argv[1] + "/rows.json"))
flown = json.load(open(sys.argv[1] + "/adversary.json"))
wrong = flown["left"] + flown["left_between"] + flown["unanswered"]
rows.append({"name": "exported C: adversarial steps", "value": flown["steps"], "unit": "steps"})
rows.append({"name": "exported C: states out of their ranges, or without an answer", "value": wrong, "unit": "steps", "mark": 0,
             "reached": wrong == 0})
print(json.dumps(rows, indent=1))
PYTHON
