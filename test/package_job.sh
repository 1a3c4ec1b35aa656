#!/bin/bash
# The demo's main job with installed packages alone, then a program and a script that use them. package_test.sh starts it.
set -euo pipefail
port=$((20000 + RANDOM % 10000))
export ROS_MASTER_URI="http://127.0.0.1:$port" ROS_IP=127.0.0.1
get() { apt-get install -q -y --no-install-recommends "$@"; }
cd "$(mktemp -d)"
apt-get update -q
get polyfly-tools
set -x

for axis in longitudinal lateral vertical; do
  offline_mpt solve --quiet "/usr/share/polyfly/problems/multirotor_$axis.yaml" -o "multirotor_$axis.map"
done
offline_mpt verify multirotor_lateral.map --exact --certificate lateral.cert
check_certificate lateral.cert --map multirotor_lateral.map
check_problem lateral.cert --map multirotor_lateral.map --problem /usr/share/polyfly/problems/multirotor_lateral.yaml
test -f /usr/share/man/man1/offline_mpt.1.gz -a -f /usr/share/bash-completion/completions/offline_mpt
echo "0.5,-0.2,0,0,0" > thetas.csv
by_tool=$(offline_mpt eval multirotor_lateral.map --csv thetas.csv)

get polyfly-ros gnuplot-nox
for nodelets in false true; do
  timeout --signal=INT --kill-after=10 300 roslaunch --port="$port" polyfly_launch demo.launch \
    maps_dir:="$PWD" bag:="$PWD/flight.bag" nodelets:="$nodelets"
done
validate_bag --bag flight.bag --map multirotor_*.map --options /usr/share/polyfly_launch/config/firefly.yaml --report report
test -s report/index.html
excite --plan /usr/share/polyfly_launch/config/excitation.yaml > /dev/null

get python3-polyfly
by_python=$(python3 -c 'import polyfly; print(*polyfly.open("multirotor_lateral.map")([0.5, -0.2, 0, 0, 0]))')

get libpolyfly-dev cmake g++ make
cmake -S /usr/share/doc/libpolyfly-dev/examples -B examples
cmake --build examples
by_program=$(examples/look_up multirotor_lateral.map 0.5 -0.2 0 0 0)
python3 - "$by_program" "$by_python" "$by_tool" <<'PY'
import sys
program, module, tool = sys.argv[1:]
assert float(program) == float(module) and repr(float(program)) in tool, sys.argv[1:]
PY
