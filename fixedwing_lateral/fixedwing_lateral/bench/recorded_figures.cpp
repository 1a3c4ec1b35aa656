#include "recorded_figures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "fixedwing_plant/recorded_flight.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_line.hpp"

namespace polyfly {
namespace {

constexpr double kDegree = 180.0 / kPi;
// Time between the path's points [s].
constexpr double kSpacing = 2.0;
// Prediction time of the roll [s].
constexpr double kAhead = 1.0;

double meanAirspeed(const std::vector<RecordedSample>& samples) {
  double sum = 0.0;
  for (const RecordedSample& sample : samples) sum += sample.airspeed;
  return sum / static_cast<double>(samples.size());
}

nlohmann::json metricsOf(const std::vector<FlightSample>& replayed) {
  std::vector<double> kkt;
  double squares = 0.0;
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();
  int tracking = 0;
  for (const FlightSample& sample : replayed) {
    tracking += sample.output.mode == GuidanceMode::kTracking ? 1 : 0;
    kkt.push_back(sample.output.nmpc.kkt);
    squares += std::pow(sample.roll_reference - sample.truth.roll, 2);
    wind += sample.wind;
  }
  std::sort(kkt.begin(), kkt.end());
  const auto count = static_cast<double>(replayed.size());
  return {{"samples", replayed.size()},
          {"tracking", tracking},
          {"kkt_median", kkt[kkt.size() / 2]},
          {"kkt_99", kkt[kkt.size() * 99 / 100]},
          {"roll_difference_rms_deg", kDegree * std::sqrt(squares / count)},
          {"wind_north_mps", wind.x() / count},
          {"wind_east_mps", wind.y() / count}};
}

}  // namespace

RecordedLog parseLog(const std::string& text) {
  RecordedLog log;
  std::istringstream stream(text);
  char comma = 0;
  if (std::getline(stream, log.path, ',') && stream >> log.begin >> comma >> log.end && log.begin < log.end)
    return log;
  throw Error("--log: must be FILE,BEGIN,END, got '" + text + "'");
}

ReplayedLog replayLog(const RecordedLog& log) {
  const std::vector<RecordedSample> samples = readRecording(log.path, log.begin, log.end);
  if (samples.empty()) throw Error(log.path + ": has no samples between begin and end");
  LateralGuidance guidance(replayOptions(meanAirspeed(samples)), "replay");
  guidance.setMission(missionAlong(samples, kSpacing));
  const std::vector<FlightSample> replayed = replayOpenLoop(guidance, samples);
  std::ostringstream file;
  file << "t,north,east,roll_deg,asked_deg,wind_north,wind_east\n";
  for (const FlightSample& sample : replayed)
    file << sample.time << ',' << sample.truth.position.x() << ',' << sample.truth.position.y() << ','
         << kDegree * sample.truth.roll << ',' << kDegree * sample.roll_reference << ',' << sample.wind.x()
         << ',' << sample.wind.y() << '\n';
  nlohmann::json result = metricsOf(replayed);
  const Eigen::Vector2d wind = windBySpeeds(samples);
  result["wind_by_speeds_north_mps"] = wind.x();
  result["wind_by_speeds_east_mps"] = wind.y();
  if (std::isfinite(samples.front().roll_command)) {
    const auto half = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
    const RollFit fit = fitRoll({samples.begin(), half});
    const RollPrediction prediction = predictRoll(fit, {half, samples.end()}, kAhead);
    result["roll_predicted_1s_rms_deg"] = kDegree * prediction.rms;
    result["roll_standing_still_1s_rms_deg"] = kDegree * prediction.rms_still;
  }
  return {file.str(), result};
}

Rows readCsv(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw Error(path + ": cannot be read");
  Rows rows;
  std::string line;
  readLine(file, line, path);
  while (readLine(file, line, path)) {
    std::vector<double> row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      char* end = nullptr;
      row.push_back(std::strtod(cell.c_str(), &end));
      if (end == cell.c_str() || !std::isfinite(row.back()))
        throw Error(path + ": '" + cell + "' is not a number");
    }
    if (row.size() < 3) throw Error(path + ": a row of fewer than three columns");
    rows.push_back(row);
  }
  if (rows.size() < 2) throw Error(path + ": no samples");
  return rows;
}

Spread spreadOf(const Rows& rows, double radius) {
  Spread spread;
  int count = 0;
  for (const std::vector<double>& row : rows) {
    if (row[0] < kLoiterSettled) continue;
    const double off = std::abs(std::hypot(row[1], row[2]) - radius);
    spread.rms += off * off;
    spread.largest = std::max(spread.largest, off);
    ++count;
  }
  spread.rms = std::sqrt(spread.rms / std::max(count, 1));
  return spread;
}

}  // namespace polyfly
