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

/// What was proven of a robust map in fractions. Disturbances are never sampled. Bounds on the plan hold by the
/// robust counterpart at every vertex of the feasible set, hence everywhere. For one step they hold once more, by
/// enumerating the vertices of the box of disturbances at every vertex of every region.
struct RobustProof {
  std::uint64_t facets = 0;
  std::uint64_t vertices = 0;
  /// Each facet is a weighted sum of rows, so no feasible point is cut off.
  bool set_valid = false;
  /// Each vertex has a plan that meets every row, so all remaining points are feasible.
  bool set_feasible = false;
  std::uint64_t regions = 0;
  /// tau is reached, and no less is possible: the duals of one combination.
  std::uint64_t optimal_regions = 0;
  /// At every vertex, the move is the optimal one nearest to K e.
  bool preferred = false;
  /// The volumes of the regions add up to that of the feasible parameters.
  bool covered = false;
  Rational volume;
  /// Number of pairs of a region's vertex and a vertex of the disturbances.
  std::uint64_t steps = 0;
  /// A bound that one step breaks.
  std::optional<RobustWitness> broken_bound;
  /// A successor that has no plan. The box of theta does not count.
  std::optional<RobustWitness> lost;
  /// A successor may leave the box of an error without breaking a bound: the map ends there.
  struct BoxExit {
    int parameter = 0;
    /// Greatest excess, in half widths of the box.
    double excess = 0.0;
    /// No row of the program but those of the peak depends on it, as on a position without bounds. With the parameter
    /// cut to its box, the map's plan still meets all bounds. Only tau is not promised.
    bool clips_safely = false;
  };
  std::vector<BoxExit> box_exits;

  /// Errors of the map's numbers.
  std::vector<std::string> defects;
  /// Greatest difference of the map's law and the exact law at vertices of its regions.
  double law_error = 0.0;
  /// Greatest distance of a vertex outside the map's region.
  double plane_error = 0.0;  ///< [scaled]

  /// Text of the certificate of a map; empty where the proof does not pass.
  std::string certificate;

  /// Whether the problem has an invariance rule.
  bool invariance_asked = false;

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

/// Computes the exact law of `problem` anew, proves it, compares the map with it, and proves what look-ups answer. Throws Error when the
/// map is not of this problem (names, units, boxes), is a reduced one, or the work was stopped.
RobustProof proveRobustMap(const RegionMap& map, const RobustProblem& problem,
                           const ProveOptions& options = {});

/// As above for a law that is at hand; the part that needs no map.
RobustProof proveLaw(const RobustProblem& problem, const RobustProgram& program, const FeasibleSet& set,
                     const RobustLaw& law);

/// Writes the certificate of a map; throws Error where there is none.
void writeCertificate(const RobustProof& proof, const std::string& path);

/// For people, and as JSON.
std::string proofText(const RobustProblem& problem, const RobustProof& proof);
std::string proofJson(const RobustProblem& problem, const RobustProof& proof);

/// Compares a map with OnlineLp at seeded random parameters of the box.
struct RobustSampling {
  std::uint64_t samples = 0;
  std::uint64_t inside = 0;
  /// Samples for which only the map or only OnlineLp has an answer, beyond `tolerance`.
  std::uint64_t status_differs = 0;
  /// Greatest error of u, relative to max(1, |u|).
  double input_error = 0.0;
  /// Greatest error of tau, with peak_in_map.
  double peak_error = 0.0;
  /// Samples whose error exceeds the tolerance.
  std::uint64_t wrong = 0;
  bool passed() const { return status_differs == 0 && wrong == 0; }
};
RobustSampling sampleRobustMap(const RegionMap& map, const RobustProblem& problem, std::uint64_t samples,
                               std::uint64_t seed, double tolerance);

}  // namespace polyfly
