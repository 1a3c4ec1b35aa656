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

# requirePackages KIND...: installs what is missing, as a step more, or says what to do.
requirePackages() {
  local -a missing
  command -v dpkg-query > /dev/null || die "this needs Debian 12 (no dpkg found here)."
  mapfile -t missing < <(missingPackages "$@")
  if [ ${#missing[@]} -eq 0 ]; then
    return 0
  fi
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
