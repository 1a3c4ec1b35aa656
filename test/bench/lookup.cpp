// Times RegionMap::evaluate at seeded random parameters of a map's box; prints rows as JSON.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>
#include <string>
#include <vector>

#include "region_maps/region_map.hpp"

namespace {

using Clock = std::chrono::steady_clock;

// Look-ups per reading of the clock: enough to hide its cost, few enough to keep the tail visible.
constexpr std::size_t kBatch = 8;

struct Arguments {
  std::uint64_t seed = 1;
  std::size_t samples = 100000;
  std::vector<std::string> maps;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--seed" && i + 1 < argc) {
      arguments.seed = std::strtoull(argv[++i], nullptr, 10);
    } else if (word == "--samples" && i + 1 < argc) {
      arguments.samples = std::strtoull(argv[++i], nullptr, 10);
    } else {
      arguments.maps.push_back(word);
    }
  }
  return arguments;
}

std::vector<double> drawParameters(const polyfly::RegionMap& map, std::size_t samples, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<double> thetas;
  thetas.reserve(samples * map.parameters().size());
  for (std::size_t i = 0; i < samples; ++i) {
    for (const polyfly::Signal& signal : map.parameters()) {
      thetas.push_back(std::uniform_real_distribution<double>(signal.lower, signal.upper)(random));
    }
  }
  return thetas;
}

// Parameters that move on by a thousandth of the range from one look-up to the next, as in flight.
std::vector<double> walkParameters(const polyfly::RegionMap& map, std::size_t samples, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<double> thetas;
  thetas.reserve(samples * map.parameters().size());
  for (std::size_t i = 0; i < samples; ++i) {
    for (const polyfly::Signal& signal : map.parameters()) {
      const double half = 0.5 * (signal.upper - signal.lower);
      const double before =
          i == 0 ? 0.5 * (signal.lower + signal.upper) : thetas[thetas.size() - map.parameters().size()];
      thetas.push_back(std::clamp(before + 1e-3 * half * unit(random), signal.lower, signal.upper));
    }
  }
  return thetas;
}

// Nanoseconds of one look-up, one number for each batch, sorted.
std::vector<double> timeLookups(const polyfly::RegionMap& map, const std::vector<double>& thetas) {
  const std::size_t size = map.parameters().size();
  const std::size_t batches = thetas.size() / size / kBatch;
  std::vector<double> input(map.inputs().size());
  std::vector<double> times;
  times.reserve(batches);
  volatile double sink = 0.0;  // keeps the look-ups from being left out
  const double* theta = thetas.data();
  for (std::size_t batch = 0; batch < batches; ++batch) {
    double sum = 0.0;
    const Clock::time_point start = Clock::now();
    for (std::size_t i = 0; i < kBatch; ++i, theta += size) {
      map.evaluate(theta, input.data());
      sum += input[0];
    }
    const std::chrono::duration<double, std::nano> spent = Clock::now() - start;
    sink = sink + sum;
    times.push_back(spent.count() / static_cast<double>(kBatch));
  }
  std::sort(times.begin(), times.end());
  return times;
}

double percentile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

void printRow(bool first, const std::string& name, double value, const char* unit) {
  std::printf("%s{\"name\": \"%s\", \"value\": %.6g, \"unit\": \"%s\"}", first ? "[" : ",\n ", name.c_str(),
              value, unit);
}

void measure(const std::string& path, const Arguments& arguments, bool first) {
  const polyfly::RegionMap map = polyfly::RegionMap::open(path);
  const std::vector<double> thetas = drawParameters(map, arguments.samples, arguments.seed);
  timeLookups(map, thetas);  // once to warm the caches
  const std::vector<double> times = timeLookups(map, thetas);
  const std::vector<double> walk = walkParameters(map, arguments.samples, arguments.seed);
  const std::vector<double> walked = timeLookups(map, walk);
  const std::string name(map.name());
  printRow(first, name + ": regions", static_cast<double>(map.regionCount()), "");
  printRow(false, name + ": file", static_cast<double>(map.bytes()), "B");
  printRow(false, name + ": tree depth", map.cost().depth, "");
  printRow(false, name + ": look-up, random parameters, median", percentile(times, 0.5), "ns");
  printRow(false, name + ": look-up, random parameters, 99 %", percentile(times, 0.99), "ns");
  printRow(false, name + ": look-up, consecutive parameters, median", percentile(walked, 0.5), "ns");
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  if (arguments.maps.empty() || arguments.samples < kBatch) {
    std::fprintf(stderr, "usage: bench_lookup [--seed S] [--samples N] MAP...   (N at least %zu)\n", kBatch);
    return 2;
  }
  try {
    for (std::size_t i = 0; i < arguments.maps.size(); ++i) {
      measure(arguments.maps[i], arguments, i == 0);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_lookup: %s\n", error.what());
    return 1;
  }
  std::printf("]\n");
  return 0;
}
