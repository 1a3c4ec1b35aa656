// Timing of work of a few microseconds, and rows of test/bench/README.md.
#pragma once

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

namespace polyfly_bench {

/// Microseconds of one call: wall clock and CPU time of the thread, one entry for each batch.
struct Times {
  std::vector<double> wall;
  std::vector<double> cpu;

  void add(const Times& other) {
    wall.insert(wall.end(), other.wall.begin(), other.wall.end());
    cpu.insert(cpu.end(), other.cpu.begin(), other.cpu.end());
  }
};

inline double threadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Calls `work` in batches: reading the thread's clock takes as long as a small problem.
template <class Work>
Times timeBatches(int batches, int calls, const Work& work) {
  Times times;
  for (int batch = 0; batch < batches; ++batch) {
    const auto start = std::chrono::steady_clock::now();
    const double cpu_start = threadSeconds();
    for (int call = 0; call < calls; ++call) work();
    const double cpu = threadSeconds() - cpu_start;
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    times.wall.push_back(1e6 * wall.count() / calls);
    times.cpu.push_back(1e6 * cpu / calls);
  }
  return times;
}

inline double percentile(std::vector<double> values, double share) {
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

struct Row {
  std::string name;
  double value = 0.0;
  std::string unit;
  /// Target: at most this value. 0: no target.
  double most = 0.0;
  std::string peer;
  double peer_value = 0.0;
};

/// Prints a list; to be closed by a bracket.
inline void printRow(const Row& row) {
  static bool first = true;
  std::printf("%s{\"name\": \"%s\", \"value\": %.4g, \"unit\": \"%s\"", first ? "[" : ",\n ",
              row.name.c_str(), row.value, row.unit.c_str());
  if (!row.peer.empty()) {
    std::printf(", \"peer\": \"%s\", \"peer_value\": %.4g", row.peer.c_str(), row.peer_value);
  }
  if (row.most > 0.0) {
    std::printf(", \"mark\": \"at most %.4g\", \"reached\": %s", row.most,
                row.value <= row.most ? "true" : "false");
  }
  std::printf("}");
  first = false;
}

/// Rows of one kind of work: median of the wall clock, 99 % of the CPU time and its ratio to the median.
inline void printTimes(const Times& times, const Row& median) {
  Row row = median;
  row.name = median.name + ", median";
  row.value = percentile(times.wall, 0.5);
  row.unit = "us";
  printRow(row);
  const double p99 = percentile(times.cpu, 0.99);
  printRow({median.name + ", 99 % in CPU time", p99, "us", 0.0, "", 0.0});
  printRow(
      {median.name + ", 99 % over median in CPU time", p99 / percentile(times.cpu, 0.5), "", 3.0, "", 0.0});
}

}  // namespace polyfly_bench
