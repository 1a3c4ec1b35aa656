// How an axis is made: the signals and the model that its problem has.
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "mpc_core/parametric_program.hpp"
#include "online_controller/estimation/force_observer.hpp"
#include "online_controller/laws/axis.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

std::string quoted(const std::string& text) { return "'" + text + "'"; }

void requireUnit(const AxisLaw& law, const AxisNames& names, const Signal& signal, const std::string& unit) {
  if (signal.unit == unit) return;
  throw Error(law.place(names.axis) + "signal " + quoted(signal.name) + ": unit must be " + quoted(unit) +
              ", got " + quoted(signal.unit));
}

// Greatest error of a rate that is computed from a discrete model.
constexpr double kRateTolerance = 1e-9;
// Lag behind the observer of a constant disturbance that is only told of [s].
constexpr double kToldConstantTime = 5.0;

/// The parameter of the problem with this name and the role state_reference; nullptr: none.
const MpcProblem::Parameter* stateReference(const MpcProblem& problem, const char* name) {
  if (name == nullptr) return nullptr;
  for (const MpcProblem::Parameter& parameter : problem.parameters)
    if (parameter.role == ParameterRole::kStateReference && parameter.signal.name == name) return &parameter;
  return nullptr;
}

/// Signals with the names of references must be those of these states: position, velocity, angle.
void requireReferences(const AxisLaw& law, const AxisNames& names, const std::array<int, 3>& states) {
  const std::array<const char*, 3> signals{names.position_reference, names.velocity_reference,
                                           names.angle_reference};
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const MpcProblem::Parameter* parameter = stateReference(law.problem(), signals[i]);
    if (parameter == nullptr || parameter->index == states[i]) continue;
    throw Error(law.place(names.axis) + "parameter " + quoted(signals[i]) +
                ": must be the reference of the state that its name says");
  }
}

/// Whether a parameter is the disturbance ahead, which must be that of the model, of a problem that can look ahead.
bool looksAhead(const AxisLaw& law, const AxisNames& names) {
  for (const MpcProblem::Parameter& parameter : law.problem().parameters) {
    if (parameter.signal.name != names.disturbance_ahead) continue;
    const std::string place = law.place(names.axis) + "parameter " + quoted(names.disturbance_ahead) + ": ";
    if (parameter.role != ParameterRole::kDisturbance) throw Error(place + "must have the role disturbance");
    if (!StageReferences::supports(law.problem()))
      throw Error(place +
                  "needs a continuous model without bounds on states, constraints, terminal set or equality");
    return true;
  }
  return false;
}

/// The tilt of an axis keeps the noise of its own; the other states have that of the options, in the places
/// that the errors' parameters name. What does not fit is refused by readModel().
ObserverOptions observerOptions(const MpcProblem& problem, const AxisNames& names,
                                const MultirotorOptions& options) {
  ObserverOptions result;
  result.period = options.control_period;
  result.disturbance = options.disturbance_drift;
  if (!problem.minimum_peak) result.rate = options.disturbance_rate_drift;
  for (const MpcProblem::Parameter& parameter : problem.parameters) {
    const bool position = parameter.signal.name == names.position_error;
    const bool is_state = parameter.role == ParameterRole::kError && parameter.index >= 0 &&
                          parameter.index < static_cast<int>(result.process.size());
    if (!is_state || (!position && parameter.signal.name != names.velocity_error)) continue;
    const auto state = static_cast<std::size_t>(parameter.index);
    result.process[state] = std::sqrt(position ? options.noise.q_position : options.noise.q_velocity);
    result.measurement[state] = std::sqrt(position ? options.noise.r_position : options.noise.r_velocity);
  }
  return result;
}

}  // namespace

Axis::Axis(const RegionMap& map, const AxisNames& names, const MultirotorOptions& options)
    : Axis(explicitAxisLaw(map, problemOf(map, names.axis)), names, options) {}

Axis::Axis(std::unique_ptr<AxisLaw> law, const AxisNames& names, const MultirotorOptions& options)
    : law_(std::move(law)),
      has_lag_(names.angle_error != nullptr),
      offset_free_(options.offset_free && !law_->problem().minimum_peak),
      observer_(law_->problem(), observerOptions(law_->problem(), names, options)) {
  bindSignals(names);
  if (law_->problem().minimum_peak) {
    removes_constant_ = options.robust_estimate_time > 0.0;
    if (removes_constant_ && !has_input_reference_)
      throw Error(law_->place(names.axis) + "parameter " + quoted(names.input_reference) +
                  ": missing, and controller/robust_estimate_time needs it");
    const double lag = removes_constant_ ? options.robust_estimate_time : kToldConstantTime;
    constant_share_ = 1.0 - std::exp(-options.control_period / lag);
  }
  readModel(law_->problem(), names);
  // The rotors' drag acts in their plane. Over B_d it is a disturbance.
  if (has_lag_ && offset_free_ && options.adapt_model)
    drag_.emplace(law_->problem(), observerOptions(law_->problem(), names, options), velocity_state_,
                  kDragDeviation / std::abs(disturbance_gain_));
  if (options.solve_outside) law_->solveOutside();
  if (options.look_ahead) prepareLookAhead(names);
}

void Axis::prepareLookAhead(const AxisNames& names) {
  const MpcProblem& problem = law_->problem();
  const bool can = !has_rate_ && (law_->takesGradient() || ahead_slot_ >= 0);
  if (!can || law_->stages() == 0 || !StageReferences::supports(problem)) return;
  StageReferences::Targets targets =
      StageReferences::Targets::Zero(problem.stateCount() + 1, kReferenceDerivatives);
  targets(position_state_, 0) = 1.0;
  targets(velocity_state_, 1) = 1.0;
  const std::array<AxisTarget, 3> by_derivative{target({0.0, 1.0, 0.0, 0.0, 0.0}, 0.0, 0.0),
                                                target({0.0, 0.0, 1.0, 0.0, 0.0}, 0.0, 0.0),
                                                target({0.0, 0.0, 0.0, 1.0, 0.0}, 0.0, 0.0)};
  for (std::size_t i = 0; i < by_derivative.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i) + 1;
    if (has_lag_) targets(angle_state_, column) = by_derivative[i].angle;
    targets(problem.stateCount(), column) = by_derivative[i].input;
  }
  stage_references_.emplace(problem, targets);
  if (law_->takesGradient()) return;
  InputPlan plan;
  const ParametricProgram program = condense(problem, &plan);
  if (!plan.isOfInputs())
    throw Error(
        law_->place(names.axis) + "parameter " + quoted(names.disturbance_ahead) +
        ": needs a lesser terminal weight or a shorter horizon, so that the variables are the inputs");
  const Eigen::LLT<Eigen::MatrixXd> factor(program.H);
  const auto ahead = std::find_if(program.parameters.begin(), program.parameters.end(),
                                  [&](const Signal& p) { return p.name == names.disturbance_ahead; });
  // Without active bounds the first input is that of -H^-1 times the gradient.
  const Eigen::RowVectorXd first =
      factor.solve(Eigen::VectorXd::Unit(program.variableCount(), 0)).transpose();
  const double by_disturbance = first.dot(program.F.col(ahead - program.parameters.begin()));
  if (!(std::abs(by_disturbance) > 0.0))
    throw Error(law_->place(names.axis) + "parameter " + quoted(names.disturbance_ahead) +
                ": must act on the input");
  ahead_row_ = stage_references_->gradientRow(first / by_disturbance);
}

void Axis::bindSignals(const AxisNames& names) {
  struct ExpectedSignal {
    const char* name;
    const char* unit;
    AxisEntry entry;
    bool required;
  };
  const bool tracking = !law_->problem().minimum_peak;
  std::vector<ExpectedSignal> expected{
      {names.position_error, "m", AxisEntry::kPositionError, true},
      {names.velocity_error, "m/s", AxisEntry::kVelocityError, true},
      {names.input_reference, names.input_unit, AxisEntry::kInputReference, tracking}};
  if (tracking) expected.push_back({names.previous_input, names.input_unit, AxisEntry::kPreviousInput, true});
  if (!tracking) expected.push_back({names.velocity_reference, "m/s", AxisEntry::kVelocityReference, false});
  // Problems that bound states themselves.
  const std::array<ExpectedSignal, 3> references{
      {{names.position_reference, "m", AxisEntry::kPositionReference, true},
       {names.velocity_reference, "m/s", AxisEntry::kVelocityReference, true},
       {names.angle_reference, "rad", AxisEntry::kAngleReference, true}}};
  for (const ExpectedSignal& reference : references)
    if (stateReference(law_->problem(), reference.name) != nullptr) expected.push_back(reference);
  if (has_lag_) expected.push_back({names.angle_error, "rad", AxisEntry::kAngleError, true});
  has_rate_ =
      has_lag_ && std::any_of(law_->parameters().begin(), law_->parameters().end(),
                              [&](const Signal& signal) { return signal.name == names.angle_rate_error; });
  if (has_rate_) expected.push_back({names.angle_rate_error, "rad/s", AxisEntry::kAngleRateError, true});
  if (looksAhead(*law_, names))
    expected.push_back({names.disturbance_ahead, "m/s^2", AxisEntry::kDisturbanceAhead, true});
  static_assert(kMaxParameters >= 10, "an axis has up to ten parameters");

  std::vector<bool> found(expected.size(), false);
  size_ = 0;
  for (const Signal& signal : law_->parameters()) {
    const auto match = std::find_if(expected.begin(), expected.end(),
                                    [&](const ExpectedSignal& entry) { return signal.name == entry.name; });
    if (match == expected.end()) {
      throw Error(law_->place(names.axis) + "parameter " + quoted(signal.name) +
                  ": not a signal of this axis");
    }
    const auto which = static_cast<std::size_t>(match - expected.begin());
    if (found[which])
      throw Error(law_->place(names.axis) + "parameter " + quoted(signal.name) + ": listed twice");
    found[which] = true;
    requireUnit(*law_, names, signal, match->unit);
    has_input_reference_ = has_input_reference_ || match->entry == AxisEntry::kInputReference;
    const auto slot = static_cast<std::size_t>(size_++);
    entries_[slot] = match->entry;
    if (match->entry == AxisEntry::kDisturbanceAhead) ahead_slot_ = static_cast<int>(slot);
    lower_[slot] = signal.lower;
    upper_[slot] = signal.upper;
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (!found[i] && expected[i].required)
      throw Error(law_->place(names.axis) + "parameter " + quoted(expected[i].name) + ": missing");
  }

  if (law_->inputs().size() != 1 || law_->inputs().front().name != names.input) {
    std::string got;
    for (const Signal& signal : law_->inputs()) got += (got.empty() ? "" : ", ") + quoted(signal.name);
    throw Error(law_->place(names.axis) + "inputs: must be " + quoted(names.input) + " alone, got " + got);
  }
  const Signal& input = law_->inputs().front();
  requireUnit(*law_, names, input, names.input_unit);
  input_lower_ = input.lower;
  input_upper_ = input.upper;
}

// The angle follows the input, and nothing else.
bool Axis::isLag(const MpcProblem& problem) const noexcept {
  const auto& A = problem.A_c;
  const int p = position_state_, v = velocity_state_, s = angle_state_, last = has_rate_ ? rate_state_ : s;
  if (A(last, p) != 0.0 || A(last, v) != 0.0 || problem.Bd_c(last, 0) != 0.0 || problem.B_c(last, 0) == 0.0 ||
      !(A(last, s) < 0.0))
    return false;
  if (!has_rate_) return true;
  return A(s, p) == 0.0 && A(s, v) == 0.0 && A(s, s) == 0.0 && A(s, last) == 1.0 && A(p, last) == 0.0 &&
         A(v, last) == 0.0 && A(last, last) < 0.0 && problem.Bd_c(s, 0) == 0.0 && problem.B_c(s, 0) == 0.0;
}

void Axis::readModel(const MpcProblem& given, const AxisNames& names) {
  const MpcProblem problem = continuousModel(given);
  const int states = 2 + (has_lag_ ? 1 : 0) + (has_rate_ ? 1 : 0);
  const auto require = [&](bool holds, const std::string& rule) {
    if (!holds) throw Error(law_->place(names.axis) + "model: " + rule);
  };
  require(problem.stateCount() == states && problem.inputCount() == 1 && problem.Bd_c.cols() == 1,
          "must have " + std::to_string(states) + " states, one input and one disturbance");

  // Which state an error parameter belongs to is written in the problem, not in an order of names.
  const auto state_of = [&](const char* name) {
    for (const MpcProblem::Parameter& parameter : problem.parameters) {
      if (parameter.signal.name == name && parameter.role == ParameterRole::kError) return parameter.index;
    }
    throw Error(law_->place(names.axis) + "parameter " + quoted(name) + ": must be the error of a state");
  };
  const int p = state_of(names.position_error);
  const int v = state_of(names.velocity_error);
  const int s = has_lag_ ? state_of(names.angle_error) : v;
  const int r = has_rate_ ? state_of(names.angle_rate_error) : s;
  requireReferences(*law_, names, {p, v, s});
  position_state_ = p;
  velocity_state_ = v;
  angle_state_ = s;
  rate_state_ = r;
  const auto& A = problem.A_c;
  const auto& B = problem.B_c;
  const auto& Bd = problem.Bd_c;
  require(p != v && (!has_lag_ || (s != p && s != v)) && (!has_rate_ || (r != p && r != v && r != s)),
          "each error parameter must belong to a state of its own");
  // A logarithm leaves rounding beside the 1.
  const double tolerance = given.discrete ? kRateTolerance : 0.0;
  require(std::abs(A(p, v) - 1.0) <= tolerance && A(p, p) == 0.0 && (!has_lag_ || A(p, s) == 0.0) &&
              B(p, 0) == 0.0 && Bd(p, 0) == 0.0,
          "the derivative of the position must be the velocity");
  require(A(v, p) == 0.0 && Bd(v, 0) != 0.0 && std::isfinite(1.0 / Bd(v, 0)),
          "the disturbance must act on the velocity, the position must not");
  if (has_lag_) {
    require(B(v, 0) == 0.0 && A(v, s) != 0.0, "the velocity must be driven by the angle, not by the input");
    require(isLag(problem),
            "the angle must follow the input with a stable first-order lag, or second-order where " +
                quoted(names.angle_rate_error) + " is a parameter");
  } else {
    require(B(v, 0) != 0.0, "the velocity must be driven by the input");
  }

  const DiscreteModel stage = discretise(problem, problem.sampling_time);
  stage_period_ = stage.period;
  for (int i = 0; i < states; ++i) {
    stage_disturbance_[static_cast<std::size_t>(i)] = stage.Bd(i, 0);
    stage_input_[static_cast<std::size_t>(i)] = stage.B(i, 0);
    for (int j = 0; j < states; ++j)
      stage_[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = stage.A(i, j);
  }

  velocity_gain_ = A(v, v);
  disturbance_gain_ = Bd(v, 0);
  drive_gain_ = has_lag_ ? A(v, s) : B(v, 0);
  lag_pole_ = has_lag_ ? A(r, s) : 0.0;
  lag_damping_ = has_rate_ ? A(r, r) : 0.0;
  lag_gain_ = has_lag_ ? B(r, 0) : 0.0;
}

}  // namespace polyfly
