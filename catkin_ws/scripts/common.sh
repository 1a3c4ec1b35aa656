# shellcheck shell=bash
# What the commands of ./run share: folders they own, steps, logs.

# Debian's own tools come first: another python3 on PATH would hide the ROS modules.
export PATH="/usr/bin:/bin:$PATH"
export PYTHONDONTWRITEBYTECODE=1
unset ROS_PACKAGE_PATH CMAKE_PREFIX_PATH PYTHONPATH LD_LIBRARY_PATH
export ROS_HOME="$root/build/.run/ros" ROS_LOG_DIR="$root/build/.run/ros/log"

say() { printf '%s\n' "$*"; }
die() { printf 'run: %s\n' "$*" >&2; exit 1; }

# own NAME: makes the folder build/NAME and notes that it is ours, so that `clean` may remove it. A workspace that holds this
# clone sees no packages below build/.
own() {
  mkdir -p build/.run
  touch build/CATKIN_IGNORE
  if [ ! -e "build/$1" ]; then
    mkdir -p "build/$1"
    printf '%s\n' "$1" >> build/.run/made
  fi
}

# copyTree FOLDER: the files of this tree, without git's and what was built.
copyTree() {
  mkdir -p "$1"
  tar --create --exclude=./.git --exclude=./build --exclude=./catkin_ws/build --exclude=./catkin_ws/devel . |
    tar --extract --directory "$1"
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

# madeFolders: the names of the folders below build that are ours.
madeFolders() { [ ! -f build/.run/made ] || sort -u build/.run/made | grep . || true; }

# refuseMovedTree: CMake builds only where it was configured.
refuseMovedTree() {
  local name cache place
  while read -r name; do
    for cache in build/"$name"/{,build/,build/*/}CMakeCache.txt; do
      [ -f "$cache" ] || continue
      place=$(sed -n 's/^CMAKE_CACHEFILE_DIR:INTERNAL=//p' "$cache")
      [ "$place" -ef "${cache%/*}" ] ||
        die "this tree was moved or copied after it was built in $place. Run \`./run clean\` first, then build again."
    done
  done < <(madeFolders)
}

cleanCommand() {
  local name
  while read -r name; do
    say "removing build/$name"
    rm -rf "build/$name"
  done < <(madeFolders)
  rm -rf build/.run build/CATKIN_IGNORE
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

# Steps of the running command: how many there are, and which is next.
step_count=0 step_index=1

# startCommand STEPS KIND...: a command of so many steps, which needs these kinds of packages.
startCommand() {
  step_count=$1
  shift
  requirePackages "$@"
  useSystem
}

# doing NAME: the last line of a step's log that counts what it does, as "[3/40] ...".
doing() {
  tail -c 4000 "build/.run/log/$1.log" 2> /dev/null | tr '\r' '\n' | grep -E '^\[[0-9]+/[0-9]+\]' | tail -n 1 || true
}

# step NAME TEXT COMMAND...: runs the next step with its output in build/.run/log/NAME.log, tells now and then what it
# does, and shows the end of the log when it fails.
step() {
  local name=$1 text=$2 started status=0
  shift 2
  mkdir -p build/.run/log
  rm -f "build/.run/log/$name.log"
  started=$SECONDS
  say "[$step_index/$step_count] $text"
  set -m  # a process group of its own, so that an interruption reaches all that it started
  "$@" > "build/.run/log/$name.log" 2>&1 < /dev/null 9>&- &
  step_pid=$!
  set +m
  (
    trap 'kill $! 2> /dev/null; exit' TERM
    while sleep 15 & wait $!; do
      say "      $name: $((SECONDS - started)) s so far  $(doing "$name" | cut -c 1-80)"
    done
  ) 9>&- &
  ticker_pid=$!
  wait "$step_pid" || status=$?
  step_pid=""
  kill "$ticker_pid" 2> /dev/null || true
  wait "$ticker_pid" 2> /dev/null || true
  if [ "$status" -ne 0 ]; then
    tail -n 60 "build/.run/log/$name.log" >&2
    say "run: the step '$name' failed ($text); its whole output is in build/.run/log/$name.log" >&2
    return "$status"
  fi
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
