# shellcheck shell=bash
# The Debian packages: looked up with dpkg, installed with apt-get only where one is missing.

# missingPackages KIND...: those of catkin_ws/scripts/packages.txt that are not installed.
missingPackages() {
  local kind wanted
  wanted=$(for kind in "$@"; do awk -v kind="$kind" '$1 == kind {print $2}' catkin_ws/scripts/packages.txt; done)
  comm -23 <(sort -u <<< "$wanted") \
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

# requireDebian: the packages have these names on Debian 12 and 13; elsewhere, says what to do.
requireDebian() {
  local system
  system=$(systemName)
  case "$system" in
    "debian 12"* | "debian 13"*) return 0 ;;
  esac
  die "this installs packages on Debian 12 and 13 only, and this system is '$system'. Elsewhere, either
  - run it in a container or a virtual machine with Debian, for example
      docker run -it -v \"\$PWD\":/polyfly -w /polyfly debian:13 ./run demo
  - or build what needs no ROS (solver, region maps, control laws, identification) with CMake:
      cmake --preset release -DBUILD_TESTING=OFF && cmake --build --preset release --target tools
    which needs CMake 3.21, Ninja, a compiler for C++17, Python 3, and the libraries Eigen 3.4, CGAL, GMP, NLopt,
    xxHash, bzip2, lz4, yaml-cpp, nlohmann-json and CLI11; for the tests, also GoogleTest and GLPK."
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
  requireDebian
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo > /dev/null ||
      die "these packages are missing, and installing them needs root or sudo: ${missing[*]}"
    sudo -v || die "installing the missing packages needs root: ${missing[*]}"
  fi
  step_count=$((step_count + 1))
  step install "installing ${#missing[@]} Debian packages and what they depend on" installPackages "${missing[@]}"
}

installCommand() {
  startCommand 0 run
  say "Everything needed is installed."
}
