#include "fixedwing_plant/recorded_flight.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>

#include "fixedwing_lateral/spline_path.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_line.hpp"

namespace polyfly {
namespace {

constexpr int kPointsOfASpline = 5;

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
  return sample;
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

GuidanceOptions replayOptions(double airspeed) {
  GuidanceOptions options;
  // The guidance's roll references are not those that were flown.
  options.learns_disturbance = false;
  options.airspeed_nominal = airspeed;
  options.criterion.acceptance_radius = options.criterion.smooth_radius;
  options.limits.roll_reference = 0.8;
  options.limits.roll = 0.9;
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
