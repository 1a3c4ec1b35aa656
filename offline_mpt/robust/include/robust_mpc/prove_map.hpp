#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "robust_mpc/robust_law.hpp"

namespace polyfly {

class RegionMap;

/// A parameter, a disturbance, and what they break.
struct RobustWitness {
  RationalVector theta;
  RationalVector disturbance;  ///< each entry -1 or 1, of its half width
  std::string rule;
  Rational excess;
};

/// What was proven of a robust map in fractions. Disturbances are never sampled: bounds on the plan hold by
/// the robust counterpart at every vertex of the feasible set, hence everywhere, and once more for one step
/// by enumerating the vertices of the box of disturbances at every vertex of every region.
struct RobustProof {
  std::uint64_t facets = 0;
  std::uint64_t vertices = 0;
  bool set_valid = false;     ///< each facet is a weighted sum of rows: nothing feasible is cut off
  bool set_feasible = false;  ///< each vertex has a plan that meets every row: all that is left is feasible
  std::uint64_t regions = 0;
  /// tau is reached, and no less is possible: the duals of one combination.
  std::uint64_t optimal_regions = 0;
  bool preferred = false;  ///< the move is the optimal one nearest to K e, at every vertex
  bool covered = false;    ///< the regions' volumes add up to that of the feasible parameters
  Rational volume;
  std::uint64_t steps = 0;                    ///< vertex of a region with vertex of the disturbances
  std::optional<RobustWitness> broken_bound;  ///< after one step
  std::optional<RobustWitness> lost;  ///< a successor beyond what has a plan, not for the box of theta
  /// A successor may leave the box of an error without breaking a bound: the map ends there.
  struct BoxExit {
    int parameter = 0;
    double excess = 0.0;  ///< greatest, of the box's half width
    /// No row of the program but those of the peak depends on it, as on a position without bounds: with the
    /// parameter cut to its box the map's plan still meets all bounds, and only tau is not promised.
    bool clips_safely = false;
  };
  std::vector<BoxExit> box_exits;

  std::vector<std::string> defects;  ///< of the map's numbers
  double law_error = 0.0;            ///< greatest difference of map and exact law at vertices of its regions
  double plane_error = 0.0;          ///< greatest distance of a vertex outside the map's region [scaled]

  bool invariance_asked = false;  ///< the problem has an invariance rule

  bool recursivelyFeasible() const { return !lost; }
  /// Everything; without an invariance rule, recursive feasibility may fail: it is a finding then, not a
  /// defect.
  bool passed() const {
    return set_valid && set_feasible && optimal_regions == regions && regions > 0 && preferred && covered &&
           !broken_bound && defects.empty() && !(invariance_asked && lost);
  }
};

struct ProveOptions {
  int threads = 1;
  const std::atomic<bool>* stop = nullptr;
};

/// Computes the exact law of `problem` anew, proves it, and compares the map with it. Throws Error when the
/// map is not of this problem (names, units, boxes), is a reduced one, or the work was stopped.
RobustProof proveRobustMap(const RegionMap& map, const RobustProblem& problem,
                           const ProveOptions& options = {});

/// As above for a law that is at hand; the part that needs no map.
RobustProof proveLaw(const RobustProblem& problem, const RobustProgram& program, const FeasibleSet& set,
                     const RobustLaw& law);

/// For people, and as JSON.
std::string proofText(const RobustProblem& problem, const RobustProof& proof);
std::string proofJson(const RobustProblem& problem, const RobustProof& proof);

/// Compares a map with OnlineLp at seeded random parameters of the box.
struct RobustSampling {
  std::uint64_t samples = 0;
  std::uint64_t inside = 0;
  std::uint64_t status_differs = 0;  ///< the one has an answer, the other has none, beyond `tolerance`
  double input_error = 0.0;          ///< relative to max(1, |u|)
  double peak_error = 0.0;           ///< with peak_in_map
  std::uint64_t wrong = 0;           ///< samples whose error exceeds the tolerance
  bool passed() const { return status_differs == 0 && wrong == 0; }
};
RobustSampling sampleRobustMap(const RegionMap& map, const RobustProblem& problem, std::uint64_t samples,
                               std::uint64_t seed, double tolerance);

}  // namespace polyfly
