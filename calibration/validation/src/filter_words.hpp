#pragma once

#include <array>
#include <string>

#include "validation/filter_validation.hpp"

namespace polyfly {

// Words for the results of a filter's replay.
constexpr std::array<const char*, 3> kFilterAxes = {"x", "y", "z"};
constexpr std::array<const char*, kFilterStatusCount> kFilterStatusNames = {"passed", "changed", "no_wish",
                                                                            "outside", "no_state"};

/// A number with three significant digits, as people write it.
std::string filterNumber(double value);

/// The verdict in a sentence.
std::string filterVerdict(const FilterValidation& validation);

}  // namespace polyfly
