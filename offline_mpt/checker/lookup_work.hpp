#pragma once

#include <cstdint>

#include "lookup_tables.hpp"

namespace checker {

/// Operations of one look-up.
struct LookupWork {
  /// Sums of p products: the half-spaces of nodes, those of the rows that candidates test, and the rows of the law.
  std::uint64_t sums = 0;
  /// Two for each parameter, one for each node, one for each row and candidate. Where the candidate with the least
  /// violation is taken, two for each row and candidate.
  std::uint64_t comparisons = 0;
};

/// No look-up takes more operations of a kind: along each path to a leaf, with all rows of all its candidates.
LookupWork greatestWork(const LookupTables& code);

}  // namespace checker
