#include "validation/report.hpp"

#include <algorithm>
#include <iterator>
#include <locale>
#include <sstream>

#include "flight_figures.hpp"
#include "online_controller/laws/axis.hpp"
#include "polyfly_base/options_text.hpp"
#include "polyfly_base/write_file.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

using Fault = ReportColumn::Rule;

// Excursions beyond these are in the summary only.
constexpr std::size_t kShownExcursions = 20;
// In the order of Verdict.
constexpr const char* kVerdictSentences[] = {
    "Passed: the maps held the flight, and the record agrees with them. Nothing is said of regions that were "
    "not visited.",
    "Doubtful: the maps held what was read of the flight, but the record may not say what it seems to say.",
    "Failed: the flight breaks a rule."};

// The objects of the list `name` of each of `objects`, each with its axis.
Json rowsBelow(const Json& objects, const std::string& name) {
  Json rows = Json::array();
  for (const Json& object : objects) {
    for (const Json& row : object.at(name)) {
      rows.push_back(row);
      rows.back()["axis"] = object.at("axis");
    }
  }
  return rows;
}

std::vector<ReportTile> tilesOn(const ValidationReport& report) {
  std::vector<ReportTile> tiles = {
      {number(100.0 * report.tracking.rms) + " cm", "tracking error, root mean square"},
      {number(100.0 * report.tracking.max) + " cm", "tracking error, greatest"},
      {number(report.top_speed) + " m/s", "top speed"}};
  if (report.hold)
    tiles.push_back({number(1000.0 * report.hold->offset.norm()) + " mm", "offset at rest at the end"});
  tiles.push_back({std::to_string(report.violationCount()),
                   "commands out of bounds, of " + std::to_string(report.commands.recorded),
                   report.violationCount() == 0});
  tiles.push_back({percent(report.coverage),
                   "of " + std::to_string(report.tracked_samples) + " samples inside the maps; outside for " +
                       number(report.outside_map_time) + " s",
                   report.outside_map_samples == 0});
  tiles.push_back({std::to_string(report.visitedCount()) + " of " + std::to_string(report.regionCount()),
                   "regions visited"});
  tiles.push_back({number(report.maxQpDifference(), 2), "greatest difference to the online QP"});
  const CommandValidation& commands = report.commands;
  const bool exact = commands.max_difference == 0.0;
  tiles.push_back({exact ? "exact" : number(commands.max_difference, 2),
                   exact ? "replay: the recorded commands, bit for bit"
                         : "greatest difference to the recorded commands"});
  if (commands.compared == 0) tiles.back() = {"–", "no command is compared with a replay", false};
  tiles.push_back({number(report.lookup_ns.p50) + " ns",
                   "median look-up; 99 % below " + number(report.lookup_ns.p99) + " ns"});
  if (!report.statuses.step_ns.max) return tiles;
  tiles.push_back({number(report.statuses.step_ns.p50 / 1000.0, 2) + " µs",
                   "median control step in flight; 99 % below " +
                       number(report.statuses.step_ns.p99 / 1000.0, 2) + " µs"});
  return tiles;
}

std::string orElse(const Json& text, const std::string& otherwise) {
  return text.get<std::string>().empty() ? otherwise : text.get<std::string>();
}

void addParameters(const Json& parameters, std::vector<ReportSection>* sections) {
  ReportSection section = {"Parameters in force"};
  if (parameters.is_null()) {
    section.sentences = {
        "The bag does not tell them: record the topic parameters_in_force of the controller."};
    sections->push_back(section);
    return;
  }
  section.sentences = {
      "Told when the first command was sent; rosparam load reads parameters_in_force.yaml beside the page.",
      "law " + wordsOn(parameters["law"]) + ", told by " + wordsOn(parameters["node"]) + ", version " +
          orElse(parameters["version"], "unknown"),
      "calibrated options: " + orElse(parameters["provenance"], "no provenance is stated")};
  section.table = tableOf(parameters["axes"], {{"axis", "/axis"},
                                               {"map", "/map"},
                                               {"checksum", "/map_checksum"},
                                               {"problem (none: made of the options)", "/problem"},
                                               {"calibrated", "/calibration"}});
  if (parameters["changes"].empty()) section.sentences.push_back("Nothing changed after the first command.");
  sections->push_back(section);
  if (parameters["changes"].empty()) return;
  sections->push_back(
      {"Changed in flight",
       {},
       {},
       tableOf(parameters["changes"], {{"at [s]", "/at_s"}, {"by", "/cause"}, {"what", "/parameters"}}),
       {}});
}

void addExcursions(const Json& axes, std::vector<ReportSection>* sections) {
  Json rows = rowsBelow(axes, "excursions");
  if (rows.empty()) return;
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Json& one, const Json& other) { return one["samples"] > other["samples"]; });
  ReportSection section = {"Where the flight left the map",
                           {"Stretches outside a map, the longest first, and what the controller did."}};
  if (rows.size() > kShownExcursions) {
    section.sentences.push_back("And " + std::to_string(rows.size() - kShownExcursions) +
                                " shorter ones, in summary.json.");
    rows.get_ref<Json::array_t&>().resize(kShownExcursions);
  }
  for (Json& row : rows) {
    std::ostringstream time;
    time.imbue(std::locale::classic());
    time.precision(12);
    time << row["from_s"].get<double>();
    row["from"] = time.str();
    row["length"] = row["to_s"].get<double>() - row["from_s"].get<double>();
  }
  section.table = tableOf(rows, {{"axis", "/axis"},
                                 {"from [s]", "/from"},
                                 {"for [s]", "/length"},
                                 {"samples", "/samples"},
                                 {"why", "/cause"},
                                 {"parameter", "/parameter"},
                                 {"beyond its range by", "/beyond"},
                                 {"unit", "/unit"},
                                 {"answers", "/status"}});
  sections->push_back(section);
}

ReportSection axesSection(const Json& axes) {
  return {"The three axes in numbers",
          {"Each axis has its own region map. Distances are in ranges scaled to -1 .. 1. A map of a robust "
           "law is not solved again "
           "online: offline_mpt verify --exact proves it."},
          {},
          tableAcross(axes, "/axis",
                      {{"regions in the map", "/regions"},
                       {"regions visited", "/regions_visited"},
                       {"samples", "/samples"},
                       {"inside the map", "/inside"},
                       {"outside: a parameter out of its range", "/outside_box", Fault::kZero},
                       {"outside: in range, but in no region", "/outside_partition", Fault::kZero},
                       {"not finite", "/not_finite", Fault::kZero},
                       {"distance to the nearest face, least", "/face_distance/least"},
                       {"distance to the edge of the map, least", "/edge_distance/least"},
                       {"along", "/edge_distance/parameter"},
                       {"compared with the online QP", "/qp_compared"},
                       {"greatest difference to it", "/qp_difference/max"},
                       {"unit of the input", "/input_unit"},
                       {"samples that it could not solve", "/qp_failures", Fault::kZero},
                       {"position error, rms [m]", "/tracking_m/rms"},
                       {"position error, greatest [m]", "/tracking_m/max"},
                       {"look-up, median [ns]", "/lookup_ns/p50"},
                       {"look-up, 99 % below [ns]", "/lookup_ns/p99"}}),
          {}};
}

ReportSection recordSection(const Json& json) {
  const Json& commands = json["commands"];
  const Json& status = json["status"];
  const auto told = [](const Json& counts) {
    Json met = Json::object();
    for (const auto& [name, count] : counts.items()) {
      if (count > 0) met[name] = count;
    }
    return wordsOn(met);
  };
  ReportSection section = {"Replay against the record"};
  section.sentences = {
      commands["compared"].dump() + " of " + commands["recorded"].dump() + " recorded commands compared, " +
          commands["unmatched"].dump() + " answer no odometry, " + commands["unanswered"].dump() +
          " odometry messages without a command. Out of bounds: " + wordsOn(commands["violations"]) + ".",
      "Status and regions differ in " + status["differing"].dump() + " of " + status["compared"].dump() +
          " samples, parameters by up to " + wordsOn(status["max_theta_difference"]) +
          ". Recorded inputs differ from the maps' laws at the recorded parameters by up to " +
          wordsOn(status["max_input_difference"]) + ".",
      "Answers of the replay: " + told(status["replayed"]) + ". Recorded: " + told(status["recorded"]) + "."};
  if (!json["hold"].is_null())
    section.sentences.push_back("At rest at the end: offset " + wordsOn(json["hold"]["offset_m"]) + " m.");
  Json rows = Json::array();
  for (const auto& [name, difference] : commands["difference"].items()) {
    rows.push_back(difference);
    rows.back()["command"] = name;
  }
  section.table = tableOf(
      rows, {{"recorded − replayed", "/command"}, {"greatest", "/max"}, {"rms", "/rms"}, {"unit", "/unit"}});
  return section;
}

}  // namespace

std::vector<std::string> brokenThresholds(const ValidationReport& report, const Thresholds& thresholds) {
  std::vector<std::string> broken;
  // Written so that a NaN breaks its threshold.
  const auto check = [&broken](bool good, const std::string& what, double value, const char* rule,
                               double limit) {
    if (good) return;
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << what << " is " << value << ", must be at " << rule << " " << limit;
    broken.push_back(text.str());
  };
  const auto atMost = [&check](const std::string& what, double value, double limit) {
    check(value <= limit, what, value, "most", limit);
  };
  const auto atLeast = [&check](const std::string& what, double value, double limit) {
    check(value >= limit, what, value, "least", limit);
  };
  const bool is_known = report.incomparable.empty();
  if (report.tracked_samples > 0 || is_known) atLeast("coverage", report.coverage, thresholds.min_coverage);
  atMost("difference to the online QP", report.maxQpDifference(), thresholds.max_qp_difference);
  atMost("difference to the recorded commands", report.commands.max_difference,
         thresholds.max_command_difference);
  if (!is_known && report.incomparable.front().cause == Ignorance::kVersion)
    atMost("difference of the recorded inputs to the maps' laws", report.statuses.max_input_difference,
           kLawTolerance);
  atMost("number of commands out of bounds", static_cast<double>(report.violationCount()),
         static_cast<double>(thresholds.max_violations));
  if (is_known) {
    atLeast("number of samples with a reference", static_cast<double>(report.tracked_samples), 1.0);
    atLeast("number of commands that answer a recorded odometry",
            static_cast<double>(report.commands.compared), 1.0);
  }
  std::size_t failures = 0;
  for (const AxisValidation& axis : report.axes) failures += axis.qp_failures;
  atMost("number of samples in the map without an online solution", static_cast<double>(failures), 0.0);
  return broken;
}

Report reportOn(const ValidationReport& report) {
  const Json json = jsonOf(report);
  Report page;
  page.title = "Flight report";
  page.sources = {fileName(report.source) + " · " + number(report.duration) + " s · " +
                  std::to_string(report.samples) + " samples"};
  if (report.share) page.sources.push_back("Read: " + describe(*report.share));
  page.good = report.verdict() == Verdict::kPassed;
  page.verdict = kVerdictSentences[static_cast<std::size_t>(report.verdict())];
  page.reasons = report.broken;
  page.reasons.insert(page.reasons.end(), report.warnings.begin(), report.warnings.end());
  page.tiles = tilesOn(report);
  addParameters(json["parameters"], &page.sections);
  page.sections.push_back(
      {"Coverage",
       {"What the flight used of each parameter's range in the maps. Room: how far it could still have moved "
        "alone before its map ended. Proposed: the range that would have held the flight, with a tenth of "
        "what was met beyond a passed end."},
       {},
       tableOf(rowsBelow(json["axes"], "parameters"), {{"axis", "/axis"},
                                                       {"parameter", "/name"},
                                                       {"unit", "/unit"},
                                                       {"from", "/lower"},
                                                       {"to", "/upper"},
                                                       {"least", "/least"},
                                                       {"greatest", "/greatest"},
                                                       {"room", "/room"},
                                                       {"proposed", "/proposed_range"},
                                                       {"outside", "/outside", Fault::kZero}}),
       {}});
  addExcursions(json["axes"], &page.sections);
  page.sections.push_back(axesSection(json["axes"]));
  page.sections.push_back(recordSection(json));
  return page;
}

Report reportOn(const ReportContent& content) {
  Report page = reportOn(content.validation);
  std::vector<ReportSection> sections;
  sections.push_back({"Explore the maps",
                      {"A page for each map, with slices, this flight's samples and simulated flights, is "
                       "written by: offline_mpt explore "
                       "MAP --samples samples_AXIS.csv -o PAGE.html"},
                      {},
                      {},
                      {}});
  for (ReportSection& figure : flightFigures(content)) sections.push_back(std::move(figure));
  page.sections.insert(page.sections.begin(), std::make_move_iterator(sections.begin()),
                       std::make_move_iterator(sections.end()));
  return page;
}

std::string samplesFile(std::size_t axis) {
  return std::string("samples_") + kAxisNames.at(axis).axis + ".csv";
}

namespace {

// The parameters of an axis at each sample that has them; times count from the first sample.
std::string samplesText(const ReportContent& content, std::size_t axis) {
  std::string text = "t";
  for (const Signal& parameter : content.maps[axis]->parameters()) text += "," + parameter.name;
  text += "\n";
  for (const ReplaySample& sample : content.samples) {
    const AxisReport& report = sample.report.axis[axis];
    if (report.size == 0) continue;
    text += exactNumber(sample.report.stamp - content.samples.front().report.stamp);
    for (int i = 0; i < report.size; ++i)
      text += "," + exactNumber(report.theta[static_cast<std::size_t>(i)]);
    text += "\n";
  }
  return text;
}

}  // namespace

void writeReport(const ReportContent& content, const std::string& folder) {
  writePage(folder, reportOn(content), "summary.json", dumped(jsonOf(content.validation)));
  for (std::size_t axis = 0; axis < content.maps.size(); ++axis)
    writeFileAtomically(folder + "/" + samplesFile(axis), samplesText(content, axis));
}

void writeOverview(const std::vector<ValidationReport>& flights, const ValidationReport& all,
                   const std::string& folder) {
  const Json json = jsonOf(all, flights);
  Report page = reportOn(all);
  ReportSection section = {"The flights"};
  for (std::size_t i = 0; i < flights.size(); ++i)
    section.links.push_back({fileName(flights[i].source), "flight_" + std::to_string(i + 1) + "/index.html"});
  section.table = tableOf(json["flights"], {{"flight", "/source"},
                                            {"samples", "/samples"},
                                            {"share inside the maps", "/coverage"},
                                            {"tracking error, rms [m]", "/tracking_rms_m"},
                                            {"regions visited", "/regions_visited"},
                                            {"verdict", "/verdict"}});
  page.sections.insert(page.sections.begin(), section);
  writePage(folder, page, "summary.json", dumped(json));
}

}  // namespace polyfly
