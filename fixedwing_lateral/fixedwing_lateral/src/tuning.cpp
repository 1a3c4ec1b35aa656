#include "fixedwing_lateral/tuning.hpp"

#include "polyfly_base/range_check.hpp"

namespace polyfly {

void checkTuning(const LateralWeights& weights, const LateralLimits& limits, const std::string& where) {
  visitTuning(weights, RangeCheck{where});
  visitLimits(limits, RangeCheck{where});
}

void checkHorizon(const HorizonOptions& options, const std::string& where) {
  visitHorizon(options, RangeCheck{where});
}

}  // namespace polyfly
