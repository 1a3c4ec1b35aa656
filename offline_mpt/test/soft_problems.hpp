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

/// What cartProblem has besides its constraints.
struct CartTraits {
  int horizon = 5;
  bool is_disturbed = false;
};

/// A problem file of a mass on a line: errors e_p and e_v of position p and speed v, acceleration a in [-1, 1.5] m/s^2, and
/// by choice a disturbance w of it in [-0.2, 0.3] m/s^2. `constraints` are lines below that key.
std::string cartProblem(const std::string& constraints, const CartTraits& traits = {});

/// The line of a soft bound of v in [-2, 2.5] m/s, with slacks as `slack` says: stage or horizon.
std::string softSpeed(double linear, const std::string& slack);

}  // namespace polyfly
