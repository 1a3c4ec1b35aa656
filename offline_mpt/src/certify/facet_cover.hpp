#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "certify/farkas_proof.hpp"

namespace polyfly {

/// A cell of a cover that is cut has fewer rows. The checker refuses others.
constexpr std::size_t kMostCellRows = 2000;

/// A region that may lie behind a facet.
struct CoverCandidate {
  std::uint32_t region = 0;
  /// Rows that the map lists, in map order.
  const std::vector<ExactRow>* rows = nullptr;
};

/// Whether `row` is zero on all of the plane.
bool vanishesOn(const ExactRow& row, const ExactRow& plane);

/// Proves that candidates cover a facet, or a region, by cutting off what lies outside of the first, and
/// covering that with the others.
class FacetCover {
 public:
  /// `plane` is the facet's row, null for a region in p dimensions; all must outlive the object. `stop`, if
  /// given, ends the work.
  FacetCover(const ExactRow* plane, int p, const std::vector<CoverCandidate>& candidates,
             const std::atomic<bool>* stop);

  /// `rows` of the region that the facet belongs to. The proof's text is appended to `text`. False:
  /// uncovered() lies in the facet, and in no candidate; or it is empty, and the work was stopped. Throws Error
  /// where a cell has too many rows.
  bool cover(const std::vector<ExactRow>& rows, std::string& text);

  const std::vector<Rational>& uncovered() const { return uncovered_; }

  /// Regions of the candidates that the proof names, some more than once.
  const std::vector<std::uint32_t>& used() const { return used_; }

 private:
  using Cell = std::vector<const ExactRow*>;

  bool coverCell(Cell cell, std::size_t first, std::string& text);
  bool overlaps(const Cell& cell, const CoverCandidate& candidate) const;

  bool vanishes(const ExactRow& row) const { return plane_ != nullptr && vanishesOn(row, *plane_); }

  const ExactRow* plane_;
  const std::vector<CoverCandidate>& candidates_;
  const std::atomic<bool>* stop_;
  int p_;
  std::deque<ExactRow> negated_;
  std::vector<Rational> uncovered_;
  std::vector<std::uint32_t> used_;
};

/// A proof as text: number of weights, then place and weight of each.
void appendWeights(const FarkasProof& proof, std::string& text);

}  // namespace polyfly
