# shellcheck shell=bash
# What the commands of ./run share: folders they own, steps with the time left, logs.

# Debian's own tools come first: another python3 on PATH would hide the ROS modules.
export PATH="/usr/bin:/bin:$PATH"
export PYTHONDONTWRITEBYTECODE=1
unset ROS_PACKAGE_PATH CMAKE_PREFIX_PATH PYTHONPATH LD_LIBRARY_PATH
export ROS_HOME="$root/build/.run/ros" ROS_LOG_DIR="$root/build/.run/ros/log"

say() { printf '%s\n' "$*"; }
die() { printf 'run: %s\n' "$*" >&2; exit 1; }

# own NAME: makes the folder build/NAME and notes that it is ours, so that `clean` may remove it.
own() {
  mkdir -p build/.run
  if [ ! -e "build/$1" ]; then
    mkdir -p "build/$1"
    printf '%s\n' "$1" >> build/.run/made
  fi
}

# takeLock: one ./run at a time in a tree; a ./run started by another is part of it.
takeLock() {
  [ -z "${POLYFLY_RUN_LOCKED:-}" ] || return 0
  mkdir -p build/.run
  exec 9> build/.run/lock
  if ! flock --nonblock 9; then
    say "Another ./run is at work in this tree; waiting for it."
    flock 9
  fi
  export POLYFLY_RUN_LOCKED=1
}

cleanCommand() {
  local name
  if [ -f build/.run/made ]; then
    while read -r name; do
      [ -n "$name" ] || continue
      say "removing build/$name"
      rm -rf "build/$name"
    done < <(sort -u build/.run/made)
  fi
  rm -rf build/.run
  rmdir build 2> /dev/null || true
  say "Clean."
}

# jobs: as many compilers as there are cores, but no more than fit the free memory (1.5 GB each).
jobs_at_once() {
  local cores free_mb fit
  cores=$(nproc)
  free_mb=$(awk '/^MemAvailable/ {print int($2 / 1024)}' /proc/meminfo)
  fit=$((free_mb / 1500))
  [ "$fit" -ge 1 ] || fit=1
  echo $((cores < fit ? cores : fit))
}

# Steps of the running command: plan them all first, then run them in the same order.
step_names=()
step_seconds=()
step_keys=()
step_index=0

# plan NAME SECONDS [KEY]: a step that will take about SECONDS on two cores; what it took here last time counts
# more. Times are remembered under KEY, so that building anew and bringing up to date do not mix.
plan() {
  local last="" key=${3:-$1}
  if [ -f build/.run/times ]; then
    last=$(awk -v key="$key" '$1 == key {seconds = $2} END {print seconds}' build/.run/times)
  fi
  step_names+=("$1")
  step_seconds+=("${last:-$2}")
  step_keys+=("$key")
}

# planBuilding NAME SECONDS FOLDER: a step that takes long only where build/FOLDER was not built before.
planBuilding() {
  if [ -f "build/$3/build.ninja" ]; then
    plan "$1" 5 "$1-again"
  else
    plan "$1" "$2"
  fi
}

# doing NAME: the last line of a step's log that counts what it does, as "[3/40] ...".
doing() {
  tail -c 4000 "build/.run/log/$1.log" 2> /dev/null | tr '\r' '\n' | grep -E '^\[[0-9]+/[0-9]+\]' | tail -n 1 || true
}

# ownSecondsLeft NAME SPENT: of the running step, as its log says ("(about 40 s left)" ends the counting line), or by
# the count there, or else by what was planned.
ownSecondsLeft() {
  local line count
  line=$(doing "$1")
  count=$(grep -Eo '^\[[0-9]+/[0-9]+\]' <<< "$line" | tr -d '[]') || true
  if [[ "$line" =~ \(about\ ([0-9]+)\ s\ left\)$ ]]; then
    echo "${BASH_REMATCH[1]}"
  elif [ -n "$count" ] && [ "${count%/*}" -ge 3 ]; then
    echo $(($2 * (${count#*/} - ${count%/*}) / ${count%/*}))
  elif [ "$2" -lt "${step_seconds[step_index]}" ]; then
    echo $((step_seconds[step_index] - $2))
  else
    echo 5
  fi
}

# timeLeft NAME SPENT: seconds left of the command, when the running step has run for SPENT seconds.
timeLeft() {
  local left i
  left=$(ownSecondsLeft "$1" "$2")
  for ((i = step_index + 1; i < ${#step_names[@]}; ++i)); do
    left=$((left + step_seconds[i]))
  done
  echo "$left"
}

# step NAME TEXT COMMAND...: runs the command of a planned step with its output in build/.run/log/NAME.log,
# tells how long is left now and then, and shows the end of the log when it fails.
step() {
  local name=$1 text=$2 started now status=0
  shift 2
  while [ "$step_index" -lt "${#step_names[@]}" ] && [ "${step_names[$step_index]}" != "$name" ]; do
    step_index=$((step_index + 1))
  done
  [ "$step_index" -lt "${#step_names[@]}" ] || plan "$name" 0
  mkdir -p build/.run/log
  rm -f "build/.run/log/$name.log"
  started=$(date +%s)
  say "[$((step_index + 1))/${#step_names[@]}] $text (about $(timeLeft "$name" 0) s left)"
  set -m  # a process group of its own, so that an interruption reaches all that it started
  "$@" > "build/.run/log/$name.log" 2>&1 < /dev/null 9>&- &
  step_pid=$!
  set +m
  (
    trap 'kill $! 2> /dev/null; exit' TERM
    while sleep 15 & wait $!; do
      say "      $name: $(($(date +%s) - started)) s so far, about $(timeLeft "$name" $(($(date +%s) - started))) s left" \
        "  $(doing "$name" | sed 's/ (about.*//' | cut -c 1-80)"
    done
  ) 9>&- &
  ticker_pid=$!
  wait "$step_pid" || status=$?
  step_pid=""
  kill "$ticker_pid" 2> /dev/null || true
  wait "$ticker_pid" 2> /dev/null || true
  now=$(date +%s)
  if [ "$status" -ne 0 ]; then
    tail -n 60 "build/.run/log/$name.log" >&2
    say "run: the step '$name' failed ($text); its whole output is in build/.run/log/$name.log" >&2
    return "$status"
  fi
  echo "${step_keys[step_index]} $((now - started))" >> build/.run/times
  step_index=$((step_index + 1))
}

# An interrupted command takes its running step with it.
step_pid="" ticker_pid=""
stopStep() {
  trap - INT TERM
  say "run: interrupted" >&2
  [ -z "$ticker_pid" ] || kill "$ticker_pid" 2> /dev/null || true
  if [ -n "$step_pid" ]; then
    kill -- "-$step_pid" 2> /dev/null || true
    wait "$step_pid" 2> /dev/null || true
  fi
  exit 130
}
trap stopStep INT TERM

# freePort: a loopback port that nobody listens on.
freePort() {
  python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

# scriptNames KIND, scriptExists KIND NAME: the drop-in scripts of `bench` and `experiments`.
scriptNames() { (cd "test/$1" 2> /dev/null && ls -- *.sh 2> /dev/null | sed 's/\.sh$//' | tr '\n' ' '); }
scriptExists() { [[ "$2" =~ ^[a-z0-9_]+$ ]] && [ -f "test/$1/$2.sh" ]; }
