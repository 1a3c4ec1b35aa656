# shellcheck shell=bash
# ./run bench and ./run experiments: each name is a script that is dropped in, test/bench/NAME.sh or
# test/experiments/NAME.sh (README.md in each folder).

# runScript KIND NAME: with the functions of catkin_ws/scripts at hand and the result's place in $output.
runScript() {
  local kind=$1 name=$2 output
  case "$kind" in
    bench) output=build/bench/$name.json ;;
    experiments) output=build/experiments/$name ;;
  esac
  # shellcheck source=/dev/null
  . "test/$kind/$name.sh"
}

namesOrAll() { if [ -n "${2:-}" ]; then echo "$2"; else scriptNames "$1"; fi; }

# showRows PATH: the rows of PATH.json, or the table that the script itself left for people in PATH.txt.
showRows() {
  local rows
  rows=$(python3 catkin_ws/scripts/show_table.py "$1.json")
  if [ -s "$1.txt" ]; then
    cat "$1.txt"
    say "  rows: $1.json"
  else
    say "$rows"
  fi
}

benchCommand() {
  local name names
  names=$(namesOrAll bench "${1:-}")
  startCommand $((3 + $(wc -w <<< "$names"))) run
  buildBoth tools tools
  own bench
  for name in $names; do
    rm -f "build/bench/$name.json" "build/bench/$name.txt"
    step "bench_$name" "measuring: $name" runScript bench "$name"
    showRows "build/bench/$name"
  done
}

experimentsCommand() {
  local name names
  names=$(namesOrAll experiments "${1:-}")
  startCommand $((3 + $(wc -w <<< "$names"))) run
  buildBoth tools tools
  own experiments
  for name in $names; do
    mkdir -p "build/experiments/$name"
    step "experiment_$name" "experiment: $name" runScript experiments "$name"
    [ -s "build/experiments/$name/summary.json" ] && [ -s "build/experiments/$name/report/index.html" ] ||
      die "the experiment '$name' left no summary.json or report/index.html"
    say "experiment $name:"
    sayResult "build/experiments/$name"
  done
}
