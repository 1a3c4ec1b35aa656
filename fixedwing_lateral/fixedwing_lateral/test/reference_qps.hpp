#pragma once

#include <string>
#include <vector>

#include "fixedwing_lateral/horizon_data.hpp"

namespace lateral_test {

/// One reference quadratic program of a real-time iteration, with what it was made from.
struct ReferenceQp {
  polyfly::HorizonData data;
  polyfly::LateralState state;
  std::vector<double> moves;                 // 40
  std::vector<polyfly::LateralState> nodes;  // 41
  std::vector<double> previous;              // 40
  // Optimal change of the moves.
  std::vector<double> solution;
};

/// The set `name` (fw_rand, fw_seq, fw_hard); empty where the reference data are absent.
std::vector<ReferenceQp> readReferenceQps(const std::string& name);

}  // namespace lateral_test
