// Flies the figures of the chapter, in calm and in wind, by the MPC and by the usual guidance, and leaves
// what was flown: a CSV for each flight, the paths, summary.json and the rows of the report's tables.
#include "fixedwing_plant/figures.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "addition_figures.hpp"
#include "command_line/command_line.hpp"
#include "fixedwing_lateral/l1_guidance.hpp"
#include "fixedwing_plant/flight_metrics.hpp"
#include "fixedwing_plant/six_dof_aircraft.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/write_file.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;

// Share of a segment's time for joining it.
constexpr double kSettle = 0.5;
// Time before a segment's end in which the next segment is in the horizon [s].
constexpr double kWindow = 7.0;
constexpr double kPeriod = 0.05;  // [s]
constexpr double kAirspeed = 14.0;
constexpr double kDuration = 240.0;
const Vector2d kWind(0.6 * 0.5 * kAirspeed, -0.8 * 0.5 * kAirspeed);

std::ostringstream table() {
  std::ostringstream text;
  text.precision(9);
  return text;
}

std::string flightCsv(const std::vector<PathSegment>& segments, const std::vector<FlightSample>& samples) {
  std::ostringstream file = table();
  file << "t,north,east,distance,roll_deg,reference_deg,rate_deg,segment\n";
  constexpr double kDegree = 180.0 / kPi;
  for (const FlightSample& sample : samples) {
    file << sample.time << ',' << sample.truth.position.x() << ',' << sample.truth.position.y() << ','
         << pathDistance(segments, sample) << ',' << kDegree * sample.truth.roll << ','
         << kDegree * sample.roll_reference << ',' << kDegree * sample.truth.roll_rate << ','
         << sample.output.segment << '\n';
  }
  return file.str();
}

std::string pathCsv(const std::vector<PathSegment>& segments) {
  std::ostringstream file = table();
  constexpr int kPoints = 90;
  for (const PathSegment& segment : segments) {
    const auto* loiter = std::get_if<LoiterCircle>(&segment);
    const double whole = loiter != nullptr ? 2.0 * kPi * loiter->radius : length(segment);
    for (int i = 0; i <= kPoints; ++i) {
      const Vector2d point = pointAt(segment, whole * i / kPoints).position;
      file << point.x() << ',' << point.y() << '\n';
    }
    file << '\n';
  }
  return file.str();
}

AircraftState startAt(const Vector2d& position) {
  AircraftState state;
  state.position = position;
  state.ground_velocity = {kAirspeed, 0.0};
  return state;
}

struct Case {
  std::string figure;  // box; dubins, planned for the wind; or tight: planned for calm
  bool windy = false;
  std::string plant;  // model, rough or six_dof; the last two in gusts
};

// The laws in the order of the tables: as shipped, and the usual guidance.
const std::vector<std::string> kLaws = {"mpc", "l1"};

std::unique_ptr<Aircraft> aircraftOf(const Case& chosen) {
  const Vector2d wind = chosen.windy ? kWind : Vector2d(0.0, 0.0);
  const AircraftState start = startAt({0.0, 0.0});
  if (chosen.plant == "rough") {
    RoughOptions options;
    options.wind = wind;
    options.gust = 0.7;
    return std::make_unique<PerturbedAircraft>(options, start, 1);
  }
  if (chosen.plant == "six_dof") {
    SixDofOptions options;
    options.wind = wind;
    options.turbulence = kWind.norm();
    return std::make_unique<SixDofAircraft>(options, start, 1);
  }
  return std::make_unique<ChapterAircraft>(LateralModel{}, start, kAirspeed, wind);
}

Mission missionOf(const Case& chosen) {
  if (chosen.figure == "box") return boxFigure();
  const bool is_planned = chosen.windy && chosen.figure == "dubins";
  return dubinsFigure(is_planned ? turnsInWind(kWind.norm()) : TurnPlan{});
}

std::vector<FlightSample> fly(const Case& chosen, const Mission& mission, const std::string& law) {
  const std::unique_ptr<Aircraft> aircraft = aircraftOf(chosen);
  SensorOptions late;
  // Only with the plant `model` the wind estimate has no lag.
  if (chosen.plant != "model") late.wind_lag = 3.0;
  Sensors sensors(late, 1);
  if (law == "l1") {
    L1Guidance guidance(mission, SwitchCriterion{}, L1Options{});
    return flyLaw(
        *aircraft, sensors, [&](const GuidanceInput& input) { return guidance.update(input); }, kPeriod,
        kDuration);
  }
  LateralGuidance guidance(GuidanceOptions{}, "experiment");
  guidance.setMission(mission);
  return flyLaw(*aircraft, sensors, lawOf(guidance), kPeriod, kDuration);
}

class Report {
 public:
  explicit Report(const std::string& folder) : folder_(folder) {
    checkOutputs({{fileNamed("summary.json"), Output::Kind::kText, Output::Folder::kIsMade}}, {});
    makeFolder(folder);
  }

  void add(const Case& chosen) {
    const Mission mission = missionOf(chosen);
    const std::string name = chosen.figure + (chosen.windy ? "_wind" : "_calm") +
                             (chosen.plant == "model" ? "" : "_" + chosen.plant);
    write(name + "_path.csv", pathCsv(mission.segments));
    for (const std::string& law : kLaws) {
      const std::string flight = name + "_" + law;
      const std::vector<FlightSample> samples = fly(chosen, mission, law);
      write(flight + ".csv", flightCsv(mission.segments, samples));
      double reference = 0.0;
      for (const FlightSample& sample : samples)
        reference = std::max(reference, std::abs(sample.roll_reference));
      addMetrics(flight, flightMetrics(mission.segments, samples, kSettle, kWindow), reference);
    }
  }

  /// What each addition to the published configuration brings.
  void addAdditions() {
    const AdditionTable table = flyAdditions();
    summary_["additions"] = table.rows;
    additions_ = table.html;
  }

  /// Whether the chapter's bars hold, on the console.
  void printVerdict() const;

  void finish() {
    nlohmann::json all = summary_;
    const auto& calm = summary_["flights"]["box_calm_mpc"];
    const auto& windy = summary_["flights"]["box_wind_mpc"];
    const auto& dubins = summary_["flights"]["dubins_calm_mpc"];
    const auto& dubins_windy = summary_["flights"]["dubins_wind_mpc"];
    const auto& tight = summary_["flights"]["tight_wind_mpc"];
    all["headline"] = {
        {"box, calm: lines once converged", calm["converged_m"], "m"},
        {"box, calm: loiter", calm["loiter_m"], "m"},
        {"box, calm: overshoot", calm["overshoot_m"], "m"},
        {"box, wind: lines once converged", windy["converged_m"], "m"},
        {"box, wind: loiter", windy["loiter_m"], "m"},
        {"Dubins, calm: while joining the path", dubins["largest_m"], "m"},
        {"Dubins, calm: from then on", dubins["after_joining_m"], "m"},
        {"Dubins, calm: loiter", dubins["loiter_m"], "m"},
        {"Dubins planned for the wind, wind: from joining on", dubins_windy["after_joining_m"], "m"},
        {"Dubins planned for the wind, wind: loiter", dubins_windy["loiter_m"], "m"},
        {"Dubins planned for calm, wind: loiter that cannot be flown", tight["loiter_m"], "m"},
        {"the same: largest roll reference", tight["reference_largest_rad"], "rad"}};
    write("summary.json", all.dump(2) + '\n');
    std::ostringstream tables;
    tables
        << "<h2>Flights</h2>\n<table><tr><th>flight</th><th>rms [m]</th><th>largest [m]</th>"
           "<th>joined after [s]</th><th>largest from then on [m]</th><th>lines once converged "
           "[m]</th><th>loiter [m]</th><th>overshoot [m]</th>"
           "<th>roll [deg]</th><th>roll rate, rms [deg/s]</th></tr>\n"
        << flights_.str()
        << "</table>\n<p>A path is joined when the distance stays below 1 m for 3 s for the first time; from "
           "then on "
           "everything counts, corners and junctions too. Lines and the loiter are converged in the second "
           "half of "
           "their time, until the next segment is in the horizon. <em>tight</em> is the Dubins sequence "
           "planned for "
           "calm: in this wind its arcs of 45 m and its loiter of 60 m ask for more roll than is "
           "allowed.</p>\n"
        << "<h2>What each addition brings</h2>\n"
        << additions_;
    write("tables.html", tables.str());
  }

 private:
  std::string fileNamed(const std::string& name) const { return folder_ + "/" + name; }

  void write(const std::string& name, const std::string& text) {
    checkOutputs({{fileNamed(name)}}, taken_);
    writeFileAtomically(fileNamed(name), text);
    taken_.push_back(fileNamed(name));
  }

  void addMetrics(const std::string& flight, const FlightMetrics& metrics, double reference) {
    summary_["flights"][flight] = {{"rms_m", metrics.rms},
                                   {"largest_m", metrics.largest},
                                   {"converged_m", metrics.converged},
                                   {"after_joining_m", metrics.after_joining},
                                   {"joined_s", metrics.joined},
                                   {"loiter_m", metrics.loiter},
                                   {"reference_largest_rad", reference},
                                   {"overshoot_m", metrics.overshoot},
                                   {"roll_largest_rad", metrics.roll_largest},
                                   {"roll_rate_largest_rad_s", metrics.rate_largest},
                                   {"roll_rate_rms_rad_s", metrics.roll_effort}};
    char row[400];
    char joined[60] = "<td>&ndash;</td><td>&ndash;</td>";
    if (metrics.has_joined)
      std::snprintf(joined, sizeof joined, "<td>%.1f</td><td>%.2f</td>", metrics.joined,
                    metrics.after_joining);
    std::snprintf(
        row, sizeof row,
        "<tr><td>%s</td><td>%.2f</td><td>%.2f</td>%s<td>%.2f</td><td>%.2f</td><td>%.2f</td><td>%.1f</td>"
        "<td>%.1f</td></tr>\n",
        flight.c_str(), metrics.rms, metrics.largest, joined, metrics.converged, metrics.loiter,
        metrics.overshoot, metrics.roll_largest * 180.0 / kPi, metrics.roll_effort * 180.0 / kPi);
    flights_ << row;
  }

  std::string folder_;
  std::vector<std::string> taken_;  // read already, or written
  nlohmann::json summary_;
  std::ostringstream flights_;
  std::string additions_;
};

void Report::printVerdict() const {
  struct Bar {
    const char* text;
    const char* flight;
    const char* metric;
    double most;  // [m]
  };
  const Bar bars[] = {{"box in calm, lines", "box_calm_mpc", "converged_m", 1.0},
                      {"box in calm, loiter", "box_calm_mpc", "loiter_m", 1.0},
                      {"box in wind of half the airspeed, lines", "box_wind_mpc", "converged_m", 1.0},
                      {"box in wind of half the airspeed, loiter", "box_wind_mpc", "loiter_m", 1.0},
                      {"Dubins in calm, once joined", "dubins_calm_mpc", "after_joining_m", 3.0},
                      {"Dubins in that wind, once joined", "dubins_wind_mpc", "after_joining_m", 3.0}};
  int met = 0;
  for (const Bar& bar : bars) {
    const double value = summary_.at("flights").at(bar.flight).at(bar.metric).get<double>();
    const bool holds = value < bar.most;
    met += holds ? 1 : 0;
    std::printf("%-42s %6.2f m, bar %.0f m: %s\n", bar.text, value, bar.most, holds ? "good" : "MISSED");
  }
  std::printf("verdict: %d of %zu bars hold\n", met, std::size(bars));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Flies the figures of the fixed wing in simulated time.", "fixedwing_figures");
  std::string folder;
  app.add_option("-o,--output", folder, "folder for what was flown")->required();
  return runTool(app, argc, argv, [&] {
    Report report(folder);
    for (const std::string plant : {"model", "rough", "six_dof"}) {
      for (const std::string figure : {"box", "dubins"}) {
        for (const bool windy : {false, true}) report.add({figure, windy, plant});
      }
    }
    report.add({"tight", true, "model"});
    report.addAdditions();
    report.finish();
    report.printVerdict();
    return 0;
  });
}
