# shellcheck shell=bash
# Safety filter: the benchmark of TinyMPC flown with and without a safe set, and the exported C against an adversary. The adversary
# has the whole disturbance, and what the error of the code leaves of the input's error.
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# Problem, type of the code, and range of the wish.
while read -r problem type range; do
  place="$folder/$type"
  mkdir "$place"
  build/bin/offline_mpt solve "region_maps/problems/safety/$problem.yaml" -o "$place/filter.map" --quiet
  build/bin/offline_mpt verify "$place/filter.map" --exact --quiet
  build/bin/offline_mpt export "$place/filter.map" -o "$place" --name filter --type "$type" --quiet
  gcc -std=c99 -O2 -ffp-contract=off "-DREAL=$type" "-I$place" test/bench/safety_adversary.c "$place/filter.c" -o "$place/adversary" -lm
  error=$(/usr/bin/python3 -c 'import json, sys
told = json.load(open(sys.argv[1]))
print(told["error_allowed"][0] - told["error_bound"][0])' "$place/filter.json")
  "$place/adversary" "${POLYFLY_ADVERSARIAL_STEPS:-1000000000}" 1 "$error" "$range" > "$place/adversary.json" || true
done <<'KINDS'
double_integrator double 50
double_integrator_float float 2
KINDS
build/bin/bench_safety "$folder/double/filter.map" > "$folder/rows.json"
/usr/bin/python3 - "$folder" > "$output" <<'PYTHON'
import json, sys
rows = json.load(open(sys.argv[1] + "/rows.json"))
for kind in ("double", "float"):
    flown = json.load(open(sys.argv[1] + "/" + kind + "/adversary.json"))
    wrong = flown["left"] + flown["left_between"] + flown["unanswered"]
    rows.append({"name": "exported C, %s: adversarial steps" % kind, "value": flown["steps"], "unit": "steps"})
    rows.append({"name": "exported C, %s: states out of their ranges, or without an answer" % kind, "value": wrong, "unit": "steps",
                 "mark": 0, "reached": wrong == 0})
print(json.dumps(rows, indent=1))
PYTHON
