#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/online_program.hpp"
#include "mpc_core/parametric_program.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

/// What answers for one axis: parameters in, input out. It looks the answer up in a map, or solves the same problem online
/// (Eq. 38).
class AxisLaw {
 public:
  /// Looks up in `map`, kept by reference. `problem` is the result of problemOf(map): parsing it takes longer than
  /// everything else, so who makes many laws from one map parses once.
  AxisLaw(const RegionMap& map, MpcProblem problem) : map_(&map), problem_(std::move(problem)) {}
  /// Solves `problem` at each parameter; the box of the parameters does not limit it. Throws Error.
  explicit AxisLaw(MpcProblem problem);

  /// Where its map is of a tracking problem, solve() can be called from now on. Throws Error.
  void solveOutside();
  bool solvesOutside() const noexcept { return map_ != nullptr && online_; }

  const MpcProblem& problem() const noexcept { return problem_; }
  const std::vector<Signal>& parameters() const noexcept;
  const std::vector<Signal>& inputs() const noexcept;
  /// What it is made from, for messages: `PATH: as the lateral map: `.
  std::string place(const std::string& axis) const;

  /// The input at theta, by the map, or by solve() where there is none. kOutsideBox only where answers end at the box of the
  /// parameters; a problem without solution is kOutsidePartition. Unless kInside, `input` is left alone.
  Lookup evaluate(const double* theta, double* input) noexcept;
  Lookup solve(const double* theta, double* input) noexcept;
  /// As evaluate() of a map, and keeps nothing; without a map it leaves `input` alone.
  void lookUp(const double* theta, double* input) const noexcept {
    if (map_ != nullptr) map_->evaluate(theta, input);
  }
  /// Whether the last answer was solved and not looked up.
  bool isSolved() const noexcept { return solved_; }

  /// The stages of the problem; 0 where they cannot have references of their own.
  int stages() const noexcept;
  /// Whether stages' references come by setGradient(). Otherwise by a parameter, see AxisNames::disturbance_ahead.
  bool takesGradient() const noexcept { return map_ == nullptr && online_->plan.isOfInputs(); }
  /// Adds a number for each block of moves to the gradient of the next solve() of a law without a map, see StageReferences;
  /// nullptr: none from now on.
  void setGradient(const double* gradient) noexcept { gradient_ = map_ == nullptr ? gradient : nullptr; }
  void reset() noexcept;
  /// The input u of stage `stage` as the last solve() planned it under the steady input `reference`. False where there is
  /// no plan.
  bool planned(int stage, double reference, double* input) const noexcept;
  /// Of the last answer, see ControlLaw::kktResidual.
  double kktResidual() const noexcept { return solved_ ? online_->program.solver().kktResidual() : -1.0; }
  int iterations() const noexcept { return iterations_; }  ///< working sets of the last answer

 private:
  struct Online {
    explicit Online(const MpcProblem& problem);

    InputPlan plan;
    OnlineProgram program;
    // u~ of the blocks.
    Eigen::VectorXd planned;
    std::vector<int> block_of_stage;
  };

  const RegionMap* map_ = nullptr;  // not owned
  MpcProblem problem_;
  std::optional<Online> online_;
  const double* gradient_ = nullptr;  // not owned
  bool solved_ = false;
  int iterations_ = 0;
};

/// The problem that a map was made from. Throws Error unless the map is complete and was made from a
/// tracking problem or a minimum-peak robust MPC.
MpcProblem problemOf(const RegionMap& map, const std::string& axis);

/// AxisLaw(map, problem).
std::unique_ptr<AxisLaw> explicitAxisLaw(const RegionMap& map, MpcProblem problem);

/// AxisLaw(problem).
std::unique_ptr<AxisLaw> onlineAxisLaw(const MpcProblem& problem);

}  // namespace polyfly
