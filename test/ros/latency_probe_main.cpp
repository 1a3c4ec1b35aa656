#include "latency_probe.hpp"
#include "run_node.hpp"

int main(int argc, char** argv) {
  return polyfly_ros::runNode<polyfly_ros::LatencyProbe>(argc, argv, "latency_probe");
}
