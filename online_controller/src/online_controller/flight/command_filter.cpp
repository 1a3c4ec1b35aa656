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

/// Acceleration in the world at this yaw [m/s^2].
Eigen::Vector3d accelerationOf(const AttitudeCommand& command, double yaw, const MultirotorOptions& options) {
  const Eigen::Quaterniond attitude = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(command.pitch, Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(command.roll, Eigen::Vector3d::UnitX());
  const Eigen::Vector3d gravity(0.0, 0.0, options.gravity);
  return attitude * Eigen::Vector3d::UnitZ() * (command.thrust / options.mass) - gravity;
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
    : options_(options), maps_(std::move(maps)), failsafe_(options) {
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
  const std::vector<Signal>& parameters = file.parameters();
  const std::size_t count = problem.delay > 0.0 ? 4 : 3;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const std::string name = kAxes[i];
    const bool fits = parameters.size() == count && file.inputs().size() == 1 &&
                      isSignal(parameters[0], "p_" + name, "m") &&
                      isSignal(parameters[1], "v_" + name, "m/s") &&
                      isSignal(parameters[count - 1], "a_" + name + "_wish", "m/s^2") &&
                      isSignal(file.inputs()[0], "a_" + name, "m/s^2");
    if (!fits) continue;
    if (axes_[i].map >= 0) throw Error(file.path() + ": another map has the axis " + name);
    if (problem.inputs[0].lower > 0.0 || problem.inputs[0].upper < 0.0)
      throw Error(source + ": model.inputs[0].range: must hold 0, which level flight needs");
    axes_[i].map = map;
    axes_[i].delayed = count == 4;
    axes_[i].problem = std::move(problem);
    return;
  }
  throw Error(file.path() +
              ": parameters: must be p, v, perhaps a_before, and a_wish of axis x, y or z, "
              "with the input a: p_x [m], v_x [m/s], a_x_wish [m/s^2], a_x [m/s^2]");
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

FilterAxisReport CommandFilter::filter(Axis& axis, double position, double velocity,
                                       double wish) const noexcept {
  FilterAxisReport report;
  report.position = position;
  report.velocity = velocity;
  report.wish = wish;
  report.input = wish;
  report.before = axis.before;
  if (axis.map < 0) return report;
  const RegionMap& map = maps_[static_cast<std::size_t>(axis.map)];
  const Signal& input = axis.problem.inputs[0];
  const Signal& range = axis.problem.wishes[0];
  std::array<double, 4> theta = {position, velocity, axis.before, axis.before};
  theta[axis.delayed ? 3 : 2] = std::clamp(wish, range.lower, range.upper);
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
  const AttitudeCommand taken = wished ? wish : failsafe_.level({});
  Eigen::Vector3d acceleration = accelerationOf(taken, yaw, options_);
  report_.status = wished ? FilterStatus::kPassed : FilterStatus::kNoWish;
  report_.fallback = ControlStatus::kOptimal;
  bool changed = false;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    FilterAxisReport& axis = report_.axes[i];
    axis = filter(axes_[i], state.position[at], state.velocity[at], acceleration[at]);
    report_.status = std::max(report_.status, axis.status);
    changed = changed || axis.input != acceleration[at];
    acceleration[at] = axis.input;
  }
  report_.command = changed ? commandOf(acceleration, yaw, taken.yaw_rate) : taken;
  failsafe_.answered();
  return report_;
}

const FilterReport& CommandFilter::stepWithoutState() noexcept {
  report_.status = FilterStatus::kNoState;
  report_.fallback = failsafe_.next(report_.command, {});
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    report_.axes[i] = {FilterStatus::kNoState, 0.0, 0.0, 0.0, 0.0, axes_[i].before, LookupStatus::kNotFinite};
    // What flies is not known to the axis any more: level is the best guess.
    if (report_.fallback != ControlStatus::kHoldLast) axes_[i].before = 0.0;
  }
  return report_;
}

}  // namespace polyfly
