# shellcheck shell=bash
# The two builds: plain CMake for the tools and the tests without ROS, catkin for everything.

# A CMake before 3.21 reads no presets.
configurePreset() {
  local -a arguments
  mapfile -t arguments < <(python3 catkin_ws/scripts/preset.py "$1")
  cmake "${arguments[@]}" -DPython3_EXECUTABLE=/usr/bin/python3
}
buildPreset() { cmake --build "build/$1" --parallel "$(jobs_at_once)" --target "${@:2}"; }

# catkinMake FOLDER ARGUMENT...: the workspace of catkin_ws/src, built under FOLDER so that catkin_ws stays clean.
catkinMake() {
  local folder=$1
  shift
  # the tests' environment is written on the first configuration, and leaves out what does not exist by then
  mkdir -p "$folder/src" "$folder/devel/lib/python3/dist-packages"
  ln -sfn ../../../catkin_ws/src "$folder/src/polyfly"
  # GMock's configuration in Debian 11 serves one package of a workspace only.
  catkin_make -C "$folder" --use-ninja --no-color -DPYTHON_EXECUTABLE=/usr/bin/python3 -DCMAKE_DISABLE_FIND_PACKAGE_GMock=ON \
    -DCMAKE_BUILD_TYPE=Release "-DPOLYFLY_WERROR=${POLYFLY_WERROR:-}" "-j$(jobs_at_once)" -l1000 "$@"
}

# catkinBuild TARGET...: with the libraries and tools that the plain build has made.
catkinBuild() {
  local libraries
  libraries=$(find build/release/lib -name 'lib*.a' -printf '%f\n' | sed 's/^lib\(.*\)\.a$/\1/' | sort | paste -sd ';')
  catkinMake build/catkin "-DPOLYFLY_BUILT=$root/build/release" "-DPOLYFLY_BUILT_LIBRARIES=$libraries" \
    "-DPOLYFLY_BIN_DIR=$root/build/bin" "$@"
}

# linkRosTools: the tools that need ROS libraries are built by catkin; build/bin points to them.
linkRosTools() {
  local tool
  for tool in build/catkin/devel/lib/calibration/*; do
    if [ -f "$tool" ] && [ -x "$tool" ] && { [ ! -e "build/bin/${tool##*/}" ] || [ -L "build/bin/${tool##*/}" ]; }; then
      ln -sfn "../catkin/devel/lib/calibration/${tool##*/}" "build/bin/${tool##*/}"
    fi
  done
}

# What `./run demo` solves, flies and validates with: targets of the plain build, and of the workspace.
demo_tools="offline_mpt_tool multirotor_plant"
demo_nodes="online_controller_ros polyfly_test_ros validate_bag validate_filter"

# buildBoth STEP "TARGET..." [CATKIN TARGET...]: the plain build and the workspace, of which all without targets.
buildBoth() {
  local step=$1 targets=$2
  shift 2
  own bin
  own release
  own catkin
  step configure "configuring the plain build" configurePreset release
  # shellcheck disable=SC2086
  step "$step" "building the ROS-free libraries and tools" buildPreset release $targets
  step catkin "building the ROS packages" catkinBuild "$@"
  linkRosTools
}

# inWorkspace COMMAND...: with the environment of the built workspace.
inWorkspace() {
  (
    set +u
    # shellcheck source=/dev/null
    . "$root/build/catkin/devel/setup.bash"
    set -u
    "$@"
  )
}

buildCommand() {
  startCommand 3 run
  buildBoth tools tools
  say "Built. The tools are in build/bin: $(ls build/bin | tr '\n' ' ')"
  say "For ROS: source build/catkin/devel/setup.bash"
}

# catkinIsolated: a copy of the project in a workspace outside of it, each package built by itself, as `catkin build` does.
# What is to be seen is that each finds its siblings' headers, messages and libraries, so files are preprocessed only.
catkinIsolated() {
  local folder status=0
  folder=$(mktemp -d) || return
  copyTree "$folder/src/polyfly" || return
  (
    cd "$folder" || exit
    catkin init
    catkin build --no-status --no-color --summary -p 1 "-j$(jobs_at_once)" --cmake-args \
      -DPYTHON_EXECUTABLE=/usr/bin/python3 -DCMAKE_BUILD_TYPE=Debug \
      "-DCMAKE_CXX_COMPILER_LAUNCHER=$root/catkin_ws/scripts/preprocess_only.sh" \
      -DCMAKE_EXE_LINKER_FLAGS=-Wl,--unresolved-symbols=ignore-all
  ) || status=$?
  # catkin ends with 0 where it finds no package.
  [ "$status" -ne 0 ] || [ -d "$folder/devel/share/polyfly_test" ] || status=1
  rm -rf "$folder"
  return "$status"
}

# The workspaces of users: one with a copy of the project, each package built by itself; and one from source alone.
isolatedCommand() {
  startCommand 1 run workspace
  isolatedStep
  say "1 passed, 0 failed"
}

workspaceCommand() {
  startCommand 2 run workspace
  own workspace
  step workspace "building the catkin workspace from source alone" catkinMake build/workspace
  isolatedStep
  say "2 passed, 0 failed"
}

isolatedStep() {
  step isolated "seeing that each package of a copy finds its siblings in a build of its own" catkinIsolated
}
