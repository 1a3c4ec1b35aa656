#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "../test/map_in_memory.hpp"
#include "bench_commands.hpp"
#include "clocks.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"

namespace polyfly::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Nanoseconds = std::chrono::duration<double, std::nano>;

constexpr std::size_t kBatch = 8;  // look-ups per reading of the clock: enough to hide its cost
constexpr std::size_t kColdLookups = 2000;
constexpr std::size_t kCacheBytes = std::size_t{64} << 20;  // more than the last cache holds
constexpr std::size_t kLine = 64;

double uniform(std::mt19937_64& random, double lower, double upper) {
  return lower + (upper - lower) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

// Random parameters of the box, p numbers each.
std::vector<double> drawBox(const RegionMap& map, std::size_t samples, std::mt19937_64& random) {
  std::vector<double> thetas;
  thetas.reserve(samples * map.parameters().size());
  for (std::size_t i = 0; i < samples; ++i) {
    for (const Signal& signal : map.parameters())
      thetas.push_back(uniform(random, signal.lower, signal.upper));
  }
  return thetas;
}

// Each from a random region, on a random ray from its centre, anywhere before the region's edge: every region
// is as likely as any other, so that nothing stays in the caches for being asked often.
std::vector<double> drawRegions(const ParametricProgram& program, const Partition& partition,
                                std::size_t samples, std::mt19937_64& random) {
  const Eigen::Index p = program.parameterCount();
  std::vector<double> thetas;
  thetas.reserve(samples * static_cast<std::size_t>(p));
  for (std::size_t i = 0; i < samples; ++i) {
    const CriticalRegion& region = partition.regions[random() % partition.regions.size()];
    Eigen::VectorXd ray(p);
    for (Eigen::Index j = 0; j < p; ++j) {
      const Signal& signal = program.parameters[static_cast<std::size_t>(j)];
      ray(j) = uniform(random, -1.0, 1.0) * (signal.upper - signal.lower);
    }
    double reach = 1.0;
    const Eigen::VectorXd slack = region.g - region.G * region.centre;
    const Eigen::VectorXd speed = region.G * ray;
    for (Eigen::Index j = 0; j < speed.size(); ++j) {
      if (speed(j) > 0.0) reach = std::min(reach, slack(j) / speed(j));
    }
    const Eigen::VectorXd theta = region.centre + uniform(random, 0.0, 0.999) * std::max(0.0, reach) * ray;
    thetas.insert(thetas.end(), theta.data(), theta.data() + p);
  }
  return thetas;
}

struct Times {
  double median = 0.0;
  double high = 0.0;    // 99 %
  double inside = 0.0;  // share of the parameters that a region holds
};

Times summary(std::vector<double>& times, std::size_t inside, std::size_t count) {
  std::sort(times.begin(), times.end());
  const auto at = [&](double share) {
    return times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
  };
  return {at(0.5), at(0.99), static_cast<double>(inside) / static_cast<double>(count)};
}

// Each look-up waits for the answer of the one before, as in a controller: without that, the processor would
// work on several at once.
Times timeInTurn(const RegionMap& map, const std::vector<double>& thetas) {
  const std::size_t p = map.parameters().size();
  const std::size_t count = thetas.size() / p;
  std::vector<double> input(map.inputs().size());
  std::vector<double> times;
  times.reserve(count / kBatch);
  volatile std::size_t zero = 0;
  const std::size_t mask = zero;
  std::size_t answer = 0;
  std::size_t inside = 0;
  for (std::size_t first = 0; first + kBatch <= count; first += kBatch) {
    const Clock::time_point start = Clock::now();
    for (std::size_t i = first; i < first + kBatch; ++i) {
      const Lookup lookup = map.evaluate(thetas.data() + i * p + (answer & mask), input.data());
      const bool found = lookup.status == LookupStatus::kInside;
      inside += found;
      answer = lookup.region + static_cast<std::size_t>(found && input[0] > 0.0);
    }
    times.push_back(Nanoseconds(Clock::now() - start).count() / static_cast<double>(kBatch));
  }
  return summary(times, inside, count / kBatch * kBatch);
}

double clockCost() {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 1000; ++i) {
    const Clock::time_point start = Clock::now();
    least = std::min(least, Nanoseconds(Clock::now() - start).count());
  }
  return least;
}

// One look-up at a time, nothing of the map left in any cache.
Times timeCold(const RegionMap& map, const std::vector<double>& thetas) {
  const std::size_t p = map.parameters().size();
  const std::size_t count = std::min(kColdLookups, thetas.size() / p);
  std::vector<unsigned char> filler(kCacheBytes, 1);
  std::vector<double> input(map.inputs().size());
  std::vector<double> theta(p);
  std::vector<double> times;
  const double cost = clockCost();
  volatile unsigned sink = 0;
  std::size_t inside = 0;
  for (std::size_t i = 0; i < count; ++i) {
    unsigned sum = 0;
    for (std::size_t j = 0; j < filler.size(); j += kLine) sum += ++filler[j];
    sink = sink + sum;
    std::copy_n(thetas.data() + i * p, p, theta.data());
    const Clock::time_point start = Clock::now();
    const Lookup lookup = map.evaluate(theta.data(), input.data());
    const double spent = Nanoseconds(Clock::now() - start).count();
    inside += lookup.status == LookupStatus::kInside;
    times.push_back(std::max(0.0, spent - cost));
  }
  return summary(times, inside, count);
}

void addTimes(Json& result, const std::string& key, const Times& times) {
  result[key + "_median_ns"] = times.median;
  result[key + "_99_ns"] = times.high;
  result[key + "_inside"] = times.inside;
}

}  // namespace

Json sizesOf(const ParametricProgram& program, const Partition& partition, const RegionMap& map) {
  Json result;
  result["problem"] = program.name;
  result["status"] = toString(partition.status);
  result["parameters"] = program.parameterCount();
  result["regions"] = map.regionCount();
  result["laws"] = map.lawCount();
  result["nodes"] = map.nodeCount();
  result["depth"] = map.cost().depth;
  result["multiply_adds"] = map.cost().multiply_adds;
  return result;
}

Json timeLookups(const LookupArguments& arguments) {
  const ParametricProgram program = loadProgram(arguments.problem);
  const Partition partition = explore(program);
  const double start = cpuSeconds();
  const MapInMemory memory(encode(program, partition));
  const double tree_seconds = cpuSeconds() - start;
  const RegionMap& map = memory.map();
  std::mt19937_64 random(arguments.seed);
  const std::vector<double> box = drawBox(map, arguments.samples, random);
  const std::vector<double> regions = drawRegions(program, partition, arguments.samples, random);
  Json result = sizesOf(program, partition, map);
  result["leaves"] = map.leafCount();
  result["region_checks"] = map.cost().region_checks;
  result["map_bytes"] = map.bytes();
  result["tree_cpu_seconds"] = tree_seconds;
  addTimes(result, "box", timeInTurn(map, box));
  addTimes(result, "regions", timeInTurn(map, regions));
  addTimes(result, "cold", timeCold(map, regions));
  return result;
}

}  // namespace polyfly::bench
