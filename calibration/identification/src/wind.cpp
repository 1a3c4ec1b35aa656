#include <algorithm>
#include <cmath>
#include <cstdio>

#include "identification/flight_phases.hpp"
#include "identification/motion.hpp"
#include "interpolate.hpp"
#include "polyfly_base/error.hpp"
#include "regression.hpp"

namespace polyfly {
namespace {

// Greatest number of Gauss-Newton steps.
constexpr int kWindRounds = 30;
// Step below which wind [m/s] and scale have converged.
constexpr double kConverged = 1e-9;
// Least turn of the course for which wind and scale can be told apart [rad].
constexpr double kLeastTurn = 3.1416;
// Least scale of an airspeed sensor that is mounted at all.
constexpr double kLeastWindScale = 0.6;
constexpr double kGreatestScale = 1.6;
constexpr double kDegreesPerRadian = 57.29577951308232;
// Least airspeed [m/s]. On the ground there is no wind triangle.
constexpr double kLeastAirspeed = 1.0;

struct Samples {
  std::vector<double> time;
  Eigen::VectorXd north;
  Eigen::VectorXd east;
  Eigen::VectorXd airspeed;
  std::vector<Eigen::Index> starts;
};

Samples collect(const FlightSignals& signals, const std::vector<TimeWindow>& wanted) {
  const TimeSeries north = cleaned(signals.at("vn"));
  const TimeSeries east = cleaned(signals.at("ve"));
  const TimeSeries airspeed = cleaned(signals.at("airspeed"));
  Samples samples;
  std::vector<double> rows[3];
  std::vector<TimeWindow> windows = wanted;
  if (windows.empty() && !north.time.empty())
    windows = windowsWithout({{north.time.front(), north.time.back()}}, signals.not_flight);
  for (const TimeSeries* series : {&north, &east, &airspeed}) windows = cutAtFarSteps(windows, series->time);
  for (std::size_t i = 0; i < north.time.size() && !east.time.empty() && !airspeed.time.empty(); ++i) {
    const double time = north.time[i];
    const bool used = std::any_of(windows.begin(), windows.end(), [time](const TimeWindow& window) {
      return window.from <= time && time <= window.to;
    });
    const double speed = interpolated(airspeed, time);
    if (!used || speed < kLeastAirspeed) continue;
    samples.time.push_back(time);
    rows[0].push_back(north.value[i]);
    rows[1].push_back(interpolated(east, time));
    rows[2].push_back(speed);
  }
  constexpr std::size_t kLeastSamples = 20;
  if (rows[0].size() < kLeastSamples)
    throw Error(signals.source + ": too few samples in flight with airspeed" +
                whyNotFlight(signals.not_flight, wanted) + whyUnusable(signals.at("vn")));
  const auto vector = [](const std::vector<double>& values) {
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  samples.north = vector(rows[0]);
  samples.east = vector(rows[1]);
  samples.airspeed = vector(rows[2]);
  samples.starts = {0, samples.north.size()};
  return samples;
}

// Range of the direction of flight through the air, the greatest gap left out.
double turnOf(const Eigen::VectorXd& north, const Eigen::VectorXd& east) {
  constexpr double kFull = 6.283185307179586;
  std::vector<double> courses;
  for (Eigen::Index i = 0; i < north.size(); ++i) courses.push_back(std::atan2(east[i], north[i]));
  std::sort(courses.begin(), courses.end());
  double gap = courses.front() + kFull - courses.back();
  for (std::size_t i = 1; i < courses.size(); ++i) gap = std::max(gap, courses[i] - courses[i - 1]);
  return kFull - gap;
}

std::vector<double> listOf(const Eigen::VectorXd& values) {
  return {values.data(), values.data() + values.size()};
}

void judge(double turn, double scale, std::vector<std::string>* warnings) {
  char text[200];
  if (turn < kLeastTurn) {
    std::snprintf(text, sizeof text,
                  "The flight turned by %.0f degrees only: wind and scale of the airspeed cannot be told "
                  "apart. Fly circles.",
                  turn * kDegreesPerRadian);
    warnings->emplace_back(text);
  }
  if (scale < kLeastWindScale || scale > kGreatestScale) {
    std::snprintf(text, sizeof text,
                  "The airspeed's scale of %.2g is none of a sensor in flight: the vehicle stood, or the "
                  "airspeed is in another unit.",
                  scale);
    warnings->emplace_back(text);
  }
}

}  // namespace

WindFit fitWind(const FlightSignals& signals, const std::vector<TimeWindow>& windows) {
  const Samples samples = collect(signals, windows);
  Eigen::Vector3d at(0.0, 0.0, 1.0);  // wind to north and east, scale
  Regression step;
  for (int round = 0; round < kWindRounds; ++round) {
    const Eigen::VectorXd north = samples.north.array() - at[0];
    const Eigen::VectorXd east = samples.east.array() - at[1];
    const Eigen::VectorXd through = (north.array().square() + east.array().square()).sqrt().max(kConverged);
    Eigen::MatrixXd columns(north.size(), 3);
    columns.col(0) = north.cwiseQuotient(through);
    columns.col(1) = east.cwiseQuotient(through);
    columns.col(2) = samples.airspeed;
    step = regress(columns, through - at[2] * samples.airspeed, samples.starts);
    at += step.coefficients;
    if (step.coefficients.cwiseAbs().maxCoeff() < kConverged) break;
  }
  const Eigen::VectorXd north = samples.north.array() - at[0];
  const Eigen::VectorXd east = samples.east.array() - at[1];
  WindFit result;
  judge(turnOf(north, east), at[2], &result.warnings);
  result.parameters = {{"wind_north", "m/s", at[0], step.standard_errors[0], step.half_widths[0]},
                       {"wind_east", "m/s", at[1], step.standard_errors[1], step.half_widths[1]},
                       {"airspeed_scale", "1", at[2], step.standard_errors[2], step.half_widths[2]}};
  result.north = listOf(samples.north);
  result.east = listOf(samples.east);
  const std::vector<std::size_t> starts = {0, samples.time.size()};
  result.traces = {{"speed through the air", "m/s", "airspeed [m/s]", samples.time, starts,
                    listOf((north.array().square() + east.array().square()).sqrt()),
                    listOf(at[2] * samples.airspeed), listOf(samples.airspeed)}};
  return result;
}

}  // namespace polyfly
