#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "bench_commands.hpp"
#include "clocks.hpp"

namespace polyfly::bench {
namespace {

constexpr std::size_t kSize = 16;
// Solutions for each reading of the clock.
constexpr int kSolutions = 400;
constexpr int kReadings = 101;

using Row = std::array<double, kSize + 1>;
using System = std::array<Row, kSize>;

// Gauss-Jordan elimination with row pivoting; returns the sum of the solution.
double solve(System system) {
  for (std::size_t k = 0; k < kSize; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < kSize; ++i) {
      if (std::abs(system[i][k]) > std::abs(system[pivot][k])) pivot = i;
    }
    std::swap(system[k], system[pivot]);
    for (std::size_t i = 0; i < kSize; ++i) {
      if (i == k) continue;
      const double factor = system[i][k] / system[k][k];
      for (std::size_t j = k; j <= kSize; ++j) system[i][j] -= factor * system[k][j];
    }
  }
  double sum = 0.0;
  for (std::size_t k = 0; k < kSize; ++k) sum += system[k][kSize] / system[k][k];
  return sum;
}

System randomSystem() {
  std::mt19937_64 random(1);
  System system = {};
  for (Row& row : system) {
    for (double& value : row) value = 2.0 * (static_cast<double>(random() >> 11) * 0x1p-53) - 1.0;
  }
  return system;
}

}  // namespace

// A piece of arithmetic of the size that parametric solvers do all day, for comparing machines.
Json calibrate() {
  System system = randomSystem();
  std::vector<double> seconds;
  double sum = 0.0;
  for (int reading = 0; reading < kReadings; ++reading) {
    const double start = cpuSeconds();
    for (int i = 0; i < kSolutions; ++i) {
      sum += solve(system);
      // The next solution waits for this one.
      system[0][kSize] = std::sin(sum);
    }
    seconds.push_back((cpuSeconds() - start) / kSolutions);
  }
  std::sort(seconds.begin(), seconds.end());
  Json result;
  result["cpu_seconds"] = seconds[seconds.size() / 2];
  result["cpu_least"] = seconds.front();
  result["cpu_greatest"] = seconds.back();
  return result;
}

}  // namespace polyfly::bench
