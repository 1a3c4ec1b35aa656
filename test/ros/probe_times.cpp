#include "probe_times.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

namespace polyfly_ros {
namespace {

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

void writeOne(std::ostream& file, const char* name, const std::vector<double>& values) {
  file << ", \"" << name << "\": {\"median\": " << percentile(values, 0.5)
       << ", \"least\": " << percentile(values, 0.0) << ", \"p10\": " << percentile(values, 0.1)
       << ", \"p99\": " << percentile(values, 0.99) << ", \"p999\": " << percentile(values, 0.999)
       << ", \"greatest\": " << percentile(values, 1.0) << "}";
}

}  // namespace

void ProbeTimes::write(std::ostream& file) const {
  file << "{\"samples\": " << latency.size() << ", \"missed\": " << missed;
  writeOne(file, "latency", latency);
  writeOne(file, "held", held);
  writeOne(file, "inside", inside);
  writeOne(file, "input", input);
  writeOne(file, "step", step);
  writeOne(file, "publishing", publishing);
  file << "}";
}

bool Turns::loadedAt(double wall_time) const {
  return !alternate() || std::fmod(wall_time, 2.0 * length_) >= length_;
}

Turns::Turn Turns::at(double wall_time) const {
  if (!alternate()) return Turn::kCalm;
  if (std::fmod(wall_time, length_) < kSettling * length_) return Turn::kChanging;
  return loadedAt(wall_time) ? Turn::kLoaded : Turn::kCalm;
}

}  // namespace polyfly_ros
