#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/text.hpp"

namespace checker {

/// The parts of a region map (region_maps/FORMAT.md) that a certificate speaks of. Throws Refused.
struct Map {
  explicit Map(const std::string& file);

  struct Region {
    std::uint32_t first_row, row_count, law, first_active, active_count;
  };

  /// A child with bit 31 set is a leaf.
  struct Node {
    std::uint32_t plane, below, above;
  };
  struct Leaf {
    std::uint32_t first, count;
  };
  static constexpr std::uint32_t kLeaf = 0x80000000u;

  std::uint32_t p = 0, q = 0, root = 0;
  std::uint64_t checksum = 0, size = 0, reduced_from = 0;
  double tolerance = 0.0, period = 0.0;
  std::string problem;             ///< text
  std::vector<std::string> words;  ///< all strings of the text section, in order

  /// Kind of the problem text: "yaml" or "json".
  const std::string& kind() const { return words[2]; }

  std::vector<double> bounds;  ///< lower and upper of each parameter
  std::vector<double> planes, laws;
  std::vector<Region> regions;
  std::vector<std::int32_t> rows, active;
  std::vector<Node> nodes;
  std::vector<Leaf> leaves;
  std::vector<std::uint32_t> candidates;
  std::vector<std::uint32_t> tests;  ///< rows that leaves test; empty: all

 private:
  void readText(const std::string& file);
  void checkTables() const;
  void checkLengths() const;
  void checkTree() const;
};

}  // namespace checker
