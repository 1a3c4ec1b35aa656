#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "region_maps/lookup.hpp"

namespace polyfly {

class RegionMap;

/// How far a map's parameter went, and how near the map's end along it.
struct ParameterUse {
  std::string name;
  std::string unit;
  /// Lower end of the map's range [unit].
  double lower = 0.0;
  /// Upper end of the map's range [unit].
  double upper = 0.0;
  /// Least value met in flight [unit].
  double least = std::numeric_limits<double>::infinity();
  /// Greatest value met in flight [unit].
  double greatest = -std::numeric_limits<double>::infinity();
  /// Samples beyond the range.
  std::size_t outside = 0;
  /// Least way that this parameter alone could still have gone, down or up, before the map ended: its range or its
  /// last region. Of samples inside; infinite if there are none, and where nothing leads beyond. That is so for the
  /// previous input where its range holds all that the input may be. It is so too for the disturbance ahead, which is
  /// clipped [unit].
  double room = std::numeric_limits<double>::infinity();

  /// Distance from what was met to the nearer end of the range; negative beyond it [unit].
  double margin() const { return std::min(least - lower, upper - greatest); }
  /// The range that would have held the flight: as it is, or, where an end was passed, a tenth of what was
  /// met beyond.
  std::pair<double, double> proposedRange() const;
};

/// A distance over the samples, in parameters whose ranges are mapped to [-1, 1].
struct DistanceUse {
  double least = std::numeric_limits<double>::infinity();
  double sum = 0.0;
  /// Time of the least distance [s].
  double stamp = 0.0;
};

/// How a flight, or several, used one map.
struct MapUse {
  /// Samples with a reference.
  std::size_t samples = 0;
  std::size_t inside = 0;
  /// Samples with a parameter out of its range.
  std::size_t outside_box = 0;
  /// Samples in range but in no region.
  std::size_t outside_partition = 0;
  std::size_t not_finite = 0;
  /// Number of samples in each region of the map.
  std::vector<std::size_t> region_samples;
  std::vector<ParameterUse> parameters;
  /// Distance to the nearest face of the sample's region. Ends that nothing can pass do not count (see
  /// ParameterUse::room).
  DistanceUse face;
  /// Distance to the end of the map, along the parameter that is nearest to its end.
  DistanceUse edge;
  /// Parameter of edge.least.
  int edge_parameter = -1;

  std::size_t regions() const { return region_samples.size(); }
  std::size_t visited() const;
  /// Numbers of the regions that no sample visited.
  std::vector<std::uint32_t> neverVisited() const;
  /// Share of the samples inside; 0 if there are no samples.
  double share() const;
};

/// Where one sample lies.
struct SampleUse {
  Lookup lookup;
  /// Distance to the nearest face, see MapUse. Valid inside.
  double face = 0.0;
  /// Distance to the edge of the map, see MapUse. Valid inside.
  double edge = 0.0;
  /// Parameter along which the edge is nearest.
  int edge_parameter = -1;
};

/// Counts sample by sample, from a bag or while flying. Holds the map by reference.
class MapUseCounter {
 public:
  explicit MapUseCounter(const RegionMap& map);

  /// One sample: the map's parameters as they were assembled, before any clipping. `stamp` [s]. Some
  /// hundred look-ups: not for the control step.
  SampleUse add(double stamp, const double* theta);

  const MapUse& use() const { return use_; }
  const RegionMap& map() const { return *map_; }

 private:
  double faceDistance(std::uint32_t region, const double* theta) const;
  double room(std::vector<double>* theta, std::size_t parameter, double end) const;
  void countParameters(const double* theta, LookupStatus status);
  void countDistances(double stamp, const double* theta, SampleUse* sample);

  const RegionMap* map_;
  std::vector<bool> enclosed_;  // parameters along which no edge is counted
  MapUse use_;
};

}  // namespace polyfly
