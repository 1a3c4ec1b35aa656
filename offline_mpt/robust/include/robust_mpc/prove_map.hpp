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
  /// Whether the problem has an invariance rule.
  bool invariance_asked = false;

  /// What is wrong with the map.
  std::vector<std::string> defects;
  /// Greatest difference of the map's laws from the exact ones, relative as CertifyReport::law_error.
  double law_error = 0.0;
  double plane_error = 0.0;  ///< greatest difference of a plane [scaled]
  /// The map's optimality, half-spaces, laws, coverage and look-ups are proven: the text of its certificate. Else empty.
  std::string certificate;

  bool recursivelyFeasible() const { return !lost; }
  /// Set and one step; without an invariance rule, recursive feasibility may fail: it is a finding then, not a defect.
  bool lawHolds() const {
    return set_valid && set_feasible && regions > 0 && !broken_bound && !(invariance_asked && lost);
  }
  bool passed() const { return lawHolds() && defects.empty() && !certificate.empty(); }
};

struct ProveOptions {
  int threads = 1;
  const std::atomic<bool>* stop = nullptr;
};

/// Computes the exact law of `problem` anew and proves what holds of it. Then the map is proven as that of the linear program
/// of its facets, as `certify` does. Throws Error when the map is not of this problem (names, units, boxes), is a reduced one,
/// or the work was stopped.
RobustProof proveRobustMap(const RegionMap& map, const RobustProblem& problem,
                           const ProveOptions& options = {});

/// The part that needs no map: the feasible set, and one step from every vertex of every region.
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
