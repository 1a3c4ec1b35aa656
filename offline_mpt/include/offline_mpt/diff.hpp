#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace polyfly {

class RegionMap;

struct DiffOptions {
  int threads = 1;  ///< 1..256; the report does not depend on it
  /// Pairs of regions whose laws differ by more count as different [unit of u].
  double tolerance = 1e-8;
  const std::atomic<bool>* stop = nullptr;  ///< set from outside to end early
  /// Called now and then from the calling thread.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
};

/// The greatest difference of one input where two regions meet.
struct LawDifference {
  /// Index of the input.
  int input = 0;
  std::uint32_t first_region = 0;
  std::uint32_t second_region = 0;
  /// Greatest |u - u'| over the common part of the regions, not rounded down [unit of u].
  double size = 0.0;
  /// Where it is reached, in the closure of the common part. Empty if no regions meet.
  Eigen::VectorXd theta;
};

/// Whether one map answers wherever another one does, within its own tolerance.
struct MapCover {
  bool covers = true;
  /// If not: a region of the other map, and a parameter inside of it that no region of this one holds.
  std::uint32_t region = 0;
  Eigen::VectorXd witness;
};

struct DiffReport {
  std::uint64_t first_regions = 0;
  std::uint64_t second_regions = 0;
  /// Pairs of regions whose interiors meet.
  std::uint64_t pairs = 0;
  /// Of `pairs`: their laws differ by more than the tolerance.
  std::uint64_t different_pairs = 0;
  double tolerance = 0.0;
  /// The greatest difference of each input.
  std::vector<LawDifference> greatest;
  /// Differences above the tolerance by first region, second region and input.
  std::vector<LawDifference> differences;
  MapCover first_covers_second;
  MapCover second_covers_first;
  bool interrupted = false;

  /// Within the tolerances, both maps give the same answers.
  bool same() const {
    return !interrupted && different_pairs == 0 && first_covers_second.covers && second_covers_first.covers;
  }
};

/// Where and by how much at most two maps differ. For each pair of regions whose interiors meet, a linear program for
/// each input gives the greatest difference of their laws. Regions and laws count at the exact values of their
/// doubles, and rational arithmetic decides. The maps must have the same parameters and inputs; ranges may differ.
/// Throws Error otherwise, and where a parameter has no range.
DiffReport diffMaps(const RegionMap& first, const RegionMap& second, const DiffOptions& options = {});

/// The report for people, several lines. `inputs` are the maps' names of the inputs.
std::string diffText(const DiffReport& report, const std::vector<std::string>& inputs);
std::string diffJson(const DiffReport& report, const std::vector<std::string>& inputs);

}  // namespace polyfly
