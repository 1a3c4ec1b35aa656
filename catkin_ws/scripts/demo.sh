# shellcheck shell=bash
# ./run demo: the main job, from a fresh machine to a report of a flight.

demoCommand() {
  startCommand 7 run
  # shellcheck disable=SC2086
  buildBoth tools "$demo_tools" $demo_nodes
  own demo
  step maps "solving the region maps of the three axes" solveAxes
  step flight "flying the figure over ROS topics" fly build/demo build/demo/maps \
    overrides:="$PWD/launch/config/strong_push.yaml"
  step report "validating the flight from its bag" validateFlight build/demo build/demo/maps
  step explore "drawing the maps with the flight" exploreFlight build/demo build/demo/maps
  say "The flight:"
  sayResult build/demo
}
