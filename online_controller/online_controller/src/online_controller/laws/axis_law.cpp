#include "online_controller/laws/axis_law.hpp"

#include <algorithm>

#include "mpc_core/read_problem.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

std::string mapPlace(const RegionMap& map, const std::string& axis) {
  return map.path() + ": as the " + axis + " map: ";
}

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

AxisLaw::Online::Online(const MpcProblem& problem) : program(condense(problem, &plan)) {
  planned = plan.constant;
  const std::vector<int> blocks = blockLengths(problem);
  for (std::size_t block = 0; block < blocks.size(); ++block)
    block_of_stage.insert(block_of_stage.end(), static_cast<std::size_t>(blocks[block]),
                          static_cast<int>(block));
}

AxisLaw::AxisLaw(MpcProblem problem) : problem_(std::move(problem)), online_(problem_), solved_(true) {}

void AxisLaw::solveOutside() {
  if (map_ != nullptr && !problem_.minimum_peak) online_.emplace(inOrder(problem_, parameters()));
}

const std::vector<Signal>& AxisLaw::parameters() const noexcept {
  return map_ != nullptr ? map_->parameters() : online_->program.program().parameters;
}

const std::vector<Signal>& AxisLaw::inputs() const noexcept {
  return map_ != nullptr ? map_->inputs() : online_->program.program().inputs;
}

std::string AxisLaw::place(const std::string& axis) const {
  return map_ != nullptr ? mapPlace(*map_, axis) : problem_.source + ": as the " + axis + " problem: ";
}

Lookup AxisLaw::evaluate(const double* theta, double* input) noexcept {
  if (map_ == nullptr) return solve(theta, input);
  solved_ = false;
  iterations_ = 0;
  return map_->evaluate(theta, input);
}

Lookup AxisLaw::solve(const double* theta, double* input) noexcept {
  Lookup lookup;
  switch (online_->program.solve(theta, input, gradient_)) {
    case QpStatus::kOptimal:
      lookup.status = LookupStatus::kInside;
      online_->planned = online_->plan.constant;
      online_->planned.noalias() += online_->plan.on_z * Eigen::Map<const Eigen::VectorXd>(
                                                             online_->program.z(), online_->planned.size());
      online_->planned.noalias() +=
          online_->plan.on_theta * Eigen::Map<const Eigen::VectorXd>(theta, online_->plan.on_theta.cols());
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
  iterations_ = online_->program.solver().iterations();
  solved_ = map_ == nullptr || lookup.status == LookupStatus::kInside;
  return lookup;
}

int AxisLaw::stages() const noexcept {
  const bool has_stages = map_ != nullptr ? !problem_.minimum_peak
                                          : online_->program.solver().variableCount() ==
                                                static_cast<int>(blockLengths(problem_).size());
  return has_stages ? problem_.horizon : 0;
}

void AxisLaw::reset() noexcept {
  solved_ = map_ == nullptr;
  if (online_) online_->program.reset();
}

bool AxisLaw::planned(int stage, double input_reference, double* input) const noexcept {
  if (!online_ || problem_.inputCount() != 1) return false;
  const auto last = static_cast<int>(online_->block_of_stage.size()) - 1;
  const int block = online_->block_of_stage[static_cast<std::size_t>(std::min(stage, last))];
  *input = input_reference + online_->planned(block);
  return true;
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
  return std::make_unique<AxisLaw>(map, std::move(problem));
}

std::unique_ptr<AxisLaw> onlineAxisLaw(const MpcProblem& problem) {
  return std::make_unique<AxisLaw>(problem);
}

}  // namespace polyfly
