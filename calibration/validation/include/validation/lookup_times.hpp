#pragma once

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

/// Times of one look-up with its law [ns], with the parameters in the order of the flight. Each value is the mean over
/// `batch` different parameters, so that the clock's own resolution does not matter.
///
/// `thetas`: parameter vectors, one after the other, each with the map's number of parameters. Goes over them
/// until at least `measurements` batches are timed, and each parameter was used. Empty for no parameters.
std::vector<double> measureLookups(const RegionMap& map, const std::vector<double>& thetas, int batch = 16,
                                   int measurements = 4000);

}  // namespace polyfly
