#pragma once

#include <functional>
#include <optional>

namespace polyfly {

class RegionMap;

/// A map's problem solved anew at theta: its first input, none where there is no solution.
using OnlineOracle = std::function<std::optional<double>(const double* theta)>;

/// Oracles for problems that this library does not solve itself, which are those of a minimum-peak robust MPC. They
/// need linear programs, which nothing that flies links (robust_mpc/online_lp.hpp makes them). An empty one: that
/// map's answers are not compared.
using OracleMaker = std::function<OnlineOracle(const RegionMap&)>;

}  // namespace polyfly
