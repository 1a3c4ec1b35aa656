#pragma once

#include <set>
#include <string>

#include "polyfly_base/yaml_field.hpp"
#include "polytope_sets/exact_polytope.hpp"
#include "region_maps/signal.hpp"

namespace polyfly {

/// A number as it is written: a decimal or a fraction. All functions throw Error with file, line and field.
Rational rationalOf(const YamlField& field);
RationalVector vectorOf(const YamlField& field, int size);
/// Name and unit of a signal whose name is not in `taken`, which gets it.
Signal signalOf(const YamlField& field, std::set<std::string>& taken);
/// A list of `rows` rows of `columns` numbers; -1: as many rows as there are.
RationalMatrix matrixOf(const YamlField& field, int rows, int columns);

/// The set that a map of A, b, A_eq, b_eq, box, vertices describes, in `dimension` dimensions; -1: any from 1
/// to kMaxSetDimension. The keys must have been checked.
ExactPolytope setOf(const YamlField& field, int dimension);

constexpr int kMaxSetDimension = 12;

}  // namespace polyfly
