#include "fixedwing_plant/recorded_flight.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <sstream>

#include "fixedwing_lateral/spline_path.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_line.hpp"

namespace polyfly {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kPointsOfASpline = 5;
// Step of the roll prediction [s].
constexpr double kStep = 0.02;
constexpr double kFitAhead = 1.0;  // [s]

std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) {
    while (!cell.empty() && std::isspace(static_cast<unsigned char>(cell.back())) != 0) cell.pop_back();
    cells.push_back(cell);
  }
  return cells;
}

/// One row by the names of its columns.
class Row {
 public:
  Row(const std::map<std::string, std::size_t>& columns, std::vector<std::string> cells, std::string where)
      : columns_(columns), cells_(std::move(cells)), where_(std::move(where)) {}

  bool has(const std::string& name) const { return columns_.count(name) != 0; }
  double at(const std::string& name) const {
    const auto column = columns_.find(name);
    if (column == columns_.end()) throw Error(where_ + ": " + name + ": no such column");
    if (column->second >= cells_.size()) throw Error(where_ + ": " + name + ": missing");
    try {
      std::size_t used = 0;
      const double value = std::stod(cells_[column->second], &used);
      if (used == cells_[column->second].size()) return value;
    } catch (const std::exception&) {
    }
    throw Error(where_ + ": " + name + ": must be a number, got '" + cells_[column->second] + "'");
  }

 private:
  const std::map<std::string, std::size_t>& columns_;
  std::vector<std::string> cells_;
  std::string where_;
};

RecordedSample sampleOf(const Row& row) {
  RecordedSample sample;
  sample.state.stamp = row.at("t_s");
  sample.state.position = {row.at("north_m"), row.at("east_m")};
  sample.state.ground_velocity = {row.at("vn_mps"), row.at("ve_mps")};
  sample.state.heading = row.at("heading_rad");
  sample.state.roll = row.at("roll_rad");
  sample.state.roll_rate = row.at("rollrate_radps");
  sample.airspeed = row.at(row.has("tas_mps") ? "tas_mps" : "ias_mps");
  sample.roll_command = row.has("roll_cmd_rad") ? row.at("roll_cmd_rad") : kNan;
  return sample;
}

/// Of the sample that held at that time.
double commandAt(const std::vector<RecordedSample>& samples, double time) {
  const auto after =
      std::upper_bound(samples.begin(), samples.end(), time,
                       [](double t, const RecordedSample& sample) { return t < sample.state.stamp; });
  return after == samples.begin() ? samples.front().roll_command : (after - 1)->roll_command;
}

/// Where a prediction begins and ends, and the commands on the way.
struct Span {
  const AircraftState& start;
  const AircraftState& end;
};

/// Calls with spans of `ahead` seconds, beginning at every fifth sample.
template <class Visit>
void visitSpans(const std::vector<RecordedSample>& samples, double ahead, Visit&& visit) {
  constexpr std::size_t kEvery = 5;
  for (std::size_t begin = 0, end = 0; begin < samples.size(); begin += kEvery) {
    while (end < samples.size() && samples[end].state.stamp < samples[begin].state.stamp + ahead) ++end;
    if (end == samples.size()) return;
    visit(Span{samples[begin].state, samples[end].state});
  }
}

/// The roll loop alone, by the midpoint rule.
double rollAfter(const RollFit& fit, const std::vector<RecordedSample>& samples, const Span& span) {
  const double duration = span.end.stamp - span.start.stamp;
  const int steps = std::max(1, static_cast<int>(std::lround(duration / kStep)));
  const double step = duration / steps;
  double roll = span.start.roll;
  double rate = span.start.roll_rate;
  for (int i = 0; i < steps; ++i) {
    const double command = commandAt(samples, span.start.stamp + (i + 0.5) * step - fit.delay);
    const double change = fit.model.b0 * command - fit.model.a1 * rate - fit.model.a0 * roll;
    const double middle_roll = roll + 0.5 * step * rate;
    const double middle_rate = rate + 0.5 * step * change;
    roll += step * middle_rate;
    rate += step * (fit.model.b0 * command - fit.model.a1 * middle_rate - fit.model.a0 * middle_roll);
  }
  return roll;
}

/// (gain, frequency [rad/s], damping, delay [s])
RollFit fitOf(const std::array<double, 4>& shape) {
  RollFit fit;
  fit.model.a0 = shape[1] * shape[1];
  fit.model.a1 = 2.0 * shape[2] * shape[1];
  fit.model.b0 = shape[0] * fit.model.a0;
  fit.delay = shape[3];
  return fit;
}

}  // namespace

std::vector<RecordedSample> readRecording(const std::string& path, double begin, double end) {
  std::ifstream file(path);
  std::string line;
  if (!readLine(file, line, path)) throw Error(path + ": cannot be read");
  std::map<std::string, std::size_t> columns;
  const std::vector<std::string> names = cellsOf(line);
  for (std::size_t i = 0; i < names.size(); ++i) columns[names[i]] = i;
  std::vector<RecordedSample> samples;
  for (int number = 2; readLine(file, line, path); ++number) {
    const Row row(columns, cellsOf(line), path + ":" + std::to_string(number));
    const RecordedSample sample = sampleOf(row);
    if (sample.state.stamp < begin || sample.state.stamp > end) continue;
    if (!samples.empty() && sample.state.stamp <= samples.back().state.stamp) continue;
    samples.push_back(sample);
  }
  return samples;
}

Mission missionAlong(const std::vector<RecordedSample>& samples, double spacing) {
  std::vector<Eigen::Vector2d> points;
  double next = -1e300;
  for (const RecordedSample& sample : samples) {
    if (sample.state.stamp < next) continue;
    points.push_back(sample.state.position);
    next = std::max(next, sample.state.stamp - 0.5 * spacing) + spacing;
  }
  std::vector<PathSegment> segments;
  std::vector<std::shared_ptr<const PathCurve>> curves;
  for (std::size_t i = 0; i + 1 < points.size(); i += kPointsOfASpline - 1) {
    const std::size_t last = std::min(i + kPointsOfASpline, points.size());
    const std::vector<Eigen::Vector2d> piece(points.begin() + static_cast<std::ptrdiff_t>(i),
                                             points.begin() + static_cast<std::ptrdiff_t>(last));
    curves.push_back(std::make_shared<SplinePath>(piece, "recording"));
    segments.emplace_back(CurveSegment{curves.back().get()});
  }
  Mission mission = makeMission(std::move(segments), {}, "recording");
  mission.curves = std::move(curves);
  return mission;
}

std::vector<FlightSample> replayOpenLoop(LateralGuidance& guidance,
                                         const std::vector<RecordedSample>& samples) {
  std::vector<FlightSample> replayed;
  double next = -1e300;
  for (const RecordedSample& recorded : samples) {
    if (recorded.state.stamp < next) continue;
    next = std::max(next, recorded.state.stamp - guidance.options().period) + guidance.options().period;
    GuidanceInput input;
    input.time = recorded.state.stamp;
    input.state = recorded.state;
    input.airspeed = {recorded.airspeed, input.time};
    FlightSample sample;
    sample.time = input.time;
    sample.truth = recorded.state;
    sample.airspeed = recorded.airspeed;
    sample.output = guidance.update(input);
    guidance.prepare();
    sample.wind = sample.output.wind;
    sample.roll_reference = sample.output.roll_reference;
    replayed.push_back(sample);
  }
  return replayed;
}

// A search along the axes: four numbers, and a function that is not smooth in the delay.
RollFit fitRoll(const std::vector<RecordedSample>& samples) {
  constexpr std::array<double, 4> kLeast = {0.3, 1.0, 0.2, 0.0};
  constexpr std::array<double, 4> kMost = {1.5, 20.0, 2.0, 0.4};
  std::array<double, 4> shape = {1.0, 4.0, 0.8, 0.1};
  std::array<double, 4> step = {0.2, 2.0, 0.3, 0.1};
  double least = predictRoll(fitOf(shape), samples, kFitAhead).rms;
  for (int round = 0; round < 25; ++round) {
    for (std::size_t i = 0; i < shape.size(); ++i) {
      bool better = false;
      for (const double side : {-1.0, 1.0}) {
        std::array<double, 4> other = shape;
        other[i] = std::clamp(other[i] + side * step[i], kLeast[i], kMost[i]);
        const double rms = predictRoll(fitOf(other), samples, kFitAhead).rms;
        if (rms >= least) continue;
        least = rms;
        shape = other;
        better = true;
        break;
      }
      if (!better) step[i] *= 0.5;
    }
  }
  return fitOf(shape);
}

RollPrediction predictRoll(const RollFit& fit, const std::vector<RecordedSample>& samples, double ahead) {
  double squares = 0.0;
  double still = 0.0;
  int count = 0;
  visitSpans(samples, ahead, [&](const Span& span) {
    squares += std::pow(rollAfter(fit, samples, span) - span.end.roll, 2);
    still += std::pow(span.start.roll - span.end.roll, 2);
    ++count;
  });
  return {std::sqrt(squares / std::max(count, 1)), std::sqrt(still / std::max(count, 1))};
}

GuidanceOptions replayOptions(double airspeed) {
  GuidanceOptions options;
  // The guidance's roll references are not those that were flown.
  options.learn_disturbance = false;
  options.airspeed_nominal = airspeed;
  options.criterion.acceptance_radius = options.criterion.smooth_radius;
  options.limits.roll_reference = 0.8;
  options.limits.roll = 0.9;
  options.iterations = 5;
  options.kkt_tolerance = 1e-4;
  return options;
}

// |v - w|^2 = V^2 with V off by a common factor s: |v|^2 - 2 v.w + |w|^2 - s V^2 = 0, linear in (w, |w|^2,
// s).
Eigen::Vector2d windBySpeeds(const std::vector<RecordedSample>& samples) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const RecordedSample& sample : samples) {
    const Eigen::Vector2d& v = sample.state.ground_velocity;
    const Eigen::Vector4d row(2.0 * v.x(), 2.0 * v.y(), -1.0, sample.airspeed * sample.airspeed);
    normal += row * row.transpose();
    right += row * v.squaredNorm();
  }
  return normal.ldlt().solve(right).head<2>();
}

}  // namespace polyfly
