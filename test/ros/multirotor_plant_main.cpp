#include "plant_node.hpp"
#include "run_node.hpp"

int main(int argc, char** argv) {
  return polyfly_ros::runNode<polyfly_ros::PlantNode>(argc, argv, "multirotor_plant");
}
