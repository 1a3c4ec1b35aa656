#!/bin/bash
# Installs the packages of a folder, a repository of apt, in a clean root of the running release, and runs package_job.sh there.
# usage: package_test.sh FOLDER     the last line says "passed", or "skipped: " and why
set -euo pipefail
packages=$(realpath "$1")
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
. /etc/os-release
skip() { echo "skipped: the packages were not tried in a clean root: $1"; exit 0; }
[ "$(id -u)" -eq 0 ] || skip "that needs root"
command -v debootstrap > /dev/null || skip "there is no debootstrap"
unshare --mount --pid --fork true 2> /dev/null || skip "this container lets nobody mount"

root=$(mktemp -d)
trap 'rm -rf --one-file-system "$root"' EXIT
debootstrap --variant=minbase "$VERSION_CODENAME" "$root"
cp /etc/resolv.conf "$root/etc/"
echo "127.0.0.1 localhost $(hostname)" > "$root/etc/hosts"
mkdir "$root/srv/polyfly"
cp "$packages"/*.deb "$packages/Packages" "$here/package_job.sh" "$root/srv/polyfly/"
echo "deb [trusted=yes] file:/srv/polyfly ./" > "$root/etc/apt/sources.list.d/polyfly.list"
# Its mounts and processes end with it.
unshare --mount --pid --fork --kill-child --mount-proc="$root/proc" chroot "$root" /usr/bin/env -i HOME=/root LC_ALL=C.UTF-8 \
  PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive bash /srv/polyfly/package_job.sh
echo "passed"
