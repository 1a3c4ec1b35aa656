#pragma once

#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/certify.hpp"
#include "robust_mpc/robust_law.hpp"

namespace polyfly {

class RegionMap;

/// All that the certificate of a robust map speaks of.
struct RobustStatement {
  const RobustProblem& problem;
  const RobustProgram& program;
  const FeasibleSet& set;
  const RobustLaw& law;
  /// Names and box of the map, as roundLaw has them.
  const ParametricProgram& signals;
};

/// Proves a map and its look-ups. A region with other active facets than any of the law's is a defect. The facets of the feasible set
/// are the rows of a linear program: tau is least, then |u~_0 - K e|. "Robust maps" in offline_mpt/CERTIFICATE.md.
CertifyReport certifyRobust(const RegionMap& map, const RobustStatement& statement,
                            const CertifyOptions& options);

}  // namespace polyfly
