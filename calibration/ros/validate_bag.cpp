#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include "../app/read_progress.hpp"
#include "calibration/controller_options.hpp"
#include "calibration/report.hpp"
#include "calibration/validation.hpp"
#include "calibration_ros/bag_reader.hpp"
#include "region_maps/error.hpp"

namespace {

constexpr int kPassed = 0;
constexpr int kThresholdBroken = 1;
constexpr int kBadInput = 2;

struct Arguments {
  std::string bag;
  std::vector<std::string> maps;
  std::string options;
  polyfly_ros::BagTopics topics;
  polyfly::Thresholds thresholds;
  std::string json;
  std::string report;
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& arguments) {
  app.add_option("--bag", arguments.bag, "Recorded flight")->required()->type_name("FILE");
  app.add_option("--map", arguments.maps, "Region maps of the three axes, in any order")
      ->required()
      ->type_name("FILE");
  app.add_option("--options", arguments.options,
                 "YAML file of the controller that flew (vehicle, controller); its defaults if not given")
      ->type_name("FILE");
  app.add_option("--json", arguments.json, "Write the numbers here")->type_name("FILE");
  app.add_option("--report", arguments.report, "Write index.html and summary.json into this folder")
      ->type_name("DIR");
  app.add_flag("--quiet", arguments.quiet, "Print nothing but errors and broken thresholds");

  auto& topics = arguments.topics;
  const std::string group = "Topics (without a leading slash: in the namespace)";
  app.add_option("--namespace", topics.name_space,
                 "Namespace of the vehicle; found from the commands if not given")
      ->group(group);
  app.add_option("--odometry", topics.odometry, "nav_msgs/Odometry")->capture_default_str()->group(group);
  app.add_option("--trajectory", topics.trajectory, "trajectory_msgs/MultiDOFJointTrajectory")
      ->capture_default_str()
      ->group(group);
  app.add_option("--pose", topics.pose, "geometry_msgs/PoseStamped")->capture_default_str()->group(group);
  app.add_option("--command", topics.command, "mav_msgs/RollPitchYawrateThrust")
      ->capture_default_str()
      ->group(group);
  app.add_option("--status", topics.status, "online_controller/ControllerStatus, may be missing")
      ->capture_default_str()
      ->group(group);
  app.add_option("--disturbance", topics.disturbance,
                 "geometry_msgs/Vector3Stamped, the true one; may be missing")
      ->capture_default_str()
      ->group(group);

  auto& limits = arguments.thresholds;
  constexpr double kGreatest = std::numeric_limits<double>::max();
  const std::string thresholds = "Thresholds";
  app.add_option("--min-coverage", limits.min_coverage, "Least share of samples that all maps hold")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(thresholds);
  app.add_option("--max-qp-difference", limits.max_qp_difference,
                 "Greatest difference between map and online QP [rad or m/s^2]")
      ->check(CLI::Range(0.0, kGreatest))
      ->capture_default_str()
      ->group(thresholds);
  app.add_option("--max-command-difference", limits.max_command_difference,
                 "Greatest difference between recorded and replayed commands [rad, rad/s, m/s^2]")
      ->check(CLI::Range(0.0, kGreatest))
      ->capture_default_str()
      ->group(thresholds);
  app.add_option("--max-violations", limits.max_violations, "Most recorded commands out of their bounds")
      ->capture_default_str()
      ->group(thresholds);
  app.footer("Exit code: 0 all thresholds hold, 1 one is broken, 2 bad input or option.");
}

void writeText(const std::string& text, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw polyfly::Error(path + ": cannot be written");
}

int run(const Arguments& arguments) {
  std::vector<polyfly::RegionMap> maps;
  std::vector<const polyfly::RegionMap*> views;
  for (const std::string& path : arguments.maps) maps.push_back(polyfly::RegionMap::open(path));
  for (const polyfly::RegionMap& map : maps) views.push_back(&map);
  const polyfly::AxisMaps axes = polyfly::assignAxes(views);
  const polyfly::MultirotorOptions options = arguments.options.empty()
                                                 ? polyfly::MultirotorOptions{}
                                                 : polyfly::loadControllerOptions(arguments.options);
  polyfly_ros::BagProgress progress;
  if (!arguments.quiet && isatty(STDERR_FILENO) != 0) progress = polyfly::showReadProgress;
  const polyfly::FlightLog log = polyfly_ros::readBag(arguments.bag, arguments.topics, progress);
  for (const std::string& remark : log.remarks) std::cerr << "note: " << log.source << ": " << remark << "\n";

  const std::vector<polyfly::ReplaySample> samples = polyfly::replay(log, axes, options);
  const polyfly::ValidationReport report = polyfly::validate(log, samples, axes, options);
  const std::vector<std::string> broken = polyfly::brokenThresholds(report, arguments.thresholds);
  if (!arguments.quiet) std::cout << polyfly::toText(report);
  if (!arguments.json.empty()) writeText(polyfly::toJson(report), arguments.json);
  if (!arguments.report.empty()) {
    polyfly::writeReport({log, samples, axes, options, report, broken}, arguments.report);
  }
  for (const std::string& sentence : broken) std::cerr << "broken: " << sentence << "\n";
  return broken.empty() ? kPassed : kThresholdBroken;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Replays a recorded flight through the controller and its region maps, and judges both.",
               "validate_bag");
  Arguments arguments;
  declare(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kPassed : kBadInput;
  }
  try {
    return run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "validate_bag: " << error.what() << "\n";
    return kBadInput;
  }
}
