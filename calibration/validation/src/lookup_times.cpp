#include "validation/lookup_times.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <random>

#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

constexpr unsigned kShuffleSeed = 20171;
// Greatest number of inputs of a map, see FORMAT.md.
constexpr std::size_t kMaxInputs = 256;

double rank(const std::vector<double>& sorted, double share) {
  const auto position = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::min(std::max<std::size_t>(position, 1), sorted.size()) - 1];
}

// Parameters are laid out in the order of use, so that fetching them costs the same in both orders.
std::vector<double> arranged(const std::vector<double>& thetas, const std::vector<std::size_t>& order,
                             std::size_t size) {
  std::vector<double> result;
  result.reserve(thetas.size());
  for (const std::size_t index : order) {
    const auto begin = thetas.begin() + static_cast<std::ptrdiff_t>(index * size);
    result.insert(result.end(), begin, begin + static_cast<std::ptrdiff_t>(size));
  }
  return result;
}

std::vector<double> timeBatches(const RegionMap& map, const std::vector<double>& thetas, int batch,
                                int measurements) {
  using Clock = std::chrono::steady_clock;
  const std::size_t size = map.parameters().size();
  const std::size_t count = thetas.size() / size;
  std::vector<double> input(kMaxInputs, 0.0);
  std::vector<double> times;
  times.reserve(static_cast<std::size_t>(measurements));
  volatile double sink = 0.0;  // keeps the answers alive
  std::size_t next = 0;
  constexpr int kWarmUp = 64;  // batches that are not counted
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
    if (measurement >= 0) {
      times.push_back(std::chrono::duration<double, std::nano>(end - begin).count() / batch);
    }
  }
  return times;
}

}  // namespace

Percentiles percentiles(std::vector<double> values) {
  Percentiles result;
  if (values.empty()) {
    return result;
  }
  std::sort(values.begin(), values.end());
  result.p50 = rank(values, 0.5);
  result.p90 = rank(values, 0.9);
  result.p99 = rank(values, 0.99);
  result.p999 = rank(values, 0.999);
  result.max = values.back();
  return result;
}

LookupTimes measureLookups(const RegionMap& map, const std::vector<double>& thetas, int batch,
                           int measurements) {
  LookupTimes times;
  if (batch < 1 || measurements < 1) {
    return times;
  }
  const std::size_t size = map.parameters().size();
  const std::size_t count = thetas.size() / size;
  if (count == 0) {
    return times;
  }
  measurements = std::max(measurements, static_cast<int>(count) / batch + 1);  // each parameter at least once
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(kShuffleSeed));
  times.in_order = timeBatches(map, thetas, batch, measurements);
  times.shuffled = timeBatches(map, arranged(thetas, order, size), batch, measurements);
  return times;
}

}  // namespace polyfly
