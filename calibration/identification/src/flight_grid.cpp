#include "flight_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace polyfly {
namespace {

// Pause from which on a measurement is unknown [s].
constexpr double kStale = 1.0;
// Greatest period of the signal that sets the grid [s].
constexpr double kSlowest = 0.5;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

std::vector<double> at(const TimeSeries& series, const FlightGrid& grid, double stale) {
  if (series.time.empty()) return {};
  std::vector<double> values(grid.size, kUnknown);
  const auto after = std::upper_bound(series.time.begin(), series.time.end(), grid.from);
  std::ptrdiff_t last = after - series.time.begin() - 1;
  const auto count = static_cast<std::ptrdiff_t>(series.time.size());
  for (std::size_t i = 0; i < grid.size; ++i) {
    const double time = grid.time(i);
    while (last + 1 < count && series.time[static_cast<std::size_t>(last + 1)] <= time) ++last;
    if (last < 0) continue;
    const auto index = static_cast<std::size_t>(last);
    if (time - series.time[index] <= stale) values[i] = series.value[index];
  }
  return values;
}

// Means over the grid's steps, or greatest sizes. A step without a sample keeps the value before it.
std::vector<double> overSteps(const TimeSeries& series, const FlightGrid& grid, bool greatest) {
  std::vector<double> values = at(series, grid, kStale);
  if (values.empty()) return values;
  std::vector<double> sum(grid.size, 0.0);
  std::vector<double> count(grid.size, 0.0);
  auto sample = std::lower_bound(series.time.begin(), series.time.end(), grid.from);
  for (; sample != series.time.end(); ++sample) {
    const double place = (*sample - grid.from) / kPhaseStep;
    if (place >= static_cast<double>(grid.size)) break;
    const auto cell = static_cast<std::size_t>(place);
    const double value = series.value[static_cast<std::size_t>(sample - series.time.begin())];
    sum[cell] = greatest ? std::max(sum[cell], std::abs(value)) : sum[cell] + value;
    count[cell] += 1.0;
  }
  for (std::size_t i = 0; i < grid.size; ++i) {
    if (count[i] > 0.0) values[i] = greatest ? sum[i] : sum[i] / count[i];
  }
  return values;
}

std::vector<double> lengths(const std::vector<std::vector<double>>& parts) {
  std::vector<double> length = parts.front();
  for (std::size_t i = 0; i < length.size(); ++i) {
    double square = 0.0;
    for (const std::vector<double>& part : parts) square += part[i] * part[i];
    length[i] = std::sqrt(square);
  }
  return length;
}

void addForce(const FlightSignals& signals, FlightGrid* grid) {
  std::vector<std::vector<double>> means;
  std::vector<std::vector<double>> peaks;
  const bool all = signals.has("specific_force_x") && signals.has("specific_force_y");
  for (const char* name : {"specific_force_z", "specific_force_x", "specific_force_y"}) {
    const TimeSeries series = cleanSignal(signals, name);
    if (series.time.empty()) break;
    means.push_back(overSteps(series, *grid, false));
    peaks.push_back(overSteps(series, *grid, true));
    if (!all) break;
  }
  if (means.empty()) return;
  grid->force = lengths(means);
  grid->force_peak = lengths(peaks);
}

void addSpeed(const FlightSignals& signals, FlightGrid* grid) {
  const std::vector<const char*> space = {"vx", "vy", "vz"};
  const std::vector<const char*> ground = {"vn", "ve"};
  for (const auto& names : {space, ground}) {
    std::vector<std::vector<double>> parts;
    for (const char* name : names) parts.push_back(at(cleanSignal(signals, name), *grid, kStale));
    if (std::any_of(parts.begin(), parts.end(), [](const auto& part) { return part.empty(); })) continue;
    grid->speed = lengths(parts);
    return;
  }
}

FlightGrid gridOf(const FlightSignals& signals, const TimeWindow& window) {
  FlightGrid grid;
  grid.from = window.from;
  grid.size = static_cast<std::size_t>((window.to - window.from) / kPhaseStep) + 1;
  const auto measured = [&](const char* name) { return at(cleanSignal(signals, name), grid, kStale); };
  const auto commanded = [&](const char* name) { return at(cleanSignal(signals, name), grid, kFarStep); };
  grid.roll = measured("roll");
  grid.pitch = measured("pitch");
  grid.airspeed = measured("airspeed");
  grid.height = measured("height");
  grid.roll_cmd = commanded("roll_cmd");
  grid.pitch_cmd = commanded("pitch_cmd");
  grid.yaw_rate_cmd = commanded("yaw_rate_cmd");
  grid.thrust_cmd = commanded("thrust_cmd");
  grid.gyro_x = overSteps(cleanSignal(signals, "gyro_x"), grid, false);
  grid.gyro_y = overSteps(cleanSignal(signals, "gyro_y"), grid, false);
  grid.yaw_rate = overSteps(cleanSignal(signals, "yaw_rate"), grid, false);
  addForce(signals, &grid);
  addSpeed(signals, &grid);
  return grid;
}

}  // namespace

std::vector<FlightGrid> flightGrids(const FlightSignals& signals) {
  TimeSeries base;
  for (const char* name : {"roll", "vx", "vn"}) {
    base = cleanSignal(signals, name);
    if (base.time.size() > 1) break;
  }
  std::vector<FlightGrid> grids;
  if (base.time.size() < 2 || !(typicalPeriod(base, kFarStep) <= kSlowest)) return grids;
  for (const TimeWindow& piece : cutAtFarSteps({{base.time.front(), base.time.back()}}, base.time))
    grids.push_back(gridOf(signals, piece));
  return grids;
}

}  // namespace polyfly
