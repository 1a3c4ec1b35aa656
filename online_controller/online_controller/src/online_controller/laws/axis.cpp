#include "online_controller/laws/axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "online_controller/types/valid.hpp"

namespace polyfly {
namespace {

// Bisections of the share of the errors that has a plan.
constexpr int kHalvings = 30;

}  // namespace

bool Axis::areStagesValid() const noexcept { return isValidNumber(stage_references_->greatest()); }

void Axis::aim(bool look_ahead) noexcept {
  looks_ahead_ = look_ahead && stage_references_;
  disturbance_ahead_ = 0.0;
  if (looks_ahead_ && ahead_row_.size() > 0) {
    const auto slot = static_cast<std::size_t>(ahead_slot_);
    disturbance_ahead_ = std::clamp(stage_references_->along(ahead_row_), lower_[slot], upper_[slot]);
  } else {
    law_->setGradient(looks_ahead_ ? stage_references_->gradient() : nullptr);
  }
}

// The short model of a map has its references' motion in the errors.
double Axis::shift(int stage) const noexcept {
  if (!looks_ahead_ || ahead_row_.size() > 0 || stage > stages()) return 0.0;
  return stage_references_->shift(stage, position_state_);
}

void Axis::reset() noexcept {
  observer_.reset();
  if (drag_) drag_->reset();
  constant_part_ = 0.0;
  law_->reset();
}

void Axis::transferState(const Axis& other) noexcept {
  if (position_state_ != other.position_state_ || velocity_state_ != other.velocity_state_ ||
      angle_state_ != other.angle_state_ || has_rate_ != other.has_rate_ || rate_state_ != other.rate_state_)
    return;
  observer_.transferState(other.observer_);
  // The vehicle's drag stays, whatever of it the models have.
  if (drag_ && other.drag_) {
    const double more =
        (other.disturbance_gain_ - disturbance_gain_) * other.dragCoefficient() + (other.drag() - drag());
    drag_->transferState(*other.drag_, more / disturbance_gain_);
  } else if (other.drag_) {
    const double velocity = other.observer_.state()[velocity_state_];
    observer_.setDisturbance(observer_.disturbance() - other.dragCoefficient() * velocity);
  }
  // A part that was not removed so far is not removed at once.
  constant_part_ = removes_constant_ && !other.removes_constant_ ? 0.0 : other.constant_part_;
}

void Axis::setDisturbance(double disturbance) noexcept {
  observer_.setDisturbance(disturbance / disturbance_gain_);
  if (drag_) drag_->reset();
  constant_part_ = observer_.disturbance();
}

double Axis::constantLeft() const noexcept {
  if (!law_->problem().minimum_peak || removes_constant_) return 0.0;
  constexpr double kToldShare = 1.0 / 3.0;
  const Signal& range = law_->problem().disturbances.front();
  const bool told = constant_part_ > kToldShare * range.upper || constant_part_ < kToldShare * range.lower;
  return told ? disturbance_gain_ * constant_part_ : 0.0;
}

AxisTarget Axis::target(const AxisReference& reference, double disturbance,
                        double disturbance_rate) const noexcept {
  // B_d d_eq and its rate.
  const double equivalent =
      disturbance_gain_ * disturbance + velocity_gain_ * reference.velocity - reference.acceleration;
  const double equivalent_rate =
      disturbance_gain_ * disturbance_rate + velocity_gain_ * reference.acceleration - reference.jerk;
  const double drive = -equivalent / drive_gain_;
  if (!has_lag_) return {0.0, drive};
  const double drive_rate = -equivalent_rate / drive_gain_;
  if (has_rate_) return {drive, -(lag_pole_ * drive + lag_damping_ * drive_rate) / lag_gain_, drive_rate};
  return {drive, (drive_rate - lag_pole_ * drive) / lag_gain_, drive_rate};
}

void Axis::observe(const AxisSample& sample, double applied_input, int periods,
                   std::optional<double> followed) noexcept {
  std::array<double, DisturbanceObserver::kMaxStates> measured{};
  measured[static_cast<std::size_t>(position_state_)] = sample.position;
  measured[static_cast<std::size_t>(velocity_state_)] = sample.velocity;
  if (has_lag_) measured[static_cast<std::size_t>(angle_state_)] = sample.angle;
  if (has_rate_) measured[static_cast<std::size_t>(rate_state_)] = sample.rate;
  const double velocity = observer_.state()[velocity_state_];
  observer_.update(measured.data(), &applied_input, periods, -dragCoefficient() * velocity);
  if (drag_) drag_->update(observer_, followed, periods);
  if (constant_share_ == 0.0 || periods > DisturbanceObserver::kMaxPeriods) return;
  constant_part_ +=
      (1.0 - std::pow(1.0 - constant_share_, periods)) * (observer_.disturbance() - constant_part_);
}

Axis::Parameters Axis::parametersAt(const AxisValues& values) const noexcept {
  Parameters theta{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(size_); ++i) theta[i] = values[entries_[i]];
  return theta;
}

Axis::Parameters Axis::clipped(const Parameters& theta) const noexcept {
  Parameters result{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(size_); ++i)
    result[i] = std::clamp(theta[i], lower_[i], upper_[i]);
  return result;
}

int Axis::firstOutside(const Parameters& theta) const noexcept {
  for (int i = 0; i < size_; ++i) {
    const double value = theta[static_cast<std::size_t>(i)];
    if (value < lower_[static_cast<std::size_t>(i)] || value > upper_[static_cast<std::size_t>(i)]) return i;
  }
  return -1;
}

AxisTarget Axis::goalOf(const AxisReference& reference) const noexcept {
  if (!has_input_reference_) return {};
  return target(reference, disturbanceAt(reference) + reference.disturbance / disturbance_gain_,
                (offset_free_ ? observer_.rate() : 0.0) - dragCoefficient() * reference.acceleration);
}

AxisTarget Axis::undisturbedGoal(const AxisReference& reference) const noexcept {
  if (!has_input_reference_) return {};
  return target(reference, -dragCoefficient() * reference.velocity,
                -dragCoefficient() * reference.acceleration);
}

ControlStatus Axis::evaluate(const AxisSample& sample, const AxisReference& reference, double previous_input,
                             double input_offset, AxisReport& report) noexcept {
  const AxisTarget goal = goal_ = goalOf(reference);
  AxisValues values;
  values[AxisEntry::kPositionError] = sample.position - reference.position;
  values[AxisEntry::kVelocityError] = sample.velocity - reference.velocity;
  values[AxisEntry::kAngleError] = sample.angle - goal.angle;
  values[AxisEntry::kPreviousInput] = std::clamp(previous_input + input_offset, input_lower_, input_upper_);
  values[AxisEntry::kInputReference] = goal.input + input_offset;
  values[AxisEntry::kVelocityReference] = reference.velocity;
  values[AxisEntry::kPositionReference] = reference.position;
  values[AxisEntry::kAngleReference] = goal.angle;
  values[AxisEntry::kAngleRateError] = sample.rate - goal.rate;
  values[AxisEntry::kDisturbanceAhead] = disturbance_ahead_;
  report.theta = parametersAt(values);
  report.size = size_;
  report.disturbance = disturbanceAt(reference);
  report.outside_parameter = -1;
  report.region = -1;

  double input = 0.0;
  const ControlStatus status = answer(report, input);
  // The law meets the bounds up to rounding; what is applied meets them exactly.
  if (status != ControlStatus::kHoldLast) report.input = std::clamp(input, input_lower_, input_upper_);
  return status;
}

ControlStatus Axis::answer(AxisReport& report, double& input) noexcept {
  Lookup lookup = law_->evaluate(report.theta.data(), &input);
  report.lookup = lookup.status;
  report.iterations = law_->iterations();
  ControlStatus status = ControlStatus::kOptimal;
  if (lookup.status == LookupStatus::kOutsideBox) report.outside_parameter = firstOutside(report.theta);
  if (law_->solvesOutside() &&
      (lookup.status == LookupStatus::kOutsideBox || lookup.status == LookupStatus::kOutsidePartition)) {
    lookup = law_->solve(report.theta.data(), &input);
    report.iterations = law_->iterations();
  } else if (lookup.status == LookupStatus::kOutsideBox) {
    lookup = law_->evaluate(clipped(report.theta).data(), &input);
    status = ControlStatus::kClipped;
  }
  if (lookup.status == LookupStatus::kOutsidePartition && law_->problem().minimum_peak) {
    lookup = answerShrunk(report, input);
    status = ControlStatus::kLeastViolation;
  }
  if (lookup.status != LookupStatus::kInside) return ControlStatus::kHoldLast;
  if (!law_->solvesOutside() || !law_->isSolved()) report.region = lookup.region;
  return status;
}

// The map covers a convex set, so along the way to zero the answers begin at one place.
Lookup Axis::answerShrunk(const AxisReport& report, double& input) noexcept {
  const Parameters asked = clipped(report.theta);
  for (const bool all : {false, true}) {
    const auto answer_at = [&](double share) {
      Parameters theta = asked;
      for (std::size_t i = 0; i < static_cast<std::size_t>(size_); ++i) {
        if (all || isError(entries_[i])) theta[i] *= share;
      }
      return law_->evaluate(theta.data(), &input);
    };
    double inside = 0.0, outside = 1.0;
    Lookup lookup = answer_at(inside);
    if (lookup.status != LookupStatus::kInside) continue;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (inside + outside);
      const Lookup found = answer_at(middle);
      if (found.status != LookupStatus::kInside) {
        outside = middle;
        continue;
      }
      inside = middle;
      lookup = found;
    }
    return lookup;
  }
  return {};
}

}  // namespace polyfly
