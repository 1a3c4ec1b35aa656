#include "made_stretches.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>

namespace polyfly::test {
namespace {

constexpr double kTimeStep = 2e-3;       // [s]
constexpr int kLoggedEach = 5;           // steps
constexpr double kWeight = 9.8066;       // [m/s^2]
constexpr double kVehicleMass = 1.5;     // [kg]
constexpr double kClimb = 4.0;           // time for take-off and for landing [s]
constexpr double kDrag = 0.25;           // [1/s]
constexpr double kGustMemory = 0.5;      // [s]
constexpr double kGustSize = 0.3;        // [m/s^2]
constexpr double kTumbleRate = 12.0;     // [rad/s]
constexpr double kAngleNoise = 0.003;    // [rad]
constexpr double kVelocityNoise = 0.01;  // [m/s]
constexpr double kForceNoise = 0.3;      // [m/s^2]
constexpr double kRateNoise = 0.02;      // [rad/s]
constexpr std::size_t kDelaySteps = 25;

// When each stretch begins [s].
struct Plan {
  double takes_off = 0.0;
  double hovers = 0.0;
  double first_half = 0.0;
  double other_mode = 0.0;
  double stuck = 0.0;
  double second_half = 0.0;
  double lands = 0.0;
  double stands = 0.0;
  double tumbles = 0.0;
  double end = 0.0;
};

Plan planOf(const MadeStretches& made) {
  Plan plan;
  plan.takes_off = made.stands;
  plan.hovers = plan.takes_off + kClimb;
  plan.first_half = plan.hovers + made.hovers;
  plan.other_mode = plan.first_half + 0.5 * made.manoeuvres;
  plan.stuck = plan.other_mode + made.other_mode;
  plan.second_half = plan.stuck + made.stuck;
  plan.lands = plan.second_half + 0.5 * made.manoeuvres;
  plan.stands = plan.lands + (made.stands > 0.0 ? kClimb : 0.0);
  plan.tumbles = plan.stands + made.stands;
  plan.end = plan.tumbles + made.tumbles;
  return plan;
}

// A few sines that no other seed has.
class Wander {
 public:
  Wander(double size, std::mt19937* random) {
    std::uniform_real_distribution<double> frequency(0.3, 4.0);
    std::uniform_real_distribution<double> phase(0.0, 6.28);
    for (Part& part : parts_) part = {size / std::sqrt(2.0), frequency(*random), phase(*random)};
  }
  double at(double time) const {
    double sum = 0.0;
    for (const Part& part : parts_) sum += part.size * std::sin(part.frequency * time + part.phase);
    return sum;
  }

 private:
  struct Part {
    double size = 0.0;
    double frequency = 0.0;
    double phase = 0.0;
  };
  std::array<Part, 4> parts_;
};

// Steps of changing size, both signs; each axis with its own period.
double stepsAt(double time, double period, double size) {
  const auto pulse = static_cast<int>(time / period);
  const double sizes[] = {1.0, -1.0, 0.6, 0.0, -0.6, 0.9, -0.9, 0.3};
  return size * sizes[pulse % 8];
}

bool within(double time, double from, double to) { return from <= time && time < to; }

class Simulation {
 public:
  Simulation(const MadeStretches& made, std::uint32_t seed)
      : made_(made),
        plan_(planOf(made)),
        random_(seed),
        corrections_{wander(0.012), wander(0.012)},
        others_{wander(0.2), wander(0.2)} {
    std::uniform_real_distribution<double> about(0.8, 1.2);
    tau_ = {0.12 * about(random_), 0.15 * about(random_)};
    size_ = 0.25 * about(random_);
  }

  MadeStretchesFlight run() {
    result_.signals.source = "made stretches";
    for (step_ = 0; step_ * kTimeStep < plan_.end; ++step_) {
      command();
      if (step_ % kLoggedEach == 0) log();
      advance();
    }
    result_.by_hand = {{plan_.first_half, plan_.other_mode}, {plan_.second_half, plan_.lands}};
    if (made_.other_mode + made_.stuck == 0.0) result_.by_hand = {{plan_.first_half, plan_.lands}};
    result_.in_air = {plan_.takes_off + 1.0, plan_.stands - 0.5};
    return result_;
  }

 private:
  Wander wander(double size) { return {size, &random_}; }
  double time() const { return step_ * kTimeStep; }
  bool onGround() const { return time() < plan_.takes_off || within(time(), plan_.stands, plan_.tumbles); }
  double noise(double size) { return size * normal_(random_); }

  // What the loops get, and what is logged of it.
  void command() {
    const double now = time();
    const bool moves =
        within(now, plan_.first_half, plan_.other_mode) || within(now, plan_.stuck, plan_.lands);
    const double periods[] = {0.7, 0.9};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      true_[axis] = moves ? stepsAt(now - plan_.first_half, periods[axis], size_) : 0.0;
      if (!onGround()) true_[axis] += corrections_[axis].at(now);
      logged_[axis] = true_[axis];
      if (within(now, plan_.other_mode, plan_.stuck)) {
        true_[axis] = others_[axis].at(now);
        logged_[axis] = stepsAt(now, periods[axis], 0.5 * size_);
      }
      if (within(now, plan_.stuck, plan_.second_half)) logged_[axis] = stuck_[axis];
      stuck_[axis] = logged_[axis];
    }
    const double vertical = within(now, plan_.takes_off, plan_.hovers) ? 1.0
                            : within(now, plan_.lands, plan_.stands)   ? -1.0
                                                                       : 0.0;
    const double lift = kWeight + 2.0 * (vertical - velocity_.z()) + 0.8 * std::sin(1.7 * now);
    thrust_ =
        onGround() ? 0.0 : kVehicleMass * lift / std::max(0.5, std::cos(angle_[0]) * std::cos(angle_[1]));
    delayed_.push_back(true_);
  }

  Eigen::Vector3d up() const {
    return Eigen::AngleAxisd(angle_[1], Eigen::Vector3d::UnitY()) *
           (Eigen::AngleAxisd(angle_[0], Eigen::Vector3d::UnitX()) * Eigen::Vector3d::UnitZ());
  }

  void put(const char* name, double value) {
    TimeSeries& series = result_.signals.series[name];
    series.time.push_back(time());
    series.value.push_back(value);
  }

  void log() {
    put("roll_cmd", logged_[0]);
    put("pitch_cmd", logged_[1]);
    put("roll", std::remainder(angle_[0], 6.283185307179586) + noise(kAngleNoise));
    put("pitch", std::asin(std::sin(angle_[1])) + noise(kAngleNoise));
    put("yaw", 0.0);
    put("vx", velocity_.x() + noise(kVelocityNoise));
    put("vy", velocity_.y() + noise(kVelocityNoise));
    put("vz", velocity_.z() + noise(kVelocityNoise));
    if (!made_.many_signs) return;
    put("thrust_cmd", thrust_);
    put("gyro_x", rate_[0] + noise(kRateNoise));
    put("gyro_y", rate_[1] + noise(kRateNoise));
    put("specific_force_z",
        (onGround() ? kWeight : thrust_ / kVehicleMass) + noise(onGround() ? 0.05 : kForceNoise));
  }

  void advance() {
    const std::array<double, 2> seen =
        delayed_.size() > kDelaySteps ? delayed_[delayed_.size() - 1 - kDelaySteps] : std::array<double, 2>{};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      rate_[axis] = onGround() ? 0.0 : (1.02 * seen[axis] - angle_[axis]) / tau_[axis];
      if (time() >= plan_.tumbles) rate_[axis] = kTumbleRate * (axis == 0 ? 1.0 : 0.6);
      angle_[axis] += kTimeStep * rate_[axis];
      if (onGround()) angle_[axis] = 0.01;
    }
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      gust_[axis] += -gust_[axis] * kTimeStep / kGustMemory +
                     noise(kGustSize * std::sqrt(2.0 * kTimeStep / kGustMemory));
    if (onGround()) {
      velocity_.setZero();
      return;
    }
    velocity_ += kTimeStep * (thrust_ / kVehicleMass * up() - Eigen::Vector3d(0.0, 0.0, kWeight) -
                              kDrag * velocity_ + gust_);
    position_ += kTimeStep * velocity_;
  }

  MadeStretches made_;
  Plan plan_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::array<Wander, 2> corrections_;
  std::array<Wander, 2> others_;
  std::array<double, 2> tau_{};
  double size_ = 0.0;
  int step_ = 0;
  std::array<double, 2> true_{};
  std::array<double, 2> logged_{};
  std::array<double, 2> stuck_{};
  std::vector<std::array<double, 2>> delayed_;
  double thrust_ = 0.0;
  std::array<double, 2> angle_{};
  std::array<double, 2> rate_{};
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d gust_ = Eigen::Vector3d::Zero();
  MadeStretchesFlight result_;
};

}  // namespace

MadeStretchesFlight makeStretches(const MadeStretches& made, std::uint32_t seed) {
  return Simulation(made, seed).run();
}

}  // namespace polyfly::test
