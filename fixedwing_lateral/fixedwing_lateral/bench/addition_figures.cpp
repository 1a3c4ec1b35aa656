#include "addition_figures.hpp"

#include <cstdio>
#include <memory>
#include <vector>

#include "fixedwing_lateral/lateral_parameters.hpp"
#include "fixedwing_plant/figures.hpp"
#include "fixedwing_plant/flight_metrics.hpp"
#include "fixedwing_plant/six_dof_aircraft.hpp"

namespace polyfly {
namespace {

using Eigen::Vector2d;

constexpr double kAirspeed = 14.0;
constexpr double kWindShare = 0.5;
constexpr double kDuration = 240.0;  // at kAirspeed [s]
constexpr double kSettle = 0.5;
constexpr double kWindow = 7.0;  // [s]

struct Row {
  std::string name;
  LateralParameters parameters;
  // Whether turns are planned by a roll rate.
  bool bounds_deviation = false;
};

/// From the published options to those of a calibrated aircraft, one addition after the other.
std::vector<Row> configurations(double airspeed, const LateralModel& model) {
  std::vector<Row> rows;
  LateralParameters parameters;
  parameters.guidance = publishedGuidance();
  parameters.tight_turns = "widen";
  bool bounds_deviation = false;
  const auto add = [&](const std::string& name) { rows.push_back({name, parameters, bounds_deviation}); };
  GuidanceOptions& options = parameters.guidance;
  const GuidanceOptions shipped;
  add("published");
  options.weights.feedforward = shipped.weights.feedforward;
  add("+ feedforward of the path's roll");
  options.weights.curvature = shipped.weights.curvature;
  add("+ curvature of the motion in the Hessian");
  options.criterion.smooth_radius = shipped.criterion.smooth_radius;
  add("+ smooth junctions at 10 m");
  options.corrects_wind = true;
  add("+ wind corrected by the ground velocity");
  options.learns_disturbance = true;
  add("+ learnt roll bias, turn gain, turn bias");
  options.chooses_side = true;
  options.limits.roll = shipped.limits.roll;
  add("+ turning side, roll bound");
  options.weights.airspeed = shipped.weights.airspeed;
  options.airspeed_nominal = airspeed;
  options.falls_back = true;
  add("+ weights by airspeed, L1 as a fallback");
  bounds_deviation = true;
  add("+ turns by a presumed roll rate");
  options.model = model;
  add("+ this aircraft's roll loop and rate, turns by them");
  options.weights.track = defaultWeights().track;
  add("+ `weights/track` 0.03");
  options.criterion = shipped.criterion;
  add("+ corners at their bisector, as shipped");
  return rows;
}

struct Plant {
  std::string name;
  double airspeed = kAirspeed;
  LateralModel model;
};

std::unique_ptr<Aircraft> aircraftOf(const Plant& plant, const Vector2d& wind) {
  AircraftState start;
  start.ground_velocity = {plant.airspeed, 0.0};
  if (plant.name == "six_dof") {
    SixDofOptions options;
    options.wind = wind;
    return std::make_unique<SixDofAircraft>(options, start, 1);
  }
  if (plant.name == "slow_roll") {
    RoughOptions options = slowRolling();
    options.wind = wind;
    return std::make_unique<PerturbedAircraft>(options, start, 1);
  }
  return std::make_unique<ChapterAircraft>(plant.model, start, plant.airspeed, wind);
}

FlightMetrics fly(const Plant& plant, const Row& row, bool box, bool windy) {
  const double size = plant.airspeed * plant.airspeed / (kAirspeed * kAirspeed);
  const double slowness = plant.airspeed / kAirspeed;
  const double wind = windy ? kWindShare * plant.airspeed : 0.0;
  LateralParameters parameters = row.parameters;
  parameters.wind_expected = wind;
  GuidanceOutput learnt;
  TurnPlan plan = turnPlanOf(parameters, learnt);
  // The figure belongs to the true airspeed, whatever the options have.
  plan.conditions.airspeed = plant.airspeed;
  if (!row.bounds_deviation) plan.conditions.deviation = 0.0;
  const Mission mission = box ? boxFigure(size) : dubinsFigure(plan, size);
  GuidanceOptions options = parameters.guidance;
  // At a bisector it grows with the speed by itself.
  if (box && !options.criterion.at_bisector) options.criterion.acceptance_radius *= size;
  const std::unique_ptr<Aircraft> aircraft = aircraftOf(plant, wind * Vector2d(0.6, -0.8));
  LateralGuidance guidance(options, "additions");
  guidance.setMission(mission);
  Sensors sensors({}, 1);
  const auto samples = flyLaw(*aircraft, sensors, lawOf(guidance), options.period, kDuration * slowness);
  return flightMetrics(mission.segments, samples, kSettle, kWindow * slowness);
}

std::string cell(double value, bool is_there) {
  if (!is_there) return "<td>never</td>";
  char text[40];
  std::snprintf(text, sizeof text, "<td>%.2f</td>", value);
  return text;
}

Plant slowRoll() {
  const RoughOptions options = slowRolling();
  LateralModel model;
  model.a0 = model.b0 = options.roll_frequency * options.roll_frequency;
  model.a1 = model.a0 * (2.0 * options.roll_damping / options.roll_frequency + options.roll_delay);
  model.roll_rate_max = options.roll_rate_max;
  return {"slow_roll", options.airspeed, model};
}

}  // namespace

AdditionTable flyAdditions() {
  const std::vector<Plant> plants = {{"model", kAirspeed, {}}, {"six_dof", kAirspeed, {}}, slowRoll()};
  AdditionTable table;
  table.html =
      "<table><tr><th>configuration</th><th>aircraft</th><th>box, calm: lines, loiter [m]</th><th></th>"
      "<th>box, wind: lines, loiter [m]</th><th></th><th>Dubins, wind: once joined, loiter "
      "[m]</th><th></th></tr>\n";
  for (const Plant& plant : plants) {
    for (const Row& row : configurations(plant.airspeed, plant.model)) {
      const FlightMetrics calm = fly(plant, row, true, false);
      const FlightMetrics windy = fly(plant, row, true, true);
      const FlightMetrics dubins = fly(plant, row, false, true);
      nlohmann::json entry = {{"configuration", row.name},
                              {"aircraft", plant.name},
                              {"box_calm_lines_m", calm.converged},
                              {"box_calm_loiter_m", calm.loiter},
                              {"box_wind_lines_m", windy.converged},
                              {"box_wind_loiter_m", windy.loiter},
                              {"dubins_wind_loiter_m", dubins.loiter}};
      if (dubins.has_joined) entry["dubins_wind_joined_m"] = dubins.after_joining;
      table.rows.push_back(entry);
      table.html += "<tr><td>" + row.name + "</td><td>" + plant.name + "</td>" + cell(calm.converged, true) +
                    cell(calm.loiter, true) + cell(windy.converged, true) + cell(windy.loiter, true) +
                    cell(dubins.after_joining, dubins.has_joined) + cell(dubins.loiter, true) + "</tr>\n";
    }
  }
  table.html += "</table>\n";
  return table;
}

}  // namespace polyfly
