#pragma once

#include <utility>

#include "../../test/map_in_memory.hpp"
#include "offline_mpt/encode.hpp"
#include "robust_mpc/prove_map.hpp"
#include "solved_robust.hpp"

namespace polyfly {

/// A robust map with its proof.
struct ProvenRobust {
  explicit ProvenRobust(const MadeRobust& made) : ProvenRobust(made.problem()) {}

  explicit ProvenRobust(RobustProblem problem) : solved(std::move(problem)) {
    const RoundedLaw rounded = roundLaw(solved.problem, solved.law, ExploreStatus::kComplete);
    content = encode(rounded.program, rounded.partition);
    proof = proveRobustMap(MapInMemory(content).map(), solved.problem);
  }

  SolvedRobust solved;
  MapContent content;
  RobustProof proof;
};

}  // namespace polyfly
