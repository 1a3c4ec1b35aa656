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

  /// Value of an element of `tests` that names all rows.
  static constexpr std::uint32_t kAllRows = 0xffffffffu;

  /// Short identifier of the problem.
  std::string name;
  /// Text of the problem file, verbatim.
  std::string problem_text;
  /// Kind of the problem file: "yaml" or "json".
  std::string problem_kind;
  /// Status of the solver: "complete", "limited", "incomplete", ...
  std::string solver_status;
  /// Deterministic facts about the solution, in lines `key: value`.
  std::string solver_notes;
  /// Sampling time of the controller. 0: none.
  double period = 0.0;  ///< [s]
  /// Distance outside a half-space at which a parameter still counts as inside.
  double tolerance = 0.0;  ///< [scaled]

  /// Parameters with their box: lower and upper.
  std::vector<Signal> parameters;
  /// Inputs with their bounds.
  std::vector<Signal> inputs;

  /// Unique planes, p + 1 numbers each.
  std::vector<double> planes;
  /// Unique laws u = K theta + k, m rows of p + 1 numbers (K row, k).
  std::vector<double> laws;
  std::vector<Region> regions;
  /// i + 1: plane i as it is. -(i + 1): plane i with both sides negated.
  std::vector<std::int32_t> rows;
  /// Active sets (row indices of the program), concatenated.
  std::vector<std::int32_t> active;
  /// Checksum of the map that this one was reduced from. 0: none.
  std::uint64_t reduced_from = 0;
  /// The root as a child: node index, or leaf index with kLeaf set.
  std::uint32_t root = 0;
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

/// The bits of MapContent::tests that name all rows of a region.
constexpr std::uint32_t testsOfAll(std::uint32_t row_count) noexcept {
  return row_count < 32 ? (std::uint32_t{1} << row_count) - 1 : MapContent::kAllRows;
}

/// How many of a region's rows a look-up tests.
constexpr std::uint32_t testedRows(std::uint32_t tests, std::uint32_t row_count) noexcept {
  std::uint32_t count = 0;
  for (std::uint32_t row = 0; row < row_count && row < 31; ++row) count += tests >> row & 1u;
  return row_count > 31 && isTested(tests, 31) ? count + row_count - 31 : count;
}

}  // namespace polyfly
