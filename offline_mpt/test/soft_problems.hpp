#pragma once

#include <string>

namespace polyfly {

/// What a made tracking problem has besides bounds on its input.
struct ProblemTraits {
  bool is_soft = false;
  bool is_blocked = false;
  bool limits_changes = false;
};

/// A problem file with 2 or 3 states, 2 to 5 parameters and up to 5 moves: model, weights, bounds and blocks are drawn
/// from the seed.
std::string madeProblem(const ProblemTraits& traits, unsigned seed);

}  // namespace polyfly
