#include "online_controller/laws/axis_law.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mpc_core/online_program.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

std::string mapPlace(const RegionMap& map, const std::string& axis) {
  return map.path() + ": as the " + axis + " map: ";
}

class ExplicitAxisLaw final : public AxisLaw {
 public:
  ExplicitAxisLaw(const RegionMap& map, MpcProblem problem) : map_(&map), problem_(std::move(problem)) {}

  const MpcProblem& problem() const noexcept override { return problem_; }
  const std::vector<Signal>& parameters() const noexcept override { return map_->parameters(); }
  const std::vector<Signal>& inputs() const noexcept override { return map_->inputs(); }
  std::string place(const std::string& axis) const override { return mapPlace(*map_, axis); }
  Lookup evaluate(const double* theta, double* input) noexcept override {
    return map_->evaluate(theta, input);
  }
  void lookUp(const double* theta, double* input) const noexcept override { map_->evaluate(theta, input); }
  std::unique_ptr<AxisLaw> onlineEquivalent() const override;
  int stages() const noexcept override { return problem_.minimum_peak ? 0 : problem_.horizon; }
  void reset() noexcept override {}

 private:
  const RegionMap* map_;  // not owned
  MpcProblem problem_;
};

class OnlineAxisLaw final : public AxisLaw {
 public:
  explicit OnlineAxisLaw(const MpcProblem& problem) : problem_(problem), program_(condense(problem, &plan_)) {
    planned_ = plan_.constant;
    const std::vector<int> blocks = blockLengths(problem);
    for (std::size_t block = 0; block < blocks.size(); ++block)
      block_of_stage_.insert(block_of_stage_.end(), static_cast<std::size_t>(blocks[block]),
                             static_cast<int>(block));
  }

  const MpcProblem& problem() const noexcept override { return problem_; }
  const std::vector<Signal>& parameters() const noexcept override { return program_.program().parameters; }
  const std::vector<Signal>& inputs() const noexcept override { return program_.program().inputs; }
  std::string place(const std::string& axis) const override {
    return problem_.source + ": as the " + axis + " problem: ";
  }

  Lookup evaluate(const double* theta, double* input) noexcept override {
    Lookup lookup;
    switch (program_.solve(theta, input, gradient_)) {
      case QpStatus::kOptimal:
        lookup.status = LookupStatus::kInside;
        setPlanned(theta);
        break;
      case QpStatus::kNotFinite:
        lookup.status = LookupStatus::kNotFinite;
        break;
      case QpStatus::kInfeasible:
      case QpStatus::kIterationLimit:
      case QpStatus::kNotConvex:
        lookup.status = LookupStatus::kOutsidePartition;
        break;
    }
    return lookup;
  }
  int stages() const noexcept override {
    return program_.solver().variableCount() == static_cast<int>(blockLengths(problem_).size())
               ? problem_.horizon
               : 0;
  }
  bool takesGradient() const noexcept override { return plan_.isOfInputs(); }
  void setGradient(const double* gradient) noexcept override { gradient_ = gradient; }
  void reset() noexcept override { program_.reset(); }
  bool planned(int stage, double input_reference, double* input) const noexcept override {
    if (problem_.inputCount() != 1) return false;
    const auto last = static_cast<int>(block_of_stage_.size()) - 1;
    *input = input_reference + planned_(block_of_stage_[static_cast<std::size_t>(std::min(stage, last))]);
    return true;
  }
  double kktResidual() const noexcept override { return program_.solver().kktResidual(); }
  int iterations() const noexcept override { return program_.solver().iterations(); }

 private:
  void setPlanned(const double* theta) noexcept {
    planned_ = plan_.constant;
    planned_.noalias() += plan_.on_z * Eigen::Map<const Eigen::VectorXd>(program_.z(), planned_.size());
    planned_.noalias() += plan_.on_theta * Eigen::Map<const Eigen::VectorXd>(theta, plan_.on_theta.cols());
  }

  MpcProblem problem_;
  InputPlan plan_;
  OnlineProgram program_;
  const double* gradient_ = nullptr;  // not owned
  // u~ of the blocks.
  Eigen::VectorXd planned_;
  std::vector<int> block_of_stage_;
};

/// `problem` with its parameters in the order of `signals`.
MpcProblem inOrder(MpcProblem problem, const std::vector<Signal>& signals) {
  std::vector<MpcProblem::Parameter> ordered;
  for (const Signal& signal : signals) {
    const auto found =
        std::find_if(problem.parameters.begin(), problem.parameters.end(),
                     [&](const MpcProblem::Parameter& p) { return p.signal.name == signal.name; });
    if (found == problem.parameters.end()) {
      throw Error(problem.source + ": parameter '" + signal.name + "': of the map, but not of its problem");
    }
    ordered.push_back(*found);
  }
  problem.parameters = std::move(ordered);
  return problem;
}

}  // namespace

std::unique_ptr<AxisLaw> ExplicitAxisLaw::onlineEquivalent() const {
  if (problem_.minimum_peak) return nullptr;
  return onlineAxisLaw(inOrder(problem_, parameters()));
}

MpcProblem problemOf(const RegionMap& map, const std::string& axis) {
  if (map.solverStatus() != "complete") {
    throw Error(mapPlace(map, axis) + "solver status: must be 'complete', got '" +
                std::string(map.solverStatus()) + "'");
  }
  if (map.problemKind() != "yaml") {
    throw Error(mapPlace(map, axis) + "problem: must be a tracking problem (yaml), got '" +
                std::string(map.problemKind()) + "'");
  }
  return parseFlightModel(std::string(map.problemText()), map.path() + ": problem");
}

std::unique_ptr<AxisLaw> explicitAxisLaw(const RegionMap& map, MpcProblem problem) {
  return std::make_unique<ExplicitAxisLaw>(map, std::move(problem));
}

std::unique_ptr<AxisLaw> onlineAxisLaw(const MpcProblem& problem) {
  return std::make_unique<OnlineAxisLaw>(problem);
}

}  // namespace polyfly
