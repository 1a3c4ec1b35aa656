#include "online_controller/laws/nonlinear_controller.hpp"

#include <algorithm>
#include <cmath>

#include "online_controller/reference/yaw_rate.hpp"
#include "online_controller/types/attitude.hpp"
#include "online_controller/types/valid.hpp"

namespace polyfly {
namespace {

// Number of iterations from a cold start.
constexpr int kFirstIterations = 4;
// A state this far from the predicted one is none that the last solution can be continued to.
constexpr double kFarPosition = 1.0;   // [m]
constexpr double kFarVelocity = 2.0;   // [m/s]
constexpr double kFarTilt = 0.5;       // [rad]
constexpr double kLeastSupport = 1.0;  // least vertical specific force of a reference [m/s^2]

const MultirotorOptions& checked(const MultirotorOptions& options) {
  checkOptions(options);
  return options;
}

/// The options of the vehicle, with the limits of the chapter's listing where they are wished.
MultirotorOptions limited(MultirotorOptions options, const NonlinearMpcOptions& mpc) {
  if (!mpc.chapter_limits) return options;
  constexpr double kChapterAngle = 0.25 * M_PI;  // [rad]
  options.angle_max = kChapterAngle;
  options.thrust_min = 0.5 * options.gravity;
  options.thrust_max = 1.5 * options.gravity;
  return options;
}

// Time of an attitude loop with its dead time up to which the weights are taken as given [s].
constexpr double kGivenWeightsTime = 0.265;

/// What the weight of a command is multiplied by. Over a slower loop the feedback by the given weights would swing.
double slowness(double loop_time, double delay) noexcept {
  return std::max(1.0, (loop_time + delay) / kGivenWeightsTime);
}

NonlinearMpcOptions completed(const NonlinearMpcOptions& mpc, const MultirotorOptions& options) {
  NonlinearMpcOptions result = mpc;
  result.roll_command_weight *= slowness(mpc.model.roll_time, options.delay);
  result.pitch_command_weight *= slowness(mpc.model.pitch_time, options.delay);
  result.model.gravity = options.gravity;
  result.angle_max = options.angle_max;
  result.thrust_min = options.thrust_min;
  result.thrust_max = options.thrust_max;
  return result;
}

VehicleModel vehicleOf(const NonlinearMpcOptions& mpc) {
  VehicleModel vehicle;
  vehicle.motion = mpc.model;
  return vehicle;
}

MultirotorState stateOf(const VehicleState& vehicle, const EulerAngles& angles) noexcept {
  MultirotorState x;
  x << vehicle.position, vehicle.velocity, angles.roll, angles.pitch;
  return x;
}

/// What of an angle is left after `period`.
TiltAngles decayOf(const MultirotorModel& model, double period) noexcept {
  return {std::exp(-period / model.roll_time), std::exp(-period / model.pitch_time)};
}

/// How much further than half way from one angle to the next a first-order lag is on the mean over a stage.
double aheadOfHalf(double time, double period) noexcept {
  const double risen = 1.0 - std::exp(-period / time);
  return 1.0 / risen - time / period - 0.5;
}

/// The command that moves a first-order lag from one angle to the next while it decays so far.
double leadingCommand(double from, double to, double gain, double decay) noexcept {
  return (to - decay * from) / (gain * (1.0 - decay));
}

}  // namespace

NonlinearController::NonlinearController(const MultirotorOptions& options, const NonlinearMpcOptions& mpc)
    : EstimatingLaw({mpc.horizon + 1, mpc.period, mpc.period}, vehicleOf(mpc), checked(limited(options, mpc)),
                    {mpc.model.roll_gain, mpc.model.roll_time, mpc.model.pitch_gain, mpc.model.pitch_time},
                    options),
      mpc_(completed(mpc, options_)),
      observer_(mpc_.options().model, options, options.disturbance_rate_drift,
                options.adapt_model && options.offset_free),
      period_decay_(decayOf(mpc_.options().model, options.control_period)),
      stage_decay_(decayOf(mpc_.options().model, mpc_.options().period)) {
  const auto points = static_cast<std::size_t>(mpc_.horizon() + 1);
  stages_.resize(points);
  references_.resize(points);
  preview_.resize(points);
  const NonlinearMpcOptions& chosen = mpc_.options();
  ahead_ = {aheadOfHalf(chosen.model.roll_time, chosen.period),
            aheadOfHalf(chosen.model.pitch_time, chosen.period)};
  forgetAll();
}

void NonlinearController::resetObservers() noexcept {
  observer_.reset();
  iterating_ = false;
}

const ControlReport& NonlinearController::step(const VehicleState& state, const Reference* preview) noexcept {
  if (std::isfinite(state.stamp)) report_.stamp = state.stamp;
  if (!isValid(state)) return withoutAnswer(ControlReason::kNotFinite);
  const EulerAngles angles = eulerAngles(state.attitude.normalized());
  const int periods = observe(state, angles);
  if (!std::all_of(preview, preview + previewLength(), [](const Reference& r) { return isValid(r); })) {
    return withoutAnswer(ControlReason::kNotFinite);
  }
  integrator_.update(state, *preview, report_);
  std::copy_n(preview, preview_.size(), preview_.begin());
  yaw_ = angles.yaw;
  predictYaw(yaw_, preview);
  makeReferences(preview);
  if (!solve(stateOf(state, angles), periods)) {
    iterating_ = false;
    return withoutAnswer(ControlReason::kOutsidePartition);
  }
  send(angles, *preview);
  watchSwings(*preview, yaw_, options_.angle_max);
  return report_;
}

// Number of control periods since the last sample, at most kMaxPeriods + 1.
int NonlinearController::observe(const VehicleState& state, const EulerAngles& angles) noexcept {
  const int periods = beginSample(state.stamp);
  if (periods == 0) return 0;
  const FlownReference is_flown = flown(followed_, {angles.roll, angles.pitch}, state.velocity);
  observer_.update(state, report_.command.thrust / options_.mass, periods, is_flown.velocity);
  observeTrim({angles.roll, angles.pitch}, periods, is_flown);
  const Eigen::Vector3d drag = observer_.drag();
  report_.found_drag = {drag.x(), drag.y()};
  return periods;
}

void NonlinearController::predictYaw(double yaw, const Reference* preview) noexcept {
  const Eigen::Vector3d estimated = options_.offset_free ? observer_.disturbance() : Eigen::Vector3d::Zero();
  disturbance_ = estimated + integrator_.disturbance();
  disturbance_rate_ = options_.offset_free ? observer_.disturbanceRate() : Eigen::Vector3d::Zero();
  drag_ = options_.offset_free ? observer_.drag() : Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < stages_.size(); ++k) {
    const double rate = yawRate(options_, preview[k], yaw);
    stages_[k] = {yaw, rate, disturbanceAt(preview[k])};
    yaw += mpc_.options().period * rate;
  }
}

// With the drag that was found, at the reference's velocity.
Eigen::Vector3d NonlinearController::disturbanceAt(const Reference& reference) const noexcept {
  return disturbance_ - drag_.cwiseProduct(reference.velocity);
}

// Attitude and lift from the specific force that the path needs (the model is flat).
StageReference NonlinearController::onPath(const Reference& path, double yaw,
                                           const Eigen::Vector3d& disturbance) const noexcept {
  const MultirotorModel& model = mpc_.options().model;
  const double sine = std::sin(yaw), cosine = std::cos(yaw);
  const auto heading = [&](const Eigen::Vector3d& world) {
    return Eigen::Vector3d(cosine * world.x() + sine * world.y(), cosine * world.y() - sine * world.x(),
                           world.z());
  };
  Eigen::Vector3d force =
      heading(path.acceleration - disturbance) + model.drag.cwiseProduct(heading(path.velocity));
  force.z() = std::max(force.z() + model.gravity, kLeastSupport);
  StageReference reference;
  reference.position = path.position;
  reference.velocity = path.velocity;
  reference.roll = -std::asin(force.y() / force.norm());
  reference.pitch = std::atan2(force.x(), force.z());
  reference.lift = force.z();
  return reference;
}

// At the path's points of now and of a control period later. The drag that was found is none of the disturbance.
FollowedTilt NonlinearController::undisturbedTilt(const Reference& now,
                                                  const Reference& next) const noexcept {
  const double period = options_.control_period;
  const StageReference from = onPath(now, yaw_, -drag_.cwiseProduct(now.velocity));
  const StageReference to =
      onPath(next, yaw_ + period * stages_.front().yaw_rate, -drag_.cwiseProduct(next.velocity));
  return {{from.roll, from.pitch}, {(to.roll - from.roll) / period, (to.pitch - from.pitch) / period}};
}

// The commands that lead the attitude from one reference through the next one.
void NonlinearController::lead(StageReference& from, const StageReference& to,
                               const TiltAngles& decay) const noexcept {
  const MultirotorModel& model = mpc_.options().model;
  from.roll_command = leadingCommand(from.roll, to.roll, model.roll_gain, decay.roll);
  from.pitch_command = leadingCommand(from.pitch, to.pitch, model.pitch_gain, decay.pitch);
}

void NonlinearController::makeReferences(const Reference* preview) noexcept {
  for (std::size_t k = 0; k < references_.size(); ++k)
    references_[k] = onPath(preview[k], stages_[k].yaw, disturbanceAt(preview[k]));
  // All stages have the disturbance of now: over the horizon the noise of its rate would grow. The command that is sent
  // leads by it. A stage's command is right for all of its time; what is sent is held for one control period only. At the
  // middle of a stage a command that changes would lead by the difference.
  Reference soon = *preview;
  const double period = options_.control_period;
  soon.velocity += period * soon.acceleration;
  soon.acceleration += period * soon.jerk;
  StageReference now = references_.front();
  const StageReference next = onPath(soon, yaw_ + period * stages_.front().yaw_rate,
                                     disturbanceAt(soon) + period * disturbance_rate_);
  lead(now, next, period_decay_);
  path_ = {undisturbedTilt(*preview, soon), {now.roll, now.pitch}, preview->velocity};
  for (std::size_t k = 0; k + 1 < references_.size(); ++k)
    lead(references_[k], references_[k + 1], stage_decay_);
  sooner_ = {now.roll_command - references_.front().roll_command,
             now.pitch_command - references_.front().pitch_command};
}

// Under a command that is held for a stage the model's tilt runs ahead of the path's, and then falls back.
// What that adds to the mean of the specific force is taken out of the stage, so that the references are a
// solution of the model. Else the plan would mistake it for a disturbance, which shows while the path's tilt
// turns.
void NonlinearController::matchStages() noexcept {
  for (std::size_t k = 0; k + 1 < references_.size(); ++k) {
    const StageReference& from = references_[k];
    const StageReference& to = references_[k + 1];
    StageConditions& stage = stages_[k];
    const double yaw = stage.yaw + 0.5 * mpc_.options().period * stage.yaw_rate;
    const double sine = std::sin(yaw), cosine = std::cos(yaw);
    const double forward = from.lift * ahead_.pitch * (to.pitch - from.pitch);
    const double left = -from.lift * ahead_.roll * (to.roll - from.roll);
    stage.disturbance -= Eigen::Vector3d(cosine * forward - sine * left, sine * forward + cosine * left, 0.0);
  }
}

bool NonlinearController::isFar(const MultirotorState& x) const noexcept {
  const MultirotorState gap = (x - mpc_.state(0)).cwiseAbs();
  return gap.head<3>().maxCoeff() > kFarPosition || gap.segment<3>(3).maxCoeff() > kFarVelocity ||
         gap.tail<2>().maxCoeff() > kFarTilt;
}

void NonlinearController::startIteration(const MultirotorState& x) noexcept {
  const MultirotorInput hover(0.0, 0.0, options_.gravity);
  MultirotorInput u = hover;
  if (has_command_) {
    const AttitudeCommand& command = report_.command;
    const TiltAngles by = added({x(6), x(7)}, command.yaw_rate);
    u << command.roll - by.roll, command.pitch - by.pitch, command.thrust / options_.mass;
  }
  mpc_.start(x, u, stages_.data());
  for (int i = 1; i < kFirstIterations; ++i) {
    if (!mpc_.prepare(stages_.data()) || !answers(mpc_.feedback(x, references_.data()))) {
      mpc_.start(x, hover, stages_.data());
      break;
    }
  }
}

// A search that was ended early has an answer where it has come nearer to the optimum than the solution of
// the step before, moved on.
bool NonlinearController::answers(QpStatus status) const noexcept {
  return status == QpStatus::kOptimal || (status == QpStatus::kIterationLimit && mpc_.stepLength() > 0.0);
}

bool NonlinearController::solve(const MultirotorState& x, int periods) noexcept {
  const double share = options_.control_period / mpc_.options().period;
  if (!iterating_ || isFar(x)) {
    matchStages();
    startIteration(x);
    prepared_ = false;
  } else if (periods != 1 || !prepared_) {
    // The preparation, if any, was for one period.
    matchStages();
    const int more = periods - (prepared_ ? 1 : 0);
    mpc_.shift(std::clamp(more * share, 0.0, 1.0));
    prepared_ = false;
  }
  iterating_ = true;
  if (!prepared_ && !mpc_.prepare(stages_.data())) return false;
  prepared_ = false;
  const QpStatus status = mpc_.feedback(x, references_.data());
  report_.iterations = mpc_.iterations();
  report_.step_length = mpc_.stepLength();
  report_.status = status == QpStatus::kOptimal ? ControlStatus::kOptimal : ControlStatus::kSuboptimal;
  return answers(status);
}

void NonlinearController::prepare() noexcept {
  if (!iterating_ || prepared_) return;
  mpc_.shift(std::min(1.0, options_.control_period / mpc_.options().period));
  // The references move on by one period; their difference to those of the last step does not matter to yaw.
  predictYaw(yaw_ + options_.control_period * report_.command.yaw_rate, preview_.data());
  matchStages();
  prepared_ = mpc_.prepare(stages_.data());
  if (!prepared_) iterating_ = false;
}

// The model's loops hold the Euler angles.
TiltAngles NonlinearController::added(const TiltAngles& tilt, double yaw_rate) const noexcept {
  return trim_.added(tilt, yaw_rate, 0.0);
}

void NonlinearController::send(const EulerAngles& angles, const Reference& reference) noexcept {
  const MultirotorInput& u = mpc_.input(0);
  AttitudeCommand& command = report_.command;
  command.yaw_rate = yawRate(options_, reference, angles.yaw);
  const TiltAngles by = added({angles.roll, angles.pitch}, command.yaw_rate);
  const TiltAngles ahead = trim_.feedForward(path_.tilt, command.yaw_rate);
  followed_ = path_;
  // The QP meets the bounds up to rounding; what is sent meets them exactly.
  command.roll =
      std::clamp(u(0) + sooner_.roll + by.roll + ahead.roll, -options_.angle_max, options_.angle_max);
  command.pitch =
      std::clamp(u(1) + sooner_.pitch + by.pitch + ahead.pitch, -options_.angle_max, options_.angle_max);
  command.thrust = options_.mass * std::clamp(u(2), options_.thrust_min, options_.thrust_max);
  const Eigen::Vector3d disturbance = disturbanceAt(reference);
  for (std::size_t i = 0; i < report_.axis.size(); ++i) {
    report_.axis[i].disturbance = disturbance(static_cast<Eigen::Index>(i));
  }
  report_.axis[0].input = command.pitch - by.pitch - ahead.pitch;
  report_.axis[1].input = command.roll - by.roll - ahead.roll;
  report_.axis[2].input = command.thrust / options_.mass - options_.gravity;
  report_.reason = ControlReason::kNone;
  has_command_ = true;
}

void NonlinearController::setDisturbance(const Eigen::Vector3d& disturbance) noexcept {
  resetTrim();
  observer_.setDisturbance(disturbance);
}

void NonlinearController::forgetPlan() noexcept {
  followed_ = {};
  has_command_ = false;
  report_.axis.fill(AxisReport{});
  iterating_ = false;
  prepared_ = false;
}

void NonlinearController::track(const VehicleState& state, const AttitudeCommand& sent) noexcept {
  if (!isValid(state)) return;
  observe(state, eulerAngles(state.attitude.normalized()));
  report_.command = sent;
  has_command_ = true;
  iterating_ = false;
  prepared_ = false;
  followed_ = {};
}

}  // namespace polyfly
