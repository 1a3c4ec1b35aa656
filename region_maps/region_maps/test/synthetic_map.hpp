#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "region_maps/aligned_bytes.hpp"
#include "region_maps/map_content.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

/// A partition of a random box by random hyperplanes, by construction without gap or overlap.
struct TreeRecipe {
  std::uint32_t parameters = 3;
  std::uint32_t inputs = 2;
  std::uint32_t regions = 40;      ///< at least 1
  std::uint32_t leaf_regions = 1;  ///< greatest number of regions that a leaf leaves to be tested
  std::uint32_t holes_one_in = 0;  ///< one region in so many is left out of the map; 0: none
  bool names_tests = false;        ///< leaves name the rows that the nodes and the box do not imply
  std::uint32_t laws = 7;          ///< distinct laws, shared by the regions
  double tolerance = 1e-9;         ///< [scaled]
  std::uint64_t seed = 1;
};

/// Regions are numbered in a shuffled order; each lists the half-spaces on its path and the faces of the box.
MapContent makeTreeMap(const TreeRecipe& recipe);

/// The box [0, cells]^p cut into unit cubes. Cube (i_0, i_1, ..) is region i_0 + cells (i_1 + cells (..));
/// all numbers are small integers, so every test on a face is exact. The only input of region r is the
/// constant r.
MapContent makeGridMap(std::uint32_t parameters, std::uint32_t cells);

/// Two by two unit squares, with every section filled and multi-line text: the map that tests damage.
MapContent makeSmallMap();

/// The same map as version 1 of the format had it. `content` names no tests.
std::vector<std::byte> layOutVersion1(const MapContent& content);

/// A map in memory with the content that it was made from.
struct MadeMap {
  explicit MadeMap(MapContent made);

  MapContent content;
  AlignedBytes bytes;
  RegionMap map;
};

/// Anywhere in the box about the middle of the ranges that is that part of them.
std::vector<double> randomPoint(const MapContent& content, std::mt19937_64& random, double part_of_range);

}  // namespace polyfly
