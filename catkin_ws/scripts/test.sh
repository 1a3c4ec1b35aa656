# shellcheck shell=bash
# ./run test: unit tests, rostests, the README's commands. ./run sanitize: unit tests under the sanitizers.

# runCtest PRESET [ctest option...]: leaves CTest's and GoogleTest's results in build/.run/results/PRESET.
runCtest() {
  local preset=$1 results="$root/build/.run/results/$1"
  shift
  rm -rf "$results" "build/$preset/Testing"
  mkdir -p "$results/gtest"
  (
    cd "build/$preset" || exit
    GTEST_OUTPUT="xml:$results/gtest/" ctest -T Test --parallel "$(nproc)" --no-tests=error --output-on-failure "$@" ||
      status=$?
    cp "Testing/$(head -n 1 Testing/TAG)/Test.xml" "$results/ctest.xml" && exit "${status:-0}"
  )
}

# A failing test is counted, not fatal, as long as it left its results.
runTests() { runCtest "$@" || [ -f "build/.run/results/$1/ctest.xml" ]; }

runRostests() {
  rm -rf build/catkin/build/test_results
  catkinBuild tests
  solveAxes || return
  solveAxes region_maps/problems/robust build/demo/maps aslquad || return
  export POLYFLY_MAPS=$root/build/demo/maps
  # Two at a time: each has a master on a port of its own, and most of them wait for wall time.
  inWorkspace catkinBuild -j2 run_tests || true
  [ -d build/catkin/build/test_results ]
}

# runCheck NAME COMMAND...: leaves the exit status for the count.
runCheck() {
  local name=$1 status=0
  shift
  mkdir -p build/.run/results
  "$@" || status=$?
  echo "$status" > "build/.run/results/$name.status"
}

# POLYFLY_TEST_PACKAGES: kinds of packages that the tests use where they are installed, and that are to be installed.
testCommand() {
  # shellcheck disable=SC2086  # several kinds
  startCommand 6 run ${POLYFLY_TEST_PACKAGES:-}
  buildBoth all all
  own demo
  step tests "running the tests" runTests release
  step rostests "running the tests with ROS nodes" runRostests
  step readme "running the README's commands" runCheck README test/readme_test.sh
  python3 catkin_ws/scripts/count_tests.py --ctest build/.run/results/release/ctest.xml build/.run/results/release/gtest \
    --catkin build/catkin/build/test_results --check README build/.run/results/README.status
}

# Tests that take long because they repeat: flights, fits of flights, random programs, whole commands, ./run itself, pages in a
# browser. Shorter tests run the same code under the address sanitizer.
repeating_tests='_flights?_test|flight_phases|motions?_test|soak|dead_time|laws_on_plants|odometry_outliers|drag|fit_loop'
repeating_tests+='|model_support|repeated_rows|norm_cost|repeating|(filter|resume)_command|run_test|explorer_browser'

sanitizeCommand() {
  startCommand 4 run
  own asan
  own tsan
  step asan_build "building the tests with the address and undefined-behaviour sanitizers" buildAddressSanitized
  step tsan_build "building the threaded tests with the thread sanitizer" buildSanitized tsan threaded_tests
  step asan_tests "running the tests under the address and undefined-behaviour sanitizers" \
    runTests asan -E "$repeating_tests"
  step tsan_tests "running the threaded tests under the thread sanitizer" runTests tsan -L threads
  python3 catkin_ws/scripts/count_tests.py --ctest build/.run/results/asan/ctest.xml build/.run/results/asan/gtest \
    --ctest build/.run/results/tsan/ctest.xml build/.run/results/tsan/gtest
}

buildSanitized() { configurePreset "$1" && buildPreset "$@"; }

# The tools, and of the tests those that run.
buildAddressSanitized() {
  configurePreset asan || return
  # shellcheck disable=SC2046  # a name each
  buildPreset asan tools $(comm -12 \
    <(cd build/asan && ctest -N -E "$repeating_tests" | sed -n 's/^ *Test *#[0-9]*: //p' | sort) \
    <(ninja -C build/asan -t targets all | sed -n 's/: phony$//p' | sort))
}
