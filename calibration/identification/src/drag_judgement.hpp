#pragma once

#include <string>
#include <vector>

#include "identification/fit_loop.hpp"

namespace polyfly {

/// Marks a drag coefficient that the data do not support, with a warning.
void judgeDrag(FittedParameter& drag, std::vector<std::string>* warnings);

}  // namespace polyfly
