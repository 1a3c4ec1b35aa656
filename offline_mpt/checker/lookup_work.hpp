#pragma once

#include <cstdint>
#include <vector>

#include "export_bound.hpp"

namespace checker {

/// Operations of one look-up.
struct LookupWork {
  /// Half-spaces whose value is computed: of nodes, and of the rows that candidates test.
  std::uint64_t planes = 0;
  /// Of these, rows of candidates.
  std::uint64_t rows = 0;
  /// Two for each parameter, one for each node, two for each row, four for each candidate.
  std::uint64_t comparisons = 0;
};

/// The greatest number of each kind of operation over all parameters. It follows the look-up through the tree, and from
/// candidate to candidate of a leaf, and leaves out each path that is proven to be taken by no parameter.
class WorkProof {
 public:
  /// Code and watch outlive the object.
  WorkProof(const ExportedCode& code, const ProofWatch& watch);

  LookupWork run();

 private:
  using Candidate = LookupTables::Candidate;

  void countPaths();
  bool mayRaise(const LookupWork& work, const LookupWork& rest) const;
  void raise(const LookupWork& work);
  void addRow(std::uint32_t row, double limit);
  /// Where the value of a row is greater than `limit`.
  void addViolatedRow(std::uint32_t row, double limit) { addRow(row ^ 1u, -limit); }
  bool isTaken();
  void descend(std::uint32_t child, LookupWork work);
  void search(std::uint32_t leaf, std::size_t candidate, LookupWork work);
  void goOn(std::uint32_t leaf, std::size_t candidate, const LookupWork& work);

  const LookupTables& code_;
  const ProofWatch& watch_;
  Cell cell_;
  /// Bounds of |computed - exact| of each plane, at the parameter that the code is given.
  std::vector<double> error_;
  /// Of each node and leaf, then of each candidate of a leaf: what may follow, whatever the parameter is.
  std::vector<LookupWork> rest_;
  std::vector<std::vector<LookupWork>> rest_of_leaf_;
  LookupWork greatest_;
  /// Of the present leaf.
  std::uint64_t tried_ = 0;
};

}  // namespace checker
