#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "region_maps/lookup.hpp"
#include "region_maps/signal.hpp"

namespace polyfly {

class RegionMap;

/// What answers for one axis: parameters in, input out. The explicit law looks the answer up in a map, the
/// online law solves the same problem (Eq. 38).
class AxisLaw {
 public:
  virtual ~AxisLaw() = default;

  virtual const MpcProblem& problem() const noexcept = 0;
  virtual const std::vector<Signal>& parameters() const noexcept = 0;
  virtual const std::vector<Signal>& inputs() const noexcept = 0;

  /// What it is made from, for messages: `PATH: as the lateral map: `.
  virtual std::string place(const std::string& axis) const = 0;

  /// The input at theta. kOutsideBox only where answers end at the box of the parameters; a problem without
  /// solution is kOutsidePartition. Unless kInside, `input` is left alone.
  virtual Lookup evaluate(const double* theta, double* input) noexcept = 0;

  /// For a map of a tracking problem: a law that solves the same problem online, with the parameters in the
  /// same order; nullptr for others. Throws Error.
  virtual std::unique_ptr<AxisLaw> onlineEquivalent() const { return nullptr; }

  /// The stages of the problem; 0 where they cannot have references of their own.
  virtual int stages() const noexcept { return 0; }

  /// Whether stages' references come by setGradient(). Otherwise by a parameter, see AxisNames::disturbance_ahead.
  virtual bool takesGradient() const noexcept { return false; }

  /// Adds a number for each block of moves to the gradient of the next evaluate(), see StageReferences; nullptr: none from
  /// now on.
  virtual void setGradient(const double* /*gradient*/) noexcept {}

  virtual void reset() noexcept = 0;

  /// The input u of stage `stage` as the last evaluate() planned it under the steady input `reference`, for a
  /// law that plans. False otherwise.
  virtual bool planned(int /*stage*/, double /*reference*/, double* /*input*/) const noexcept {
    return false;
  }

  /// As evaluate(), of a law that keeps nothing from one parameter to the next; others leave `input` alone.
  virtual void lookUp(const double*, double*) const noexcept {}

  /// Of the last evaluate(), see ControlLaw::kktResidual.
  virtual double kktResidual() const noexcept { return -1.0; }
  virtual int iterations() const noexcept { return 0; }  ///< working sets of the last evaluate()
};

/// The problem that a map was made from. Throws Error unless the map is complete and was made from a
/// tracking problem or a minimum-peak robust MPC.
MpcProblem problemOf(const RegionMap& map, const std::string& axis);

/// Keeps a reference to `map`. `problem` is the result of problemOf(map): parsing it takes longer than everything else,
/// so who makes many laws from one map parses once.
std::unique_ptr<AxisLaw> explicitAxisLaw(const RegionMap& map, MpcProblem problem);

/// Solves `problem` at each parameter; the box of the parameters does not limit it. Throws Error.
std::unique_ptr<AxisLaw> onlineAxisLaw(const MpcProblem& problem);

}  // namespace polyfly
