#pragma once

#include <cmath>
#include <string>

#include "online_controller/types/options.hpp"
#include "region_maps/error.hpp"

namespace polyfly {

/// The visitor of an option list that throws Error on a number that is not finite or out of its range.
class RangeCheck {
 public:
  explicit RangeCheck(std::string where) : where_(std::move(where)) {}

  void operator()(const char* key, double value, const char* unit, const Range& range) const {
    if (std::isfinite(value) && value >= range.least && value <= range.greatest) return;
    throw Error(where_ + ": " + key + ": must lie in [" + std::to_string(range.least) + ", " +
                std::to_string(range.greatest) + "] " + unit + ", got " + std::to_string(value));
  }
  void operator()(const char* /*key*/, bool /*value*/) const {}

 private:
  std::string where_;
};

}  // namespace polyfly
