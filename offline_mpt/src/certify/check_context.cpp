#include <algorithm>
#include <cmath>

#include "certify/region_check.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

/// Greatest |u| of a row of a law in the box.
Rational greatestInBox(const ExactProgram& program, const double* row) {
  Rational size;
  for (const Rational& value : program.inBox(row, row[program.p])) size += abs(value);
  return size;
}

}  // namespace

CheckContext::CheckContext(const RegionMap& checked, const ParametricProgram& given,
                           const ExactProgram& exact, const CertifyOptions& chosen)
    : map(checked), source(given), program(exact), options(chosen) {
  for (std::size_t i = 0; i < map.inputs().size(); ++i) {
    const Signal& input = map.inputs()[i];
    Rational size;
    if (std::isfinite(input.lower) && std::isfinite(input.upper)) {
      size = Rational(input.upper) - Rational(input.lower);
    } else {
      for (std::size_t k = 0; k < map.lawCount(); ++k)
        size = std::max(size,
                        greatestInBox(program, map.law(k) + i * (static_cast<std::size_t>(program.p) + 1)));
    }
    input_sizes.push_back(size > 0 ? size : Rational(1));
  }
}

Rational CheckContext::lawScale(std::size_t input, const double* row) const {
  return std::min(std::max(Rational(1), greatestInBox(program, row)), input_sizes[input]);
}

}  // namespace polyfly
