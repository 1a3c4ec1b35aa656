#pragma once

#include <array>
#include <string>

#include "mpc_core/mpc_problem.hpp"
#include "project_root.hpp"

namespace polyfly {

/// The shipped problems of the three axes, longitudinal first. `kind` is what their files' names begin with.
inline std::array<MpcProblem, 3> shippedProblems(const std::string& kind = "multirotor_") {
  return {loadProblem(problemFile(kind + "longitudinal.yaml")),
          loadProblem(problemFile(kind + "lateral.yaml")), loadProblem(problemFile(kind + "vertical.yaml"))};
}

}  // namespace polyfly
