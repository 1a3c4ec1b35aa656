#pragma once

#include <cstdint>
#include <vector>

#include "export_bound.hpp"
#include "lookup_path.hpp"

namespace checker {

/// The greatest number of each kind of operation over all parameters. It follows the look-up through the tree, and from
/// candidate to candidate of a leaf, and leaves out each path that is proven to be taken by no parameter.
class WorkProof {
 public:
  /// Code and watch outlive the object.
  WorkProof(const ExportedCode& code, const ProofWatch& watch);

  LookupWork run();

  /// After run: parameters in numbers of the code's type at which the look-up takes the proven number of each kind, where
  /// they were found. No two are the same.
  const std::vector<std::vector<double>>& reached() const { return reached_; }

 private:
  using Candidate = LookupTables::Candidate;

  void countPaths();
  bool mayRaise(const LookupWork& work, const LookupWork& rest) const;
  void raise(const LookupWork& work);
  void reach(const std::vector<double>& theta);
  void addStep(const PathStep& step);
  /// Where the value of a row is at most `limit`, and where it is greater.
  void addRow(std::uint32_t row, double limit) { addStep({row, limit, false}); }
  void addViolatedRow(std::uint32_t row, double limit) { addStep({row ^ 1u, -limit, true}); }
  void shrink(std::size_t size);
  bool isTaken();
  void descend(std::uint32_t child, LookupWork work);
  void search(std::uint32_t leaf, std::size_t candidate, LookupWork work, bool has_answer);
  void searchBeyond(std::uint32_t leaf, std::size_t candidate, const LookupWork& whole);
  void goOn(std::uint32_t leaf, std::size_t candidate, const LookupWork& work, bool has_answer);
  void keepReached();

  const ExportedCode& exported_;
  const LookupTables& code_;
  const ProofWatch& watch_;
  PathSearch paths_;
  Cell cell_;
  /// The comparisons on the way, which the cell holds.
  std::vector<PathStep> path_;
  /// The first steps of the path, up to one that contradicts an earlier one.
  std::size_t possible_ = 0;
  /// Bounds of |computed - exact| of each plane, at the parameter that the code is given.
  std::vector<double> error_;
  /// Of each node and leaf, then of each candidate of a leaf: what may follow, whatever the parameter is.
  std::vector<LookupWork> rest_;
  std::vector<std::vector<LookupWork>> rest_of_leaf_;
  int most_parts_ = 1;
  /// Of paths that numbers take, and of those that are neither known to be taken nor proven not to be.
  LookupWork greatest_, unknown_;
  std::vector<std::vector<double>> reached_;
  /// Of the present leaf.
  std::uint64_t tried_ = 0;
};

}  // namespace checker
