// The bounds of HorizonQp: a dual active-set method on the responses of the recursion.
#include "fixedwing_lateral/horizon_qp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace polyfly {
namespace {

constexpr double kFeasible = 1e-11;   // violation of a bound that is left alone [rad]
constexpr double kDependent = 1e-10;  // relative pivot below which a bound depends on the active ones
constexpr double kRounding = 1e-12;   // multipliers beyond their range by this, relative to 1 + the largest
constexpr int kPolishRounds = 10;
constexpr int kStates = 5;

}  // namespace

HorizonQp::HorizonQp(int horizon)
    : N_(horizon),
      channels_(2 * horizon),
      unbounded_(std::numeric_limits<double>::infinity()),
      stages_(horizon + 1),
      bounds_(channels_),
      gains_(horizon),
      feedforward_(horizon),
      feedforward_response_(horizon),
      x_(kStates * (horizon + 1)),
      free_value_(channels_),
      value_(channels_),
      multiplier_(channels_),
      responses_(static_cast<std::size_t>(channels_) * channels_),
      known_(channels_),
      place_(channels_, Place::kFree),
      side_(channels_),
      active_(horizon),
      factor_(static_cast<std::size_t>(horizon) * horizon),
      direction_(horizon) {}

bool HorizonQp::prepare() noexcept {
  std::fill(known_.begin(), known_.end(), std::uint8_t{0});
  if (!recursion()) return false;
  for (int i = 0; i < active_count_; ++i) ensureResponse(active_[i]);
  for (int c = 0; c < channels_; ++c) {
    if (place_[c] == Place::kRelaxed) ensureResponse(c);
  }
  buildFactor();
  return true;
}

HorizonQpStatus HorizonQp::solve(const double* x_0) noexcept {
  iterations_ = 0;
  rollOut(x_0);
  // The sum is not finite when one of its terms is not finite.
  double sum = 0.0;
  for (int c = 0; c < channels_; ++c) sum += free_value_[c];
  for (int k = 1; k <= N_; ++k) sum += x_[kStates * k] + x_[kStates * k + 1];
  if (!std::isfinite(sum)) {
    coldStart();
    std::fill(value_.begin(), value_.end(), 0.0);
    return HorizonQpStatus::kNotFinite;
  }
  restart();
  bool optimal = active_count_ == 0 && isFeasible();
  for (int round = 0; round < kPolishRounds && !optimal; ++round) {
    double direction = 0.0;
    bool reached = true;
    for (int c = mostViolated(direction); c >= 0 && reached; c = mostViolated(direction)) {
      reached = drive(c, direction);
    }
    if (!reached) break;
    optimal = polish();
  }
  for (int k = 0; k < N_; ++k) value_[k] = std::clamp(value_[k], bounds_[k].lower, bounds_[k].upper);
  if (active_count_ > 0 || !optimal || is_relaxed_) followMoves(x_0);
  return optimal ? HorizonQpStatus::kOptimal : HorizonQpStatus::kIterationLimit;
}

void HorizonQp::coldStart() noexcept {
  std::fill(place_.begin(), place_.end(), Place::kFree);
  std::fill(multiplier_.begin(), multiplier_.end(), 0.0);
  active_count_ = 0;
  is_relaxed_ = false;
}

void HorizonQp::ensureResponse(int channel) noexcept {
  if (known_[channel] != 0) return;
  respond(channel);
  known_[channel] = 1;
}

// Begins with the active set of the last solution: multipliers that make its bounds hold, without those that
// have left their range.
void HorizonQp::restart() noexcept {
  if (active_count_ == 0 && !is_relaxed_) {
    std::copy(free_value_.begin(), free_value_.end(), value_.begin());
    return;
  }
  settle();
  updateValues();
}

// Solves for the multipliers of the active bounds and drops the worst that is out of range, until none is.
void HorizonQp::settle() noexcept {
  for (;;) {
    resolveMultipliers();
    int worst = -1;
    double excess = 0.0;
    for (int i = 0; i < active_count_; ++i) {
      const int c = active_[i];
      const double pushing = side_[c] * multiplier_[c];
      const double beyond = std::max(-pushing, pushing - reach(c));
      if (beyond > std::max(excess, kRounding * (1.0 + std::abs(pushing)))) {
        excess = beyond;
        worst = i;
      }
    }
    if (worst < 0) return;
    ++iterations_;
    release(worst);
  }
}

// An active bound leaves at the end of its multiplier's range that it has reached.
void HorizonQp::release(int position) noexcept {
  const int c = active_[position];
  const bool relaxes = side_[c] * multiplier_[c] > 0.5 * reach(c);
  place_[c] = relaxes ? Place::kRelaxed : Place::kFree;
  multiplier_[c] = relaxes ? side_[c] * reach(c) : 0.0;
  is_relaxed_ = is_relaxed_ || relaxes;
  drop(position);
}

bool HorizonQp::isFeasible() const noexcept {
  for (int c = 0; c < channels_; ++c) {
    if (value_[c] > bounds_[c].upper + kFeasible || value_[c] < bounds_[c].lower - kFeasible) return false;
  }
  return true;
}

// The channel that is farthest from where its multiplier wants it, and which way that must go.
int HorizonQp::mostViolated(double& direction) const noexcept {
  int worst = -1;
  double most = kFeasible;
  for (int c = 0; c < channels_; ++c) {
    if (place_[c] == Place::kActive) continue;
    const double above = value_[c] - bounds_[c].upper;
    const double below = bounds_[c].lower - value_[c];
    double violation = std::max(above, below);
    double wanted = above > below ? 1.0 : -1.0;
    if (place_[c] == Place::kRelaxed) {  // it must still be beyond its bound
      violation = -side_[c] * (value_[c] - boundOf(c, side_[c]));
      wanted = -side_[c];
    }
    if (violation > most) {
      most = violation;
      worst = c;
      direction = wanted;
    }
  }
  return worst;
}

// Moves the multiplier of `channel` until the bound holds or the multiplier's range ends; active bounds that
// reach the end of their range on the way leave. False when rounding prevents an end.
bool HorizonQp::drive(int channel, double direction) noexcept {
  ensureResponse(channel);
  const bool begins = place_[channel] == Place::kFree;
  if (begins) side_[channel] = direction;
  const double own = response(channel, channel);
  for (int guard = 0; guard <= 4 * channels_; ++guard) {
    ++iterations_;
    for (int i = 0; i < active_count_; ++i) direction_[i] = response(channel, active_[i]);
    solveFactor(direction_.data());
    double curvature = own;
    for (int i = 0; i < active_count_; ++i) curvature -= direction_[i] * response(channel, active_[i]);
    const double residual = direction * (value_[channel] - boundOf(channel, side_[channel]));
    const bool independent = active_count_ < N_ && curvature > kDependent * own;
    const double primal = independent ? std::max(0.0, residual) / curvature : unbounded_;
    const double range =
        begins ? reach(channel) - std::abs(multiplier_[channel]) : std::abs(multiplier_[channel]);
    int blocking = -1;
    const double dual = blockingStep(direction, blocking);
    const double step = std::min({primal, range, dual});
    if (!std::isfinite(step)) return false;
    for (int i = 0; i < active_count_; ++i) multiplier_[active_[i]] -= step * direction * direction_[i];
    multiplier_[channel] += step * direction;
    if (step == primal) {
      if (!append(channel)) return false;
      updateValues();
      return true;
    }
    if (step == range) {
      place_[channel] = begins ? Place::kRelaxed : Place::kFree;
      multiplier_[channel] = begins ? side_[channel] * reach(channel) : 0.0;
      is_relaxed_ = is_relaxed_ || begins;
      updateValues();
      return true;
    }
    release(blocking);
    updateValues();
  }
  return false;
}

double HorizonQp::blockingStep(double direction, int& blocking) const noexcept {
  double least = unbounded_;
  for (int i = 0; i < active_count_; ++i) {
    const int c = active_[i];
    const double pushing = side_[c] * multiplier_[c];
    // Change of `pushing` by the step.
    const double change = -side_[c] * direction * direction_[i];
    double step = unbounded_;
    if (change < 0.0) step = std::max(0.0, pushing) / -change;
    if (change > 0.0) step = std::max(0.0, reach(c) - pushing) / change;
    if (step < least) {
      least = step;
      blocking = i;
    }
  }
  return least;
}

// Removes the rounding that the updates have gathered. True when the result still is optimal.
bool HorizonQp::polish() noexcept {
  const int before = active_count_;
  settle();
  updateValues();
  double direction = 0.0;
  return active_count_ == before && mostViolated(direction) < 0;
}

void HorizonQp::updateValues() noexcept {
  std::copy(free_value_.begin(), free_value_.end(), value_.begin());
  bool any_relaxed = false;
  for (int c = 0; c < channels_; ++c) {
    any_relaxed = any_relaxed || place_[c] == Place::kRelaxed;
    if (multiplier_[c] == 0.0) continue;
    const double* column = &responses_[static_cast<std::size_t>(c) * channels_];
    for (int i = 0; i < channels_; ++i) value_[i] -= multiplier_[c] * column[i];
  }
  is_relaxed_ = any_relaxed;
  for (int i = 0; i < active_count_; ++i) value_[active_[i]] = boundOf(active_[i], side_[active_[i]]);
}

// Multipliers with which the active bounds hold; those of relaxed bounds stay.
void HorizonQp::resolveMultipliers() noexcept {
  for (int i = 0; i < active_count_; ++i) {
    const int c = active_[i];
    double value = free_value_[c] - boundOf(c, side_[c]);
    if (is_relaxed_) {
      for (int other = 0; other < channels_; ++other) {
        if (place_[other] == Place::kRelaxed) value -= multiplier_[other] * response(other, c);
      }
    }
    direction_[i] = value;
  }
  solveFactor(direction_.data());
  for (int i = 0; i < active_count_; ++i) multiplier_[active_[i]] = direction_[i];
}

void HorizonQp::buildFactor() noexcept {
  const int count = active_count_;
  active_count_ = 0;
  for (int i = 0; i < count; ++i) {
    const int c = active_[i];
    if (append(c)) continue;
    place_[c] = Place::kFree;
    multiplier_[c] = 0.0;
  }
}

bool HorizonQp::append(int channel) noexcept {
  const int k = active_count_;
  if (k >= N_) return false;
  double* row = &factor_[static_cast<std::size_t>(k) * N_];
  double pivot = response(channel, channel);
  const double least = 0.1 * kDependent * pivot;
  for (int j = 0; j < k; ++j) {
    const double* other = &factor_[static_cast<std::size_t>(j) * N_];
    double value = response(channel, active_[j]);
    for (int i = 0; i < j; ++i) value -= row[i] * other[i];
    row[j] = value / other[j];
    pivot -= row[j] * row[j];
  }
  if (!(pivot > least)) return false;
  row[k] = std::sqrt(pivot);
  active_[k] = channel;
  place_[channel] = Place::kActive;
  ++active_count_;
  return true;
}

// Removes one row of the factor; rotations make the rest triangular again.
void HorizonQp::drop(int position) noexcept {
  for (int j = position; j + 1 < active_count_; ++j) {
    active_[j] = active_[j + 1];
    double* row = &factor_[static_cast<std::size_t>(j) * N_];
    std::copy(row + N_, row + N_ + j + 2, row);
  }
  --active_count_;
  for (int j = position; j < active_count_; ++j) {
    double* pivot_row = &factor_[static_cast<std::size_t>(j) * N_];
    const double length = std::hypot(pivot_row[j], pivot_row[j + 1]);
    const double cosine = pivot_row[j] / length;
    const double sine = pivot_row[j + 1] / length;
    pivot_row[j] = length;
    for (int i = j + 1; i < active_count_; ++i) {
      double* row = &factor_[static_cast<std::size_t>(i) * N_];
      const double left = row[j];
      const double right = row[j + 1];
      row[j] = cosine * left + sine * right;
      row[j + 1] = cosine * right - sine * left;
    }
  }
}

void HorizonQp::solveFactor(double* x) const noexcept {
  for (int j = 0; j < active_count_; ++j) {
    const double* row = &factor_[static_cast<std::size_t>(j) * N_];
    double value = x[j];
    for (int i = 0; i < j; ++i) value -= row[i] * x[i];
    x[j] = value / row[j];
  }
  for (int j = active_count_ - 1; j >= 0; --j) {
    double value = x[j];
    for (int i = j + 1; i < active_count_; ++i) value -= factor_[static_cast<std::size_t>(i) * N_ + j] * x[i];
    x[j] = value / factor_[static_cast<std::size_t>(j) * N_ + j];
  }
}

}  // namespace polyfly
