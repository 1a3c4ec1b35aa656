#pragma once

#include <vector>

#include "code_tables.hpp"

namespace polyfly {

class RegionMap;

/// A parameter with many operations, and how many one evaluation of the code takes there.
struct CostlyPoint {
  /// Size p; empty where the map has no answer anywhere. [the signals' units]
  std::vector<double> theta;
  CodeCost cost;
};

/// The costliest of many seeded parameters that the map answers: anywhere in the box, beside planes, and around the
/// costliest so far. The same map and options give the same point.
CostlyPoint costlyPoint(const RegionMap& map, const ExportOptions& options);

}  // namespace polyfly
