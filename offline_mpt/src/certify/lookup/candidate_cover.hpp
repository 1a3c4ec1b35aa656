#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "certify/lookup/lookup_context.hpp"
#include "certify/multipliers.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

/// A facet behind which no parameter has a solution, as the map has it.
struct BoundaryRow {
  std::uint32_t region = 0;
  std::uint32_t row = 0;
  std::int32_t signed_row = 0;
  /// The half-space in t, rounded: p + 1 numbers.
  std::vector<double> rounded;
};

/// One boundary row for each plane of the map that has any.
std::vector<BoundaryRow> boundaryRows(const LookupContext& context);

/// Proves that the candidates of a leaf cover a cell: cuts it by the rows that they test until nothing is left. The work
/// grows fast with the number of candidates.
class CandidateCover {
 public:
  using Cell = ExactRows;

  /// Tested rows count moved outwards by `reach`. What lies further than the tolerance of a look-up outside of a boundary
  /// row needs no candidate; nullptr: there is none. A cell may fall into `most_cells` cells.
  CandidateCover(const LookupContext& context, const LeafView& leaf, const Integer& reach,
                 const std::vector<BoundaryRow>* boundary, std::size_t most_cells);

  /// Appends the proof. False: uncovered() is in the cell, and not covered; or the work was stopped, or is too much.
  bool cover(Cell cell, std::string& text);

  /// Empty where that is not known.
  const std::vector<Rational>& uncovered() const { return uncovered_; }

 private:
  bool coverBy(Cell cell, std::vector<std::uint32_t> left, std::string& text);
  bool cutByCandidate(Cell cell, std::vector<std::uint32_t> left, std::size_t chosen, std::string& text);
  bool cutByBoundary(Cell cell, std::vector<std::uint32_t> left, const std::vector<Rational>& point,
                     std::string& text);

  const LookupContext& context_;
  const std::vector<BoundaryRow>* boundary_;
  std::size_t most_cells_;
  /// Tested rows of each candidate moved outwards, and what lies outside of them.
  std::vector<std::vector<ExactRow>> tested_, outside_;
  std::deque<ExactRow> moved_boundary_;
  std::vector<Rational> uncovered_;
  std::size_t cells_ = 0;
};

}  // namespace polyfly
