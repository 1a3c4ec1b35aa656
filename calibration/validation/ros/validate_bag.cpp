#include <unistd.h>

#include <cstdint>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command_line/command_line.hpp"
#include "command_line/prompt.hpp"
#include "command_line/read_progress.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/out_of_memory.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/read_text.hpp"
#include "polyfly_base/visible.hpp"
#include "polyfly_base/write_file.hpp"
#include "region_maps/region_map.hpp"
#include "robust_mpc/online_law.hpp"
#include "validation/controller_options.hpp"
#include "validation/flight_pages.hpp"
#include "validation/map_comparison.hpp"
#include "validation/map_proposal.hpp"
#include "validation/report.hpp"
#include "validation/validation.hpp"
#include "validation_ros/bag_reader.hpp"
#include "validation_ros/validation_topics.hpp"

namespace {

constexpr int kPassed = 0;
constexpr int kThresholdBroken = 1;
// In the folder of the report: what the bag tells of the parameters, to fly again.
constexpr const char* kParametersFile = "/parameters_in_force.yaml";

struct Arguments {
  std::vector<std::string> bags;
  /// The bags of each flight.
  std::vector<std::vector<std::string>> flights;
  std::vector<std::string> maps;
  std::string options;
  polyfly_ros::BagTopics topics;
  polyfly::Thresholds thresholds;
  std::string json;
  std::string report;
  std::string explore;
  std::string propose;
  std::uint64_t propose_limit = 20000;
  std::string topics_bag;
  bool quiet = false;
  bool strict = false;
};

void declare(CLI::App& app, Arguments& arguments) {
  app.add_option("--bag", arguments.bags,
                 "Bags of recorded flights. Pieces of a recording that was split are one flight.")
      ->required()
      ->type_name("FILE");
  app.add_option("--map", arguments.maps,
                 "Region maps of the three axes, in any order. The first map of an axis is the one that "
                 "flew; further ones are compared with it.")
      ->required()
      ->type_name("FILE");
  app.add_option(
         "--options", arguments.options,
         "Options file (YAML) of the controller that flew: vehicle, controller (default: what the bag "
         "tells, else the controller's defaults).")
      ->type_name("FILE");
  app.add_option("--json", arguments.json, "Write the results to this file as JSON.")->type_name("FILE");
  app.add_option("--report", arguments.report, "Write index.html and summary.json into this folder.")
      ->type_name("DIR");
  app.add_option(
         "--explore", arguments.explore,
         "Write a page for each axis into this folder: its map and the flight's samples, to be explored in "
         "a browser. The report links to the pages.")
      ->type_name("DIR");
  app.add_option(
         "--propose", arguments.propose,
         "If the flights left a map, write problem files that would have covered them into this folder.")
      ->type_name("DIR");
  app.add_option("--propose-limit", arguments.propose_limit,
                 "Limit for counting the regions of such a problem; 0: neither count nor propose.")
      ->check(polyfly::wholeNumber<std::uint64_t>())
      ->capture_default_str();
  app.add_option("--topics-bag", arguments.topics_bag,
                 "Write a bag with the results as topics, for rviz and rqt.")
      ->type_name("FILE");
  app.add_flag("--strict", arguments.strict, "End with exit code 1 if there is a warning.");
  app.add_flag("--quiet", arguments.quiet, "Print nothing but errors and broken thresholds.");

  auto& topics = arguments.topics;
  const std::string group = "Topics (without a leading slash: in the namespace)";
  app.add_option("--namespace", topics.name_space,
                 "Namespace of the vehicle (default: that of the command topic).")
      ->group(group);
  app.add_option("--odometry", topics.odometry, "Topic of type nav_msgs/Odometry.")
      ->capture_default_str()
      ->group(group);
  app.add_option("--trajectory", topics.trajectory, "Topic of type trajectory_msgs/MultiDOFJointTrajectory.")
      ->capture_default_str()
      ->group(group);
  app.add_option("--pose", topics.pose, "Topic of type geometry_msgs/PoseStamped.")
      ->capture_default_str()
      ->group(group);
  app.add_option("--command", topics.command, "Topic of type mav_msgs/RollPitchYawrateThrust.")
      ->capture_default_str()
      ->group(group);
  app.add_option("--status", topics.status,
                 "Topic of type online_controller/ControllerStatus; may be missing.")
      ->capture_default_str()
      ->group(group);
  app.add_option("--disturbance", topics.disturbance,
                 "Topic of type geometry_msgs/Vector3Stamped, the true disturbance; may be missing.")
      ->capture_default_str()
      ->group(group);
  app.add_option("--parameters", topics.parameters,
                 "Topic of type std_msgs/String, the parameters in force, below any node; may be missing.")
      ->capture_default_str()
      ->group(group);

  auto& limits = arguments.thresholds;
  const std::string thresholds = "Thresholds";
  app.add_option("--min-coverage", limits.min_coverage, "Least share of samples inside all maps.")
      ->check(polyfly::numberFrom(0.0, 1.0))
      ->capture_default_str()
      ->group(thresholds);
  app.add_option("--max-qp-difference", limits.max_qp_difference,
                 "Greatest difference between map and online QP [rad or m/s^2].")
      ->check(polyfly::numberFrom(0.0))
      ->capture_default_str()
      ->group(thresholds);
  app.add_option("--max-command-difference", limits.max_command_difference,
                 "Greatest difference between recorded and replayed commands [rad, rad/s, m/s^2].")
      ->check(polyfly::numberFrom(0.0))
      ->capture_default_str()
      ->group(thresholds);
  app.add_option("--max-violations", limits.max_violations,
                 "Greatest number of recorded commands outside their bounds.")
      ->check(polyfly::wholeNumber<std::uint64_t>())
      ->capture_default_str()
      ->group(thresholds);
  app.footer(
      "Exit codes: 0 all thresholds hold; 1 one is broken, or there is a warning with --strict; 2 an input "
      "or option is invalid.");
}

std::string proposalFile(const std::string& folder, const polyfly::RegionMap& map) {
  return folder + "/" + std::string(map.name()) + "." + std::string(map.problemKind());
}

// The folder of one flight below that of all.
std::string flightFolder(const Arguments& arguments, const std::string& folder, std::size_t number) {
  return arguments.flights.size() == 1 ? folder : folder + "/flight_" + std::to_string(number);
}

// Before the work: whether all results can be written, and none over a file that is read.
void checkResults(const Arguments& arguments, const polyfly::MapChoice& maps) {
  using polyfly::Output;
  std::vector<std::string> inputs = arguments.bags;
  inputs.insert(inputs.end(), arguments.maps.begin(), arguments.maps.end());
  inputs.push_back(arguments.options);
  std::vector<Output> outputs = {{arguments.topics_bag, Output::Kind::kFile}};
  const auto addPage = [&outputs](const std::string& folder) {
    for (const char* name : {"/index.html", "/summary.json"})
      outputs.push_back({folder + name, Output::Kind::kText, Output::Folder::kIsMade});
  };
  if (!arguments.report.empty()) {
    for (std::size_t number = 1; number <= arguments.flights.size(); ++number) {
      const std::string folder = flightFolder(arguments, arguments.report, number);
      addPage(folder);
      outputs.push_back({folder + kParametersFile, Output::Kind::kText, Output::Folder::kIsMade});
    }
    if (arguments.flights.size() > 1) addPage(arguments.report);
  }
  if (!arguments.explore.empty()) {
    for (std::size_t number = 1; number <= arguments.flights.size(); ++number) {
      for (const std::string& name : polyfly::flightPageNames()) {
        outputs.push_back({flightFolder(arguments, arguments.explore, number) + "/" + name,
                           Output::Kind::kText, Output::Folder::kIsMade});
      }
    }
  }
  if (!arguments.propose.empty()) {
    for (const polyfly::RegionMap* map : maps.flown) {
      outputs.push_back(
          {proposalFile(arguments.propose, *map), Output::Kind::kText, Output::Folder::kIsMade});
    }
  }
  outputs.push_back({arguments.json});
  polyfly::checkOutputs(outputs, inputs);
}

// Fills the report's proposals, and writes their problems where that is asked for.
void propose(const polyfly::MapChoice& maps, const Arguments& arguments, polyfly::ValidationReport* report) {
  if (arguments.propose_limit == 0) return;
  polyfly::ProposalLimits limits;
  limits.regions = arguments.propose_limit;
  for (std::size_t axis = 0; axis < maps.flown.size(); ++axis) {
    const polyfly::AxisValidation& use = report->axes[axis];
    const auto proposal = polyfly::proposeMap(*maps.flown[axis], use, use.axis, limits);
    if (!proposal) continue;
    report->proposals.push_back(*proposal);
    if (arguments.propose.empty() || proposal->problem.empty()) continue;
    polyfly::makeFolder(arguments.propose);
    polyfly::writeFileAtomically(proposalFile(arguments.propose, *maps.flown[axis]), proposal->problem);
  }
}

// What the map of a minimum-peak robust MPC must equal.
polyfly::OnlineOracle robustOracle(const polyfly::RegionMap& map) {
  return polyfly::onlineRobustLaw(std::string(map.problemText()), map.path() + ": problem");
}

// The options that the bag tells, else the defaults.
polyfly::MultirotorOptions optionsOf(const polyfly::FlightLog& log) {
  const auto told = polyfly::parametersTold(log);
  return told ? polyfly::optionsInForce(*told) : polyfly::MultirotorOptions{};
}

double previewPeriodOf(const polyfly::FlightLog& log, const std::string& options) {
  if (!options.empty()) return polyfly::parsePreviewPeriod(polyfly::readText(options), options);
  const auto told = polyfly::parametersTold(log);
  return told ? polyfly::parsePreviewPeriod(told->text, log.source) : polyfly::kPreviewPeriod;
}

// Reads, replays, judges; writes what belongs to this flight alone.
polyfly::ValidationReport judge(const std::vector<std::string>& bag, std::size_t number,
                                const polyfly::MapChoice& maps,
                                const std::optional<polyfly::MultirotorOptions>& given,
                                const Arguments& arguments, polyfly_ros::ValidationTopics* topics) {
  polyfly_ros::BagProgress progress;
  if (!arguments.quiet && isatty(STDERR_FILENO) != 0) progress = polyfly::showReadProgress;
  const polyfly::FlightLog log = polyfly_ros::readBag(
      bag, arguments.topics, progress, arguments.quiet ? polyfly::Ask() : polyfly::promptIfTerminal());
  for (const std::string& remark : log.remarks)
    std::cerr << polyfly::visible("note: " + log.source + ": " + remark) << "\n";
  const polyfly::MultirotorOptions options = given ? *given : optionsOf(log);
  const std::vector<polyfly::ReplaySample> samples =
      polyfly::replay(log, maps.flown, options, previewPeriodOf(log, arguments.options),
                      arguments.thresholds.max_command_difference);
  polyfly::ValidationReport report = polyfly::validate(log, samples, maps.flown, options, robustOracle);
  for (const polyfly::OtherMap& other : maps.others) {
    report.comparisons.push_back(
        polyfly::compareMaps(samples, *maps.flown[other.axis], *other.map, other.axis, robustOracle));
  }
  if (arguments.flights.size() == 1) propose(maps, arguments, &report);
  report.broken = polyfly::brokenThresholds(report, arguments.thresholds);
  if (!arguments.quiet) std::cout << polyfly::visibleLines(polyfly::toText(report));
  if (topics != nullptr) topics->write(samples, maps.flown, report);
  const std::string report_folder = flightFolder(arguments, arguments.report, number);
  std::vector<polyfly::ReportLink> pages;
  if (!arguments.explore.empty()) {
    const std::string folder = flightFolder(arguments, arguments.explore, number);
    polyfly::writeFlightPages(samples, maps.flown, log.source, folder);
    pages = polyfly::flightPageLinks(maps.flown, folder, report_folder);
  }
  if (!arguments.report.empty()) {
    polyfly::writeReport({log, samples, maps.flown, options, report, pages}, report_folder);
    if (report.parameters)
      polyfly::writeFileAtomically(report_folder + kParametersFile, report.parameters->text);
  }
  return report;
}

// What concerns all flights together, where there are several.
std::string summarise(const std::vector<polyfly::ValidationReport>& flights, const polyfly::MapChoice& maps,
                      const Arguments& arguments) {
  if (flights.size() == 1) return polyfly::toJson(flights.front());
  polyfly::ValidationReport all = polyfly::together(flights);
  propose(maps, arguments, &all);
  if (!arguments.quiet) std::cout << "\n" << polyfly::visibleLines(polyfly::toText(all));
  if (!arguments.report.empty()) polyfly::writeOverview(flights, all, arguments.report);
  return polyfly::toJson(all, flights);
}

int run(Arguments& arguments) {
  arguments.flights = polyfly_ros::recordingsOf(arguments.bags);
  std::vector<polyfly::RegionMap> maps;
  std::vector<const polyfly::RegionMap*> views;
  for (const std::string& path : arguments.maps) maps.push_back(polyfly::RegionMap::open(path));
  for (const polyfly::RegionMap& map : maps) views.push_back(&map);
  const polyfly::MapChoice choice = polyfly::chooseMaps(views);
  checkResults(arguments, choice);
  std::optional<polyfly::MultirotorOptions> options;
  if (!arguments.options.empty()) options = polyfly::loadControllerOptions(arguments.options);
  std::unique_ptr<polyfly_ros::ValidationTopics> topics;
  if (!arguments.topics_bag.empty()) {
    topics = std::make_unique<polyfly_ros::ValidationTopics>(arguments.topics_bag);
  }
  std::vector<polyfly::ValidationReport> flights;
  for (const std::vector<std::string>& bag : arguments.flights) {
    flights.push_back(judge(bag, flights.size() + 1, choice, options, arguments, topics.get()));
  }
  if (topics) topics->close();
  const std::string json = summarise(flights, choice, arguments);
  if (!arguments.json.empty()) polyfly::writeFileAtomically(arguments.json, json);
  bool broken = false;
  for (const polyfly::ValidationReport& flight : flights) {
    broken = broken || (arguments.strict && flight.verdict() == polyfly::Verdict::kDoubtful);
    for (const std::string& sentence : flight.warnings) {
      if (arguments.quiet)
        std::cerr << polyfly::visible("warning: " + flight.source + ": " + sentence) << "\n";
    }
    for (const std::string& sentence : flight.broken) {
      broken = true;
      if (!arguments.quiet) continue;
      std::cerr << "broken: " << polyfly::visible((flights.size() > 1 ? flight.source + ": " : "") + sentence)
                << "\n";
    }
  }
  return broken ? kThresholdBroken : kPassed;
}

}  // namespace

int main(int argc, char** argv) {
  polyfly::installOutOfMemoryHandler("validate_bag");  // proposals are counted with GMP
  CLI::App app("Replays a recorded flight through the controller and its region maps, and judges both.",
               "validate_bag");
  Arguments arguments;
  declare(app, arguments);
  return polyfly::runTool(app, argc, argv, [&] { return run(arguments); });
}
