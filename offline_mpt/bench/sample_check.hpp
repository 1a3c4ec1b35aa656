#pragma once

#include <nlohmann/json.hpp>

#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/partition.hpp"

namespace polyfly::bench {

/// A partition against the solutions that come with a reference problem.
struct SampleCheck {
  /// Samples with a solution that is accurate enough to count.
  int feasible = 0;
  /// Feasible samples that no region holds.
  int missed = 0;
  /// Samples without a solution.
  int infeasible = 0;
  /// Infeasible samples that a region holds.
  int false_inside = 0;
  /// Greatest |u - reference| over all regions that hold a sample, relative to the greatest |u| of the samples. With H = 0,
  /// of the first such region, and the nearest optimum is the reference.
  double u_error = 0.0;
};

/// `samples`: the list of that name in the problem file. Samples nearer than 1e-6 to the edge of the feasible
/// set, and those whose own KKT residual is above 1e-8, are left out.
SampleCheck checkSamples(const ParametricProgram& program, const Partition& partition,
                         const nlohmann::json& samples);

}  // namespace polyfly::bench
