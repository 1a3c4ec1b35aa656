#pragma once

#include <string>

#include "polytope_sets/invariant_set.hpp"
#include "polytope_sets/set_model.hpp"

namespace polyfly {

/// Prints the answers of `offline_mpt set` as text or JSON, and writes resulting sets.
struct SetOutput {
  bool json = false;
  std::string file;  ///< empty: none

  void printAnswer(bool answer) const;
  void printInfo(const ExactPolytope& set) const;
  void printSet(const ExactPolytope& set) const;
  void printGenerators(const Generators& generators) const;
  void printVolume(const Rational& volume) const;
  void printVolume(double volume) const;
  void printSupport(const ExactSupport& support) const;
  void printInvariant(const InvariantSet& result, const InvariantOptions& options, bool proven) const;
  void printProof(const InvarianceProof& proof) const;
};

/// "1, 1/2, -3e-1". Throw Error.
RationalVector parseNumbers(const std::string& text);
RationalMatrix parseMatrix(const std::string& text);  ///< "1,0;0,1"

}  // namespace polyfly
