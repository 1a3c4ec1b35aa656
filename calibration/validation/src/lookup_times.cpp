#include "validation/lookup_times.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

double rank(const std::vector<double>& sorted, double share) {
  const auto position = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::min(std::max<std::size_t>(position, 1), sorted.size()) - 1];
}

}  // namespace

Percentiles percentiles(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {rank(values, 0.5), rank(values, 0.9), rank(values, 0.99), rank(values, 0.999), values.back()};
}

std::vector<double> measureLookups(const RegionMap& map, const std::vector<double>& thetas, int batch,
                                   int measurements) {
  using Clock = std::chrono::steady_clock;
  constexpr int kWarmUp = 64;  // batches that are not counted
  const std::size_t size = map.parameters().size();
  const std::size_t count = thetas.size() / size;
  if (count == 0) return {};
  measurements = std::max(measurements, static_cast<int>(count) / batch + 1);  // each parameter at least once
  std::vector<double> input(map.inputs().size());
  std::vector<double> times;
  volatile double sink = 0.0;  // keeps the answers alive
  std::size_t next = 0;
  for (int measurement = -kWarmUp; measurement < measurements; ++measurement) {
    double sum = 0.0;
    const Clock::time_point begin = Clock::now();
    for (int lookup = 0; lookup < batch; ++lookup) {
      map.evaluate(&thetas[next * size], input.data());
      sum += input[0];
      next = next + 1 == count ? 0 : next + 1;
    }
    const Clock::time_point end = Clock::now();
    sink = sink + sum;
    if (measurement >= 0)
      times.push_back(std::chrono::duration<double, std::nano>(end - begin).count() / batch);
  }
  return times;
}

}  // namespace polyfly
