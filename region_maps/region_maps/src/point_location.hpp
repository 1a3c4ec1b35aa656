#pragma once

#include <cstddef>
#include <cstdint>

#include "region_maps/lookup.hpp"
#include "region_maps/map_content.hpp"

namespace polyfly {

/// What a look-up reads. All but `box` points into the file.
struct LookupTables {
  /// Bounds (lower, upper) of each parameter, widened by the tolerance.
  const double* box = nullptr;
  const double* planes = nullptr;
  const double* laws = nullptr;
  const MapContent::Region* regions = nullptr;
  const std::int32_t* rows = nullptr;
  const MapContent::Node* nodes = nullptr;
  const MapContent::Leaf* leaves = nullptr;
  const std::uint32_t* candidates = nullptr;
  /// nullptr: all rows.
  const std::uint32_t* tests = nullptr;
  double tolerance = 0.0;
  std::uint32_t root = 0;
  std::uint32_t parameters = 0;
  std::uint32_t inputs = 0;
};

/// The functions of RegionMap with these names, for one number of parameters.
struct LookupFunctions {
  using Tables = LookupTables;
  Lookup (*locate)(const Tables&, const double* theta) noexcept = nullptr;
  Lookup (*evaluate)(const Tables&, const double* theta, double* u) noexcept = nullptr;
  Lookup (*locate_exhaustively)(const Tables&, std::size_t regions, const double* theta) noexcept = nullptr;
  bool (*contains)(const Tables&, std::size_t region, const double* theta) noexcept = nullptr;
};

LookupFunctions lookupFunctionsFor(std::uint32_t parameters) noexcept;

}  // namespace polyfly
