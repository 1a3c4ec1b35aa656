# shellcheck shell=bash
# Half an hour of simulated flight with random dropouts, jumps, NaNs, map swaps, reconfigurations and changes of law: no
# bound violated in what is sent, no growth of memory, always recovered. POLYFLY_SOAK_SECONDS and POLYFLY_SOAK_SEED change it.
rm -rf "$output"
mkdir -p "$output/report" "$output/problems"
solveAxes > /dev/null || return
solveAxes region_maps/problems/robust build/demo/maps aslquad > /dev/null || return
# Maps of other weights, to be swapped for those of the demo.
for axis in $map_axes; do
  sed -e 's/  Q: \[40,/  Q: [55,/' -e 's/  Q: \[60,/  Q: [80,/' "region_maps/problems/multirotor_$axis.yaml" > "$output/problems/multirotor_$axis.yaml"
done
for axis in $map_axes; do
  sed 's/tie_break: {Q: \[40,/tie_break: {Q: [30,/' "region_maps/problems/robust/aslquad_$axis.yaml" > "$output/problems/aslquad_$axis.yaml"
done
solveAxes "$output/problems" "$output/maps" > /dev/null || return
solveAxes "$output/problems" "$output/maps" aslquad > /dev/null || return
status=0
build/bin/soak --maps build/demo/maps "$output/maps" --problems region_maps/problems --output "$output" \
  --duration "${POLYFLY_SOAK_SECONDS:-1800}" --seed "${POLYFLY_SOAK_SEED:-1}" || status=$?
[ -s "$output/summary.json" ] || return 1
# The same through the node: odometry, references and requests over topics and services.
inWorkspace rostest -t polyfly_test soak.test maps:="$root/build/demo/maps" other_maps:="$(realpath "$output/maps")" \
  problems:="$root/region_maps/problems" duration:="${POLYFLY_SOAK_SECONDS:-1800}" seed:="${POLYFLY_SOAK_SEED:-1}" \
  json:="$(realpath "$output")/node.json" time_limit:=3600 > "$output/node.log" 2>&1 || true
[ -s "$output/node.json" ] || status=1
grep -q '\[  PASSED  \] 1 test' "$output/node.log" || status=1
python3 - "$output" << 'PY'
import html, json, sys
with open(sys.argv[1] + "/summary.json") as file:
    summary = json.load(file)
try:
    with open(sys.argv[1] + "/node.json") as file:
        summary["node"] = json.load(file)
    summary["headline"] += [["through the node: violated bounds and faults not recovered from", summary["node"]["violations"], ""],
                            ["through the node: growth of the memory in use", summary["node"]["allocated_growth_bytes"], "bytes"]]
except FileNotFoundError:
    summary["node"] = "left nothing, see node.log"
with open(sys.argv[1] + "/summary.json", "w") as file:
    json.dump(summary, file, indent=2)
rows = "".join("<tr><td>%s</td><td>%s</td></tr>\n" % (html.escape(key), html.escape("%s" % value))
               for key, value in summary.items() if key not in ("headline", "violations"))
said = "".join("<li>%s</li>\n" % html.escape(text) for text in summary["violations"])
with open(sys.argv[1] + "/report/index.html", "w") as file:
    file.write("""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Soak</title>
<style>body{font-family:sans-serif;max-width:60em;margin:2em auto}td{padding:.2em .8em}</style></head>
<body><h1>A flight in which everything goes wrong at random</h1>
<table>%s</table>
<h2>Bounds violated, faults not recovered from</h2>%s</body></html>
""" % (rows, "<ul>%s</ul>" % said if said else "<p>None.</p>"))
PY
return "$status"
