#include <unistd.h>

#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "command_line/command_line.hpp"
#include "command_line/read_progress.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/visible.hpp"
#include "polyfly_base/write_file.hpp"
#include "region_maps/region_map.hpp"
#include "validation/controller_options.hpp"
#include "validation/filter_validation.hpp"
#include "validation_ros/filter_bag.hpp"

namespace {

constexpr int kPassed = 0;
constexpr int kDoubtful = 1;

struct Arguments {
  std::string bag;
  std::vector<std::string> maps;
  std::string options;
  polyfly_ros::FilterTopics topics;
  polyfly::FilterTiming timing;
  std::string json;
  std::string report;
  bool strict = false;
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& arguments) {
  const auto add = [&app](const char* name, auto& value, const char* type, const char* meaning) {
    return app.add_option(name, value, meaning)->type_name(type);
  };
  const auto addPeriods = [&app](const char* name, double& periods, const char* meaning) {
    app.add_option(name, periods, meaning)->check(polyfly::numberFrom(1.0, 100.0))->capture_default_str();
  };
  const auto addTopic = [&app](const char* name, std::string& topic, const char* meaning) {
    app.add_option(name, topic, meaning)
        ->capture_default_str()
        ->group("Topics (without a leading slash: in the namespace)");
  };
  add("--bag", arguments.bag, "FILE", "Bag with commands of a controller and odometry.")->required();
  add("--map", arguments.maps, "FILE", "Maps of the safety filter, one to three, in any order.")->required();
  add("--options", arguments.options, "FILE",
      "Options file (YAML) of the filter's node: vehicle, controller (default: the defaults).");
  addPeriods("--silence-periods", arguments.timing.silence_periods, "The node's parameter silence_periods.");
  addPeriods("--stale-periods", arguments.timing.stale_periods, "The node's parameter stale_periods.");
  add("--json", arguments.json, "FILE", "Write the results to this file as JSON.");
  add("--report", arguments.report, "DIR", "Write index.html and summary.json into this folder.");
  app.add_flag("--strict", arguments.strict, "End with exit code 1 if there is anything to be looked at.");
  app.add_flag("--quiet", arguments.quiet, "Print nothing but errors and what is to be looked at.");
  auto& topics = arguments.topics;
  addTopic("--namespace", topics.name_space,
           "Namespace of the vehicle (default: that of the command topic).");
  addTopic("--odometry", topics.odometry, "Topic of type nav_msgs/Odometry.");
  addTopic("--wish", topics.wish,
           "Topic of type mav_msgs/RollPitchYawrateThrust: what the controller commanded.");
  addTopic("--status", topics.status, "Topic of type online_controller/CommandFilterStatus; may be missing.");
  app.footer(
      "Exit codes: 0 replayed; 1 there is something to be looked at, with --strict; 2 an input or option is "
      "invalid.");
}

// Before the work: whether all results can be written, and none over a file that is read.
void checkResults(const Arguments& arguments) {
  using polyfly::Output;
  std::vector<std::string> inputs = arguments.maps;
  inputs.push_back(arguments.bag);
  inputs.push_back(arguments.options);
  std::vector<Output> outputs = {{arguments.json}};
  if (!arguments.report.empty()) {
    for (const char* name : {"/index.html", "/summary.json"})
      outputs.push_back({arguments.report + name, Output::Kind::kText, Output::Folder::kIsMade});
  }
  polyfly::checkOutputs(outputs, inputs);
}

int run(const Arguments& arguments) {
  std::vector<polyfly::RegionMap> maps;
  for (const std::string& path : arguments.maps) maps.push_back(polyfly::RegionMap::open(path));
  const polyfly::MultirotorOptions options = arguments.options.empty()
                                                 ? polyfly::MultirotorOptions{}
                                                 : polyfly::loadControllerOptions(arguments.options);
  polyfly::CommandFilter filter(std::move(maps), options);
  checkResults(arguments);
  polyfly_ros::BagProgress progress;
  if (!arguments.quiet && isatty(STDERR_FILENO) != 0) progress = polyfly::showReadProgress;
  const polyfly::FilterLog log = polyfly_ros::readFilterBag(arguments.bag, arguments.topics, progress);
  for (const std::string& remark : log.remarks)
    std::cerr << polyfly::visible("note: " + log.source + ": " + remark) << "\n";
  const polyfly::FilterReplay replay = polyfly::replayFilter(log, arguments.timing, filter);
  const polyfly::Json judgement = polyfly::judgeFilter(log, replay, filter);
  if (!arguments.report.empty()) polyfly::writeFilterReport(judgement, replay, filter, arguments.report);
  if (!arguments.json.empty()) polyfly::writeFileAtomically(arguments.json, polyfly::dumped(judgement));
  const polyfly::Report report = polyfly::reportOnFilter(judgement);
  if (!arguments.quiet) std::cout << polyfly::visibleLines(polyfly::toText(report));
  if (arguments.quiet) {
    for (const std::string& finding : report.reasons)
      std::cerr << polyfly::visible("warning: " + log.source + ": " + finding) << "\n";
  }
  return arguments.strict && !report.good ? kDoubtful : kPassed;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Replays a recorded flight through a safety filter, and shows where it acts.",
               "validate_filter");
  Arguments arguments;
  declare(app, arguments);
  return polyfly::runTool(app, argc, argv, [&] { return run(arguments); });
}
