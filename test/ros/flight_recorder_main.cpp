#include "flight_recorder.hpp"
#include "run_node.hpp"

int main(int argc, char** argv) {
  return polyfly_ros::runNode<polyfly_ros::FlightRecorder>(argc, argv, "flight_recorder");
}
