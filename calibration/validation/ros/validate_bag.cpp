#include <unistd.h>

#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "command_line/command_line.hpp"
#include "command_line/read_progress.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/read_text.hpp"
#include "polyfly_base/visible.hpp"
#include "polyfly_base/write_file.hpp"
#include "region_maps/region_map.hpp"
#include "validation/controller_options.hpp"
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
  std::string topics_bag;
  bool quiet = false;
  bool strict = false;
};

void declareTopics(CLI::App& app, polyfly_ros::BagTopics& topics) {
  const std::string group = "Topics (without a leading slash: in the namespace)";
  const auto add = [&](const char* name, std::string& topic, const char* meaning) {
    app.add_option(name, topic, meaning)->capture_default_str()->group(group);
  };
  add("--namespace", topics.name_space, "Namespace of the vehicle (default: that of the command topic).");
  add("--odometry", topics.odometry, "Topic of type nav_msgs/Odometry.");
  add("--trajectory", topics.trajectory, "Topic of type trajectory_msgs/MultiDOFJointTrajectory.");
  add("--pose", topics.pose, "Topic of type geometry_msgs/PoseStamped.");
  add("--command", topics.command, "Topic of type mav_msgs/RollPitchYawrateThrust.");
  add("--status", topics.status, "Topic of type online_controller/ControllerStatus; may be missing.");
  add("--disturbance", topics.disturbance,
      "Topic of type geometry_msgs/Vector3Stamped, the true disturbance; may be missing.");
  add("--parameters", topics.parameters,
      "Topic of type std_msgs/String, the parameters in force, below any node; may be missing.");
}

void declareThresholds(CLI::App& app, polyfly::Thresholds& limits) {
  const auto add = [&](const char* name, auto& limit, const char* meaning, const CLI::Validator& rule) {
    app.add_option(name, limit, meaning)->check(rule)->capture_default_str()->group("Thresholds");
  };
  add("--min-coverage", limits.min_coverage, "Least share of samples inside all maps.",
      polyfly::numberFrom(0.0, 1.0));
  add("--max-qp-difference", limits.max_qp_difference,
      "Greatest difference between map and online QP [rad or m/s^2].", polyfly::numberFrom(0.0));
  add("--max-command-difference", limits.max_command_difference,
      "Greatest difference between recorded and replayed commands [rad, rad/s, m/s^2].",
      polyfly::numberFrom(0.0));
  add("--max-violations", limits.max_violations, "Greatest number of recorded commands outside their bounds.",
      polyfly::wholeNumber<std::uint64_t>());
}

void declare(CLI::App& app, Arguments& arguments) {
  polyfly::addOption(app, "--bag", arguments.bags, "FILE",
                     "Bags of recorded flights. Pieces of a recording that was split are one flight.")
      ->required();
  polyfly::addOption(app, "--map", arguments.maps, "FILE",
                     "Region maps of the three axes that flew, in any order.")
      ->required();
  polyfly::addOption(
      app, "--options", arguments.options, "FILE",
      "Options file (YAML) of the controller that flew: vehicle, controller (default: what the bag tells, "
      "else the controller's defaults).");
  polyfly::addOption(app, "--json", arguments.json, "FILE", "Write the results to this file as JSON.");
  polyfly::addOption(app, "--report", arguments.report, "DIR",
                     "Write index.html, summary.json and the samples of each axis into this folder.");
  polyfly::addOption(app, "--topics-bag", arguments.topics_bag, "FILE",
                     "Write a bag with the results as topics, for rqt.");
  app.add_flag("--strict", arguments.strict, "End with exit code 1 if there is a warning.");
  app.add_flag("--quiet", arguments.quiet, "Print nothing but errors and broken thresholds.");
  declareTopics(app, arguments.topics);
  declareThresholds(app, arguments.thresholds);
  polyfly::addRemoved(app, {"--propose", "--propose-limit"},
                      "was removed; 'proposed_range' in the JSON and on the page is the range that would "
                      "have held the flight");
  polyfly::addRemoved(
      app, {"--explore"},
      "was removed; 'offline_mpt explore MAP --samples samples_AXIS.csv -o PAGE' takes what --report writes");
  app.footer(
      "Exit codes: 0 all thresholds hold; 1 one is broken, or there is a warning with --strict; 2 an input "
      "or option is invalid.");
}

// The folder of one flight below that of all.
std::string flightFolder(const Arguments& arguments, const std::string& folder, std::size_t number) {
  return arguments.flights.size() == 1 ? folder : folder + "/flight_" + std::to_string(number);
}

// Before the work: whether all results can be written, and none over a file that is read.
void checkResults(const Arguments& arguments) {
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
      for (std::size_t axis = 0; axis < polyfly::AxisMaps().size(); ++axis)
        outputs.push_back(
            {folder + "/" + polyfly::samplesFile(axis), Output::Kind::kText, Output::Folder::kIsMade});
    }
    if (arguments.flights.size() > 1) addPage(arguments.report);
  }
  outputs.push_back({arguments.json});
  polyfly::checkOutputs(outputs, inputs);
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

// A flight as it was read, and its replay.
struct Flight {
  polyfly::FlightLog log;
  polyfly::MultirotorOptions options;
  std::vector<polyfly::ReplaySample> samples;

  polyfly::ReplayedFlight view() const { return {log, samples, options}; }
};

Flight readFlight(const std::vector<std::string>& bag, const polyfly::AxisMaps& maps,
                  const std::optional<polyfly::MultirotorOptions>& given, const Arguments& arguments) {
  polyfly_ros::BagProgress progress;
  if (!arguments.quiet && isatty(STDERR_FILENO) != 0) progress = polyfly::showReadProgress;
  Flight flight;
  flight.log = polyfly_ros::readBag(bag, arguments.topics, progress);
  for (const std::string& remark : flight.log.remarks)
    std::cerr << polyfly::visible("note: " + flight.log.source + ": " + remark) << "\n";
  flight.options = given ? *given : optionsOf(flight.log);
  flight.samples =
      polyfly::replay(flight.log, maps, flight.options, previewPeriodOf(flight.log, arguments.options),
                      arguments.thresholds.max_command_difference);
  return flight;
}

void print(const polyfly::ValidationReport& report, const Arguments& arguments) {
  if (!arguments.quiet)
    std::cout << polyfly::visibleLines(polyfly::toText(polyfly::reportOn(report))) << "\n";
}

// Writes what belongs to this flight alone.
void writeResults(const Flight& flight, const polyfly::ValidationReport& report, std::size_t number,
                  const polyfly::AxisMaps& maps, const Arguments& arguments) {
  if (arguments.report.empty()) return;
  const std::string folder = flightFolder(arguments, arguments.report, number);
  polyfly::writeReport({flight.log, flight.samples, maps, flight.options, report}, folder);
  if (report.parameters) polyfly::writeFileAtomically(folder + kParametersFile, report.parameters->text);
}

// All flights as one, with what is said of each.
polyfly::ValidationReport together(const std::vector<Flight>& flights,
                                   const std::vector<polyfly::ValidationReport>& reports,
                                   const polyfly::AxisMaps& maps) {
  std::vector<polyfly::ReplayedFlight> views;
  for (const Flight& flight : flights) views.push_back(flight.view());
  polyfly::ValidationReport all = polyfly::validate(views, maps);
  for (const polyfly::ValidationReport& flight : reports) {
    const std::string name = polyfly::fileName(flight.source) + ": ";
    for (const std::string& sentence : flight.warnings) all.warnings.push_back(name + sentence);
    for (const std::string& sentence : flight.broken) all.broken.push_back(name + sentence);
  }
  return all;
}

// Prints what --quiet leaves to be seen.
int exitCodeOf(const std::vector<polyfly::ValidationReport>& reports, const Arguments& arguments) {
  bool broken = false;
  for (const polyfly::ValidationReport& flight : reports) {
    broken = broken || !flight.broken.empty() || (arguments.strict && !flight.warnings.empty());
    if (!arguments.quiet) continue;
    for (const std::string& sentence : flight.warnings)
      std::cerr << polyfly::visible("warning: " + flight.source + ": " + sentence) << "\n";
    for (const std::string& sentence : flight.broken)
      std::cerr << polyfly::visible("broken: " + (reports.size() > 1 ? flight.source + ": " : "") + sentence)
                << "\n";
  }
  return broken ? kThresholdBroken : kPassed;
}

int run(Arguments& arguments) {
  arguments.flights = polyfly_ros::recordingsOf(arguments.bags);
  std::vector<polyfly::RegionMap> maps;
  std::vector<const polyfly::RegionMap*> views;
  for (const std::string& path : arguments.maps) maps.push_back(polyfly::RegionMap::open(path));
  for (const polyfly::RegionMap& map : maps) views.push_back(&map);
  const polyfly::AxisMaps axes = polyfly::assignAxes(views);
  checkResults(arguments);
  std::optional<polyfly::MultirotorOptions> options;
  if (!arguments.options.empty()) options = polyfly::loadControllerOptions(arguments.options);
  std::vector<Flight> flights;
  std::vector<polyfly::ValidationReport> reports;
  for (const std::vector<std::string>& bag : arguments.flights) {
    flights.push_back(readFlight(bag, axes, options, arguments));
    const Flight& flight = flights.back();
    reports.push_back(polyfly::validate({flight.view()}, axes));
    reports.back().broken = polyfly::brokenThresholds(reports.back(), arguments.thresholds);
    print(reports.back(), arguments);
    writeResults(flight, reports.back(), reports.size(), axes, arguments);
  }
  if (!arguments.topics_bag.empty()) {
    std::vector<polyfly_ros::ValidatedFlight> validated;
    for (std::size_t i = 0; i < flights.size(); ++i) validated.push_back({flights[i].samples, reports[i]});
    polyfly_ros::writeValidationTopics(validated, arguments.topics_bag);
  }
  polyfly::Json json = polyfly::jsonOf(reports.front());
  if (flights.size() > 1) {
    const polyfly::ValidationReport all = together(flights, reports, axes);
    print(all, arguments);
    if (!arguments.report.empty()) polyfly::writeOverview(reports, all, arguments.report);
    json = polyfly::jsonOf(all, reports);
  }
  if (!arguments.json.empty()) polyfly::writeFileAtomically(arguments.json, polyfly::dumped(json));
  return exitCodeOf(reports, arguments);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Replays a recorded flight through the controller and its region maps, and judges both.",
               "validate_bag");
  Arguments arguments;
  declare(app, arguments);
  return polyfly::runTool(app, argc, argv, [&] { return run(arguments); });
}
