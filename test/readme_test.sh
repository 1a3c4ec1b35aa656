#!/bin/bash
# Runs every ```sh block of README.md in order, in one shell, from the project's root. Each command is shown
# before it runs; the first that fails ends the test. Needs a built tree (./run build); flies under a ROS
# master of its own.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

commands=$(awk '/^```sh$/ {inside = 1; next} /^```$/ {inside = 0} inside' README.md)
if [ "$(grep -c . <<< "$commands")" -lt 10 ]; then
  echo "README.md holds fewer than ten lines of commands: its blocks were not found" >&2
  exit 1
fi
port=$(/usr/bin/python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
unset ROS_HOSTNAME
export ROS_MASTER_URI="http://127.0.0.1:$port" ROS_IP=127.0.0.1 PATH="/usr/bin:/bin:$PATH"
# Not -u: the set-up files of catkin read variables that may be unset.
exec bash -e -o pipefail -x <(printf '%s\n' "$commands") < /dev/null
