#include "online_controller/flight/command_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "online_controller/types/attitude.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
// Halvings of the range of an input: its width over 2^60 is below the last bit of a double.
constexpr int kHalvings = 60;
// The vertical specific force stays at least this part of gravity, so that a tilt is always defined.
constexpr double kLeastLift = 0.1;

bool isSignal(const Signal& signal, const std::string& name, const char* unit) {
  return signal.name == name && signal.unit == unit;
}

bool allFinite(const AttitudeCommand& command) {
  return std::isfinite(command.roll) && std::isfinite(command.pitch) && std::isfinite(command.yaw_rate) &&
         std::isfinite(command.thrust);
}

bool allFinite(const VehicleState& state) {
  return state.position.allFinite() && state.velocity.allFinite() && state.attitude.coeffs().allFinite();
}

/// Acceleration in the world with this attitude and thrust [m/s^2].
Eigen::Vector3d accelerationOf(const Eigen::Quaterniond& attitude, double thrust,
                               const MultirotorOptions& options) {
  const Eigen::Vector3d gravity(0.0, 0.0, options.gravity);
  return attitude * Eigen::Vector3d::UnitZ() * (thrust / options.mass) - gravity;
}

/// Acceleration in the world at this yaw [m/s^2].
Eigen::Vector3d accelerationOf(const AttitudeCommand& command, double yaw, const MultirotorOptions& options) {
  return accelerationOf(attitudeOf({command.roll, command.pitch, yaw}), command.thrust, options);
}

}  // namespace

// The greatest violation over all rows is convex in u: halve towards the side on which it falls.
double leastViolation(const SafetyFilterProblem& problem, const double* xi) noexcept {
  const SafeSet& set = *problem.safe_set;
  const auto slopeAt = [&](double u) {
    double worst = -std::numeric_limits<double>::infinity(), slope = 0.0;
    for (Eigen::Index i = 0; i < set.G.rows(); ++i) {
      if (set.G(i, 0) == 0.0) continue;
      double violation = set.G(i, 0) * u - set.b[i], length = 0.0;
      for (Eigen::Index j = 0; j < set.M.cols(); ++j) {
        violation -= set.M(i, j) * xi[j];
        length += set.H(i, j) * set.H(i, j);
      }
      violation /= std::sqrt(length);
      if (violation <= worst) continue;
      worst = violation;
      slope = set.G(i, 0);
    }
    return slope;
  };
  double lower = problem.inputs[0].lower, upper = problem.inputs[0].upper;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (lower + upper);
    (slopeAt(middle) > 0.0 ? upper : lower) = middle;
  }
  return 0.5 * (lower + upper);
}

CommandFilter::CommandFilter(std::vector<RegionMap> maps, const MultirotorOptions& options)
    : options_(options), maps_(std::move(maps)), failsafe_(options), thrust_(options.mass * options.gravity) {
  if (maps_.empty() || maps_.size() > axes_.size())
    throw Error("safety filter: one to three maps are needed, got " + std::to_string(maps_.size()));
  for (std::size_t i = 0; i < maps_.size(); ++i) bind(static_cast<int>(i));
  checkThrust();
}

void CommandFilter::bind(int map) {
  const RegionMap& file = maps_[static_cast<std::size_t>(map)];
  const std::string source = file.path() + ": problem text";
  if (file.problemKind() != "yaml" || !isSafetyFilter(std::string(file.problemText()), source))
    throw Error(file.path() + ": problem text: must be of type safety_filter");
  if (file.solverStatus() != "complete")
    throw Error(file.path() + ": must be complete, is " + std::string(file.solverStatus()));
  SafetyFilterProblem problem = parseSafetyFilter(std::string(file.problemText()), source);
  if (!problem.safe_set) throw Error(source + ": safe_set: missing");
  if (problem.sampling_time != maps_[0].period())
    throw Error(source + ": sampling_time: all maps must have the same");
  for (std::size_t at = 0; at < axes_.size(); ++at) {
    if (bindAxis(map, at, problem)) return;
  }
  throw Error(file.path() +
              ": parameters: must be p_x [m], v_x [m/s], a_x_wish [m/s^2] with the input a_x, or p_x, "
              "v_x, a_x, a_x_cmd_wish with the input a_x_cmd, before the wish perhaps the input_before; x "
              "stands for x, y or z, with a_x as a state for x or y");
}

// Whether the map is of this axis. Then the axis has it.
bool CommandFilter::bindAxis(int map, std::size_t at, SafetyFilterProblem& problem) {
  const RegionMap& file = maps_[static_cast<std::size_t>(map)];
  const std::string name = kAxes[at];
  const bool lags = problem.stateCount() == 3 && at < 2;
  const std::string input = lags ? "a_" + name + "_cmd" : "a_" + name;
  std::vector<std::pair<std::string, const char*>> expected = {{"p_" + name, "m"}, {"v_" + name, "m/s"}};
  if (lags) expected.emplace_back("a_" + name, "m/s^2");
  if (problem.delay > 0.0) expected.emplace_back(input + "_before", "m/s^2");
  expected.emplace_back(input + "_wish", "m/s^2");
  const std::vector<Signal>& parameters = file.parameters();
  if (parameters.size() != expected.size() || file.inputs().size() != 1 ||
      !isSignal(file.inputs()[0], input, "m/s^2"))
    return false;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (!isSignal(parameters[i], expected[i].first, expected[i].second)) return false;
  }
  if (axes_[at].map >= 0) throw Error(file.path() + ": another map has the axis " + name);
  if (problem.inputs[0].lower > 0.0 || problem.inputs[0].upper < 0.0)
    throw Error(file.path() + ": problem text: model.inputs[0].range: must hold 0, which level flight needs");
  axes_[at].map = map;
  axes_[at].lags = lags;
  axes_[at].delayed = problem.delay > 0.0;
  axes_[at].problem = std::move(problem);
  return true;
}

void CommandFilter::checkThrust() const {
  double horizontal = 0.0, least = options_.gravity, greatest = options_.gravity;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (axes_[i].map < 0) continue;
    const Signal& input = axes_[i].problem.inputs[0];
    const double size = std::max(-input.lower, input.upper);
    if (i < 2) {
      horizontal += size * size;
    } else {
      least += input.lower;
      greatest += input.upper;
    }
  }
  greatest = std::sqrt(greatest * greatest + horizontal);
  if (least < options_.thrust_min || greatest > options_.thrust_max) {
    throw Error("safety filter: the ranges of the inputs need a thrust of " + std::to_string(least) + " to " +
                std::to_string(greatest) + " m/s^2, controller/thrust_min and thrust_max allow " +
                std::to_string(options_.thrust_min) + " to " + std::to_string(options_.thrust_max));
  }
}

FilterAxisReport CommandFilter::filter(Axis& axis, const std::array<double, 3>& state,
                                       double wish) const noexcept {
  FilterAxisReport report;
  report.xi = {state[0], state[1]};
  report.wish = wish;
  report.input = wish;
  if (axis.map < 0) return report;
  const RegionMap& map = maps_[static_cast<std::size_t>(axis.map)];
  const Signal& input = axis.problem.inputs[0];
  const Signal& range = axis.problem.wishes[0];
  std::size_t size = 2;
  if (axis.lags) report.xi[size++] = state[2];
  if (axis.delayed) report.xi[size++] = axis.before;
  std::array<double, 5> theta{};
  std::copy(report.xi.begin(), report.xi.end(), theta.begin());
  theta[size] = std::clamp(wish, range.lower, range.upper);
  double u = 0.0;
  report.lookup = map.evaluate(theta.data(), &u).status;
  if (report.lookup == LookupStatus::kInside) {
    report.input = std::clamp(u, input.lower, input.upper);
    report.status = report.input == wish ? FilterStatus::kPassed : FilterStatus::kChanged;
  } else {
    report.input = leastViolation(axis.problem, theta.data());
    report.status = FilterStatus::kOutside;
  }
  axis.before = report.input;
  return report;
}

AttitudeCommand CommandFilter::commandOf(const Eigen::Vector3d& acceleration, double yaw,
                                         double yaw_rate) const noexcept {
  Eigen::Vector3d force = acceleration;
  force.z() = std::max(force.z() + options_.gravity, kLeastLift * options_.gravity);
  const Eigen::Vector3d heading = Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitZ()) * force;
  const double size = heading.norm();
  AttitudeCommand command;
  command.pitch = std::atan2(heading.x(), heading.z());
  command.roll = std::asin(std::clamp(-heading.y() / size, -1.0, 1.0));
  command.yaw_rate = yaw_rate;
  command.thrust = options_.mass * size;
  return command;
}

const FilterReport& CommandFilter::step(const VehicleState& state, const AttitudeCommand& wish) noexcept {
  if (!allFinite(state)) return stepWithoutState();
  const bool wished = allFinite(wish);
  const double yaw = eulerAngles(state.attitude).yaw;
  const AttitudeCommand taken = wished ? wish : levelCommand(options_, {});
  Eigen::Vector3d acceleration = accelerationOf(taken, yaw, options_);
  const Eigen::Vector3d measured = accelerationOf(state.attitude, thrust_, options_);
  report_.status = wished ? FilterStatus::kPassed : FilterStatus::kNoWish;
  report_.fallback = ControlStatus::kOptimal;
  bool changed = false;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    FilterAxisReport& axis = report_.axes[i];
    axis = filter(axes_[i], {state.position[at], state.velocity[at], measured[at]}, acceleration[at]);
    report_.status = std::max(report_.status, axis.status);
    changed = changed || axis.input != acceleration[at];
    acceleration[at] = axis.input;
  }
  report_.command = changed ? commandOf(acceleration, yaw, taken.yaw_rate) : taken;
  thrust_ = report_.command.thrust;
  failsafe_.answered();
  return report_;
}

const FilterReport& CommandFilter::stepWithoutState() noexcept {
  report_.status = FilterStatus::kNoState;
  report_.fallback = failsafe_.next(report_.command, {});
  thrust_ = report_.command.thrust;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    report_.axes[i] = {FilterStatus::kNoState, {}, 0.0, 0.0, LookupStatus::kNotFinite};
    // What flies is not known to the axis any more: level is the best guess.
    if (report_.fallback != ControlStatus::kHoldLast) axes_[i].before = 0.0;
  }
  return report_;
}

}  // namespace polyfly
