#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "mpc_core/parametric_program.hpp"
#include "region_maps/region_map.hpp"
#include "verify/strict_qp.hpp"

namespace polyfly {

/// What a map and its program say at one parameter.
struct SampleFinding {
  enum class Kind : std::uint8_t {
    kRight,        ///< the map's answer is an optimum, within the tolerance
    kWrong,        ///< it is none
    kOutside,      ///< the map is silent, and there is no solution
    kMissed,       ///< the map is silent where there is a solution
    kFalseInside,  ///< the map answers where there is no solution
    kBeyond,       ///< kWrong or kFalseInside, but right at the nearest parameter of the region that answers
    kUnbounded,    ///< there are solutions, and the cost falls without end
    kEdge,         ///< map and program differ, but near the edge of the feasible set
    kUndecided,    ///< the optimum could not be found
  };
  Kind kind = Kind::kRight;
  Lookup lookup;
  /// kRight, kWrong: of u, the greatest share of an input's range. kFalseInside: distance to the feasible set [scaled]. kBeyond:
  /// either.
  double error = 0.0;
  Eigen::VectorXd u;      ///< the map's
  Eigen::VectorXd right;  ///< the optimum, where there is one
};

/// What a parameter without a region means.
enum class Silence : std::uint8_t {
  kIgnored,  ///< nothing: the map is a part
  kQuick,    ///< that 32 digits find no solution
  kExact,    ///< that an exact linear program has none
};

struct AnswerRules {
  double error = 0.0;  ///< greatest SampleFinding::error of a right answer
  double edge = 0.0;   ///< parameters nearer to the edge of the feasible set may go either way [scaled]
  Silence silence = Silence::kExact;
};

/// Checks answers of a map, also of one that is reduced, against the numbers of its program. The tight rows of the region that
/// answers give the optimum, with 32 digits; where they do not, a dual active-set method goes on from them. Before a map is
/// called wrong about where there is a solution, or about a linear cost, exact linear programs decide. So they do of each
/// silence, if asked. Look-ups answer within the map's tolerance beyond a region; how far u is off there depends on laws and
/// corners, so the answer counts at the nearest parameter of the region. One object serves one thread.
class AnswerChecker {
 public:
  /// All that is given outlives the object. `ranges` is what errors of the inputs are shares of. Throws Error where H is
  /// neither zero nor positive definite where the equalities leave z free.
  AnswerChecker(const RegionMap& map, const ParametricProgram& program, const Eigen::VectorXd& ranges,
                const AnswerRules& rules);

  SampleFinding check(const Eigen::VectorXd& theta);

  /// Whether there is a solution at theta and none just beside it, or the other way round.
  bool isAtEdge(const Eigen::VectorXd& theta);

  /// The optimum is unique.
  bool isStrict() const { return !feasible_; }

 private:
  void checkAnswer(const Eigen::VectorXd& theta, SampleFinding& finding);
  bool isRightInRegion(const Eigen::VectorXd& theta, const SampleFinding& finding);
  SampleFinding::Kind kindOfSilence(const Eigen::VectorXd& theta);
  void decideInfeasible(const Eigen::VectorXd& theta, SampleFinding& finding);
  bool isInfeasible(const Eigen::VectorXd& theta);
  double distanceToFeasible(const Eigen::VectorXd& theta);

  const RegionMap& map_;
  const ParametricProgram& program_;
  const Eigen::VectorXd& ranges_;
  AnswerRules rules_;
  Eigen::VectorXd precision_;
  StrictQp optimum_;
  // Of a linear cost.
  std::optional<StrictQp> feasible_;
};

/// Ranges of the inputs; without one, the greatest |u| at the samples.
Eigen::VectorXd inputRanges(const RegionMap& map, const std::vector<Eigen::VectorXd>& samples);

/// Whether `is` holds at theta moved by `step` half-ranges along an axis; moves that leave the box are left out.
template <class Is>
bool anyBeside(const Eigen::VectorXd& theta, const std::vector<Signal>& parameters, double step,
               const Is& is) {
  Eigen::VectorXd moved = theta;
  for (Eigen::Index j = 0; j < theta.size(); ++j) {
    const Signal& signal = parameters[static_cast<std::size_t>(j)];
    const double distance = step * 0.5 * (signal.upper - signal.lower);
    for (const double side : {-distance, distance}) {
      moved[j] = theta[j] + side;
      if (moved[j] >= signal.lower && moved[j] <= signal.upper && is(moved)) return true;
    }
    moved[j] = theta[j];
  }
  return false;
}

}  // namespace polyfly
