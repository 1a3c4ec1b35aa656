#pragma once

#include <string>
#include <vector>

#include "identification/fit_loop.hpp"

namespace polyfly {

/// Marks a drag coefficient that the data do not support, with a warning.
void judgeDrag(FittedParameter& drag, std::vector<std::string>* warnings);

/// Marks mass and hover thrust, or the hovering command, where the data do not bound the first of them, with a
/// warning.
void judgeMass(std::vector<FittedParameter>* parameters, std::vector<std::string>* warnings);

}  // namespace polyfly
