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

# requirePackages KIND...: installs what is missing, or says what to do. Plan the step "install" before.
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
  step install "installing ${#missing[@]} Debian packages and what they depend on" installPackages "${missing[@]}"
}

# planInstall KIND...: plans the step only where something is missing.
planInstall() {
  if [ -n "$(missingPackages "$@" 2> /dev/null)" ]; then
    plan install 90
  fi
}

installCommand() {
  planInstall run
  requirePackages run
  say "Everything needed is installed."
}
