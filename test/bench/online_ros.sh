# shellcheck shell=bash
# From odometry to command over ROS: as nodelet in one manager and as node over TCP, in peace and while options
# change a hundred times a second.
solveAxes > /dev/null || return
inWorkspace python3 test/bench/online_ros.py build/demo/maps "$output"
