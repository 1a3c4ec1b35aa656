#include <iostream>
#include <string>

#include "excitation_ros/excite_node.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/visible.hpp"

// excite --plan FILE prints duration and spectrum, without ROS; otherwise the node.
int main(int argc, char** argv) {
  try {
    if (argc >= 2 && std::string(argv[1]) == "--plan") {
      if (argc != 3) throw polyfly::Error("--plan: must be followed by one plan file");
      std::cout << polyfly::describe(polyfly::loadPlan(argv[2]));
      return 0;
    }
    ros::init(argc, argv, "excite");
    polyfly_ros::ExciteNode node(ros::NodeHandle(), ros::NodeHandle("~"));
    ros::spin();
  } catch (const std::exception& error) {
    std::cerr << "excite: " << polyfly::visible(error.what()) << "\n";
    return 2;
  }
  return 0;
}
