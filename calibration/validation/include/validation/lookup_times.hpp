#pragma once

#include <cstdint>
#include <vector>

namespace polyfly {

class RegionMap;

struct Percentiles {
  double p50 = 0.0;
  double p90 = 0.0;
  double p99 = 0.0;
  double p999 = 0.0;
  double max = 0.0;
};

/// Nearest-rank percentiles; all 0 for no values.
Percentiles percentiles(std::vector<double> values);

/// Time of one look-up with its law, measured over batches of `batch` different parameters. So the clock's own
/// resolution does not matter. Each value is a batch's mean.
struct LookupTimes {
  /// Look-up times with the parameters in the order of the flight [ns].
  std::vector<double> in_order;
  /// Look-up times with the parameters in seeded random order [ns]. Caches and branch prediction help less.
  std::vector<double> shuffled;
};

/// `thetas`: parameter vectors, one after the other, each with the map's number of parameters. Goes over them
/// until at least `measurements` batches are timed each way, and each parameter was used. Empty result for no
/// parameters.
LookupTimes measureLookups(const RegionMap& map, const std::vector<double>& thetas, int batch = 16,
                           int measurements = 4000);

}  // namespace polyfly
