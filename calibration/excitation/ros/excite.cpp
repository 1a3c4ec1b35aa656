#include <iostream>
#include <string>

#include "excitation_ros/excite_node.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/visible.hpp"

namespace {

constexpr const char* kHelp =
    "Flies the manoeuvres of a plan that excite a vehicle's loops, as a ROS node.\n"
    "usage: excite _plan:=FILE [_PARAMETER:=VALUE ...]   the node; excitation/README.md lists its "
    "parameters\n"
    "       excite --plan FILE                           prints a plan and its duration, without ROS\n"
    "       excite --help\n";

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc >= 2 && (std::string(argv[1]) == "--help" || std::string(argv[1]) == "-h")) {
      std::cout << kHelp << std::flush;
      return std::cout ? 0 : 2;
    }
    if (argc >= 2 && std::string(argv[1]) == "--plan") {
      if (argc != 3) throw polyfly::Error("--plan: must be followed by one plan file");
      std::cout << polyfly::describe(polyfly::loadPlan(argv[2])) << std::flush;
      return std::cout ? 0 : 2;
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
