# shellcheck shell=bash
# ./run systems: the demo and the tests in a clean root of each system that ./run supports.

declare -A release_names=([11]=bullseye [12]=bookworm [13]=trixie)

# inRoot FOLDER COMMAND...: in the copy of this tree below FOLDER, as root there. The mounts end with the command.
inRoot() {
  # shellcheck disable=SC2016  # expanded by the shell that it starts
  unshare --mount bash -c '
    mount --rbind /dev "$1/dev" && mount -t proc proc "$1/proc" || exit
    exec chroot "$1" env -i HOME=/root LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin \
      "POLYFLY_ARCHIVES=$POLYFLY_ARCHIVES" \
      bash -c "cd /polyfly && exec \"\$@\"" bash "${@:2}"' bash "$@"
}

# POLYFLY_ARCHIVES, an address or a folder, counts there too (polyfly_find_headers).
export POLYFLY_ARCHIVES=${POLYFLY_ARCHIVES:-}

# makeRoot RELEASE FOLDER: Debian's least, git, and the files of this tree as they are, without what was built.
makeRoot() {
  rm -rf --one-file-system "$2"
  debootstrap --variant=minbase --include=git,ca-certificates "$1" "$2" || return
  cp /etc/hosts "$2/etc/hosts"
  [ ! -d "$POLYFLY_ARCHIVES" ] || cp -r --parents -t "$2" "$(realpath "$POLYFLY_ARCHIVES")" || return
  mkdir "$2/polyfly"
  git ls-files -z --cached --others --exclude-standard | xargs -0 cp -P --parents -t "$2/polyfly" &&
    git init -q "$2/polyfly"
}

# trySystem NUMBER: what fails there is told, and stops the rest of this system only.
trySystem() {
  local folder=$root/build/systems/debian$1 log=build/.run/log/debian$1_test.log
  step "debian$1_root" "Debian $1: making a root" makeRoot "${release_names[$1]}" "$folder" &&
    step "debian$1_demo" "Debian $1: ./run demo, from no package to a report" inRoot "$folder" ./run demo &&
    step "debian$1_test" "Debian $1: ./run test" inRoot "$folder" ./run test &&
    say "Debian $1: $(tail -n 1 "$log")"
}

systemsCommand() {
  local number status=0
  local -a numbers=("${@:-11}")
  [ $# -gt 0 ] || numbers=(11 12 13)
  if [ "$(id -u)" -ne 0 ] || ! command -v debootstrap > /dev/null; then
    say "Skipped: roots of other systems are made by debootstrap as root, and here is no root, or no debootstrap."
    say "0 passed, 0 failed, ${#numbers[@]} skipped"
    return 0
  fi
  own systems
  step_count=$((3 * ${#numbers[@]}))
  for number in "${numbers[@]}"; do trySystem "$number" || status=1; done
  return "$status"
}
