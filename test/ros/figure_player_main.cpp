#include "figure_player.hpp"
#include "run_node.hpp"

int main(int argc, char** argv) {
  return polyfly_ros::runNode<polyfly_ros::FigurePlayer>(argc, argv, "figure_player");
}
