#pragma once

#include "polyfly_base/yaml_field.hpp"
#include "polytope_sets/rational.hpp"

namespace polyfly {

/// Numbers as they are written, decimals or fractions. All throw Error with file, line and field.
Rational exactNumber(const YamlField& field);
RationalVector exactVector(const YamlField& field, int size);
/// A list of `rows` rows; -1: as many as there are, at least one.
RationalMatrix exactMatrix(const YamlField& field, int rows, int columns);

}  // namespace polyfly
