#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "certify/reduction/tree_partition.hpp"

namespace polyfly {

/// An axis-aligned box.
struct Box {
  std::vector<double> lower, upper;
};

/// A region with a point strictly inside, and a box that holds it.
struct MapCell {
  std::uint32_t region = 0;
  ExactCell cell;
  Box box;
};

/// Ranges that hold those of both maps. Throws Error when the maps do not have the same parameters and inputs, or a
/// parameter has no range.
std::vector<Signal> commonRanges(const RegionMap& first, const RegionMap& second);

/// The regions of a map as cells in t, which is [-1, 1] in given ranges.
class MapCells {
 public:
  /// `ranges` are those of commonRanges. Planes that `other` has too become its rows. Both maps must outlive the object.
  MapCells(const RegionMap& map, const std::vector<Signal>& ranges, const MapCells* other, int threads);
  MapCells(const MapCells&) = delete;
  MapCells& operator=(const MapCells&) = delete;

  const ExactMap& exact() const { return exact_; }

  /// Regions with interior, ascending.
  const std::vector<MapCell>& regions() const { return regions_; }

  /// Sides of the map's box that lie inside of the ranges.
  const std::deque<ExactRow>& sides() const { return sides_; }

 private:
  void addSides(const std::vector<Signal>& ranges);
  void addRegions(int threads);

  const ExactMap exact_;
  std::deque<ExactRow> sides_;
  std::vector<MapCell> regions_;
};

/// Places, ascending, of the cells whose boxes meet `box` with their interiors.
std::vector<std::uint32_t> meeting(const std::vector<MapCell>& cells, const Box& box);

}  // namespace polyfly
