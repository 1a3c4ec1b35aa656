#pragma once

#include <string>

#include "polyfly_base/range.hpp"

namespace polyfly {

/// The visitor of an option list that throws Error `where: key: rule` on a number that is not finite or out of its
/// range. An empty `where` is left out with its colon.
struct RangeCheck {
  std::string where;

  void operator()(const char* key, double value, const char* unit, const Range& range) const;
  void operator()(const char* /*key*/, bool /*value*/) const {}
};

}  // namespace polyfly
