# shellcheck shell=bash
# The packages of the system: looked up with dpkg, installed with apt-get only where one is missing.

# packagesOf KIND...: their names on this system, out of catkin_ws/scripts/packages.txt.
packagesOf() {
  local kind system
  system=$(systemName)
  for kind in "$@"; do
    awk -v kind="$kind" -v system_name="${system// /}" '$1 == kind {
      name = $2
      for (i = 3; i <= NF; ++i) if (index($i, system_name ":") == 1) name = substr($i, length(system_name) + 2)
      if (name != "-") print name
    }' catkin_ws/scripts/packages.txt | tr ',' '\n'
  done
}

# missingPackages KIND...: those that are not installed.
missingPackages() {
  comm -23 <(packagesOf "$@" | sort -u) \
    <(dpkg-query --show --showformat='${db:Status-Status} ${Package}\n' 2> /dev/null | awk '$1 == "installed" {print $2}' | sort -u)
}

installPackages() {
  local -a as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo)
  fi
  export DEBIAN_FRONTEND=noninteractive
  "${as_root[@]}" apt-get update -q || return
  "${as_root[@]}" apt-get install -q -y --no-install-recommends "$@"
}

# requireKnownSystem: the packages have known names on these systems; elsewhere, says what to do.
requireKnownSystem() {
  local system
  system=$(systemName)
  case "$system" in
    "debian 11" | "debian 12" | "debian 13" | "ubuntu 20.04") return 0 ;;
  esac
  die "this installs packages on Debian 11, 12 and 13 and Ubuntu 20.04 only, and this system is '$system'. Elsewhere, either
  - run it in a container or a virtual machine with Debian, for example
      docker run -it -v \"\$PWD\":/polyfly -w /polyfly debian:13 ./run demo
  - or build what needs no ROS (solver, region maps, control laws, identification) with CMake:
      cmake -S . -B build/release -DBUILD_TESTING=OFF && cmake --build build/release --target tools
    which needs CMake 3.16, a compiler for C++17 (GCC 9), Python 3, and the libraries Eigen 3.3, CGAL, GMP, NLopt,
    xxHash, bzip2, lz4, yaml-cpp and nlohmann-json 3.9; for the tests, also GoogleTest and GLPK."
}

# useSystem: the compiler and the ROS of a system that does not have them where others do.
useSystem() {
  case "$(systemName)" in
    "debian 11") export CXX=${CXX:-g++-9} ;;  # that of Ubuntu 20.04; its own is newer
    "ubuntu 20.04")
      set +u
      # shellcheck source=/dev/null
      [ ! -f /opt/ros/noetic/setup.bash ] || . /opt/ros/noetic/setup.bash
      set -u ;;
  esac
}

# systemName: as os-release gives it, such as "debian 12".
systemName() {
  { cat /etc/os-release 2> /dev/null || echo "ID=$(uname -s)"; } |
    awk -F= '{gsub(/"/, "", $2)} $1 == "ID" {id = $2} $1 == "VERSION_ID" {version = " " $2} END {print id version}'
}

# requirePackages KIND...: installs what is missing, as a step more, or says what to do.
requirePackages() {
  local -a missing
  mapfile -t missing < <(missingPackages "$@")
  if [ ${#missing[@]} -eq 0 ]; then
    return 0
  fi
  requireKnownSystem
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo > /dev/null ||
      die "these packages are missing, and installing them needs root or sudo: ${missing[*]}"
    sudo -v || die "installing the missing packages needs root: ${missing[*]}"
  fi
  step_count=$((step_count + 1))
  step install "installing ${#missing[@]} packages and what they depend on" installPackages "${missing[@]}"
}

installCommand() {
  startCommand 0 run
  say "Everything needed is installed."
}
