#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "region_maps/signal.hpp"

namespace polyfly {

/// Everything that a region map file holds, before it is laid out (region_maps/FORMAT.md).
///
/// p = parameters.size(), m = inputs.size(). All arrays are flat and row-major.
/// A plane is p + 1 numbers (a_0 .. a_{p-1}, c) and means the half-space a . theta <= c. Rows are
/// scaled so that a . theta - c is a distance when each parameter's range is mapped to [-1, 1].
struct MapContent {
  /// The half-spaces of one critical region, its law and its active set, as ranges of the arrays below.
  struct Region {
    std::uint32_t first_row = 0;
    std::uint32_t row_count = 0;
    std::uint32_t law = 0;
    std::uint32_t first_active = 0;
    std::uint32_t active_count = 0;
  };

  /// Interior node of the search tree. A child with kLeaf set is a leaf: the rest is its index.
  /// An interior child's index is greater than its parent's.
  struct Node {
    std::uint32_t plane = 0;
    std::uint32_t below = 0;  ///< child where a . theta <= c
    std::uint32_t above = 0;  ///< child where a . theta > c
  };

  /// Regions that may hold a parameter arriving here: candidates[first .. first + count), in order.
  struct Leaf {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };

  static constexpr std::uint32_t kLeaf = 0x80000000u;

  /// Of `tests`: all rows.
  static constexpr std::uint32_t kAllRows = 0xffffffffu;

  std::string name;           ///< short identifier of the problem
  std::string problem_text;   ///< the problem file, verbatim
  std::string problem_kind;   ///< "yaml" or "json"
  std::string solver_status;  ///< "complete", "limited", "incomplete", ...
  std::string solver_notes;   ///< deterministic facts about the solution, `key: value` lines
  double period = 0.0;        ///< sampling time of the controller [s], 0 if there is none
  double tolerance = 0.0;     ///< how far outside a half-space a parameter still counts as inside [scaled]

  std::vector<Signal> parameters;  ///< with the box: lower and upper
  std::vector<Signal> inputs;      ///< with their bounds

  std::vector<double> planes;  ///< unique planes, p + 1 numbers each
  std::vector<double> laws;    ///< unique laws, m rows of p + 1 numbers (K row, k): u = K theta + k
  std::vector<Region> regions;
  std::vector<std::int32_t> rows;    ///< i + 1: plane i as it is; -(i + 1): plane i with both sides negated
  std::vector<std::int32_t> active;  ///< active sets (row indices of the program), concatenated
  std::uint32_t first_fallback = 0;  ///< regions from here on count only where none before does; 0: all count
  std::uint64_t reduced_from = 0;    ///< checksum of the map that this one was reduced from, 0: none
  std::uint32_t root = 0;            ///< as a child: node index, or leaf index with kLeaf set
  std::vector<Node> nodes;
  std::vector<Leaf> leaves;
  std::vector<std::uint32_t> candidates;
  /// Per candidate the rows that a look-up tests. Bit i is row i of the region; the last bit is row 31 and all rows
  /// after it. Empty: all rows of each candidate's region.
  std::vector<std::uint32_t> tests;
};

/// Whether a look-up tests row `row` of a candidate with the bits `tests`, see MapContent::tests.
constexpr bool isTested(std::uint32_t tests, std::uint32_t row) noexcept {
  return (tests >> (row < 31 ? row : 31) & 1u) != 0;
}

/// How many of a region's rows a look-up tests.
constexpr std::uint32_t testedRows(std::uint32_t tests, std::uint32_t row_count) noexcept {
  std::uint32_t count = 0;
  for (std::uint32_t row = 0; row < row_count && row < 31; ++row) count += tests >> row & 1u;
  return row_count > 31 && isTested(tests, 31) ? count + row_count - 31 : count;
}

}  // namespace polyfly
