# shellcheck shell=bash
# Betaflight's SITL, flown by the node through multirotor_mavros.launch and a bridge of UDP packets, by three laws. In wall
# time: a flight takes 80 s. POLYFLY_BETAFLIGHT names the built program, POLYFLY_BETAFLIGHT_RUNS the flights of each law.
rm -rf "$output"
mkdir -p "$output/report"
if [ -z "${POLYFLY_BETAFLIGHT:-}" ]; then
  /usr/bin/python3 test/experiments/betaflight.py "$output" --not-flown
  return
fi
sitl=$(realpath -e -- "$POLYFLY_BETAFLIGHT" 2> /dev/null)
if [ ! -f "$sitl" ] || [ ! -x "$sitl" ]; then
  echo "POLYFLY_BETAFLIGHT must name the built program of Betaflight's SITL (obj/main/betaflight_SITL.elf); it is" \
    "'$POLYFLY_BETAFLIGHT'. test/experiments/README.md tells how to build it." >&2
  return 1
fi
flights=${POLYFLY_BETAFLIGHT_RUNS:-10}
[[ "$flights" =~ ^[1-9][0-9]*$ ]] || { echo "POLYFLY_BETAFLIGHT_RUNS must be a number above 0; it is '$flights'" >&2; return 1; }
link=$(realpath test/experiments)

# flyBetaflight LAW RESULT: one flight, from an empty configuration. Returns 3 where SITL did not arm.
flyBetaflight() {
  local law=$1 result=$2 folder port launch autopilot code
  folder=$(realpath "$output")/sitl
  rm -rf "$folder"
  mkdir -p "$folder"
  PYTHONPATH=$link /usr/bin/python3 -c 'import betaflight_link as b; print(b.CONFIGURATION)' > "$folder/configuration.txt" || return
  (cd "$folder" && timeout 30 "$sitl" --config configuration.txt > configure.log 2>&1)
  grep -q "EEPROM saved" "$folder/configure.log" || { echo "$sitl took no --config: $folder/configure.log" >&2; return 1; }
  port=$(freePort)
  unset ROS_HOSTNAME
  export ROS_MASTER_URI=http://127.0.0.1:$port ROS_IP=127.0.0.1
  # Each of the two is one process that a signal reaches: `exec`, and no SIGINT, which shells ignore in the background.
  (
    set +u
    # shellcheck source=/dev/null
    . "$root/build/catkin/devel/setup.bash"
    exec timeout --kill-after=10 150 roslaunch --port="$port" polyfly_launch multirotor_mavros.launch law:="$law" \
      maps_dir:="$(realpath "$output/maps")" config:="$(realpath "$output/vehicle.yaml")" priority:=0 \
      thrust_polynomial:="$polynomial"
  ) > "${result%.json}.log" 2>&1 &
  launch=$!
  (cd "$folder" && exec timeout --kill-after=5 150 "$sitl") > "${result%.json}_sitl.log" 2>&1 &
  autopilot=$!
  inWorkspace timeout --kill-after=5 120 /usr/bin/python3 test/experiments/betaflight_flight.py "$result"
  code=$?
  kill "$launch" "$autopilot" 2> /dev/null
  wait "$launch" "$autopilot" 2> /dev/null
  return "$code"
}

/usr/bin/python3 test/experiments/betaflight_link.py "$output" || return
solveAxes "$output/problems" "$output/maps" || return
polynomial=$(PYTHONPATH=$link /usr/bin/python3 -c 'import betaflight_link as b; print(b.thrust_polynomial())') || return
for law in linear explicit_linear nonlinear; do
  for ((flight = 1; flight <= flights; ++flight)); do
    result=$(realpath "$output")/${law}_$flight.json
    code=3
    for ((start = 1; start <= 3 && code == 3; ++start)); do
      flyBetaflight "$law" "$result" && code=0 || code=$?
    done
    [ "$code" = 0 ] || return
  done
done
/usr/bin/python3 test/experiments/betaflight.py "$output"
