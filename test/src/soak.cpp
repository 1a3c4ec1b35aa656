#include "polyfly_test/soak.hpp"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "online_controller/laws/law_registry.hpp"
#include "polyfly_test/flight_figure.hpp"
#include "polyfly_test/multirotor_plant.hpp"

namespace polyfly_test {
namespace {

using namespace polyfly;

// Control period [s].
constexpr double kPeriod = 0.01;
// Position error below which a vehicle is back on its path [m].
constexpr double kOnPath = 0.3;
// Rounding error of a bound.
constexpr double kRounding = 1e-12;

enum class Fault { kNone, kSilence, kNotANumber, kJump, kOutOfOrder, kWrongFrame, kHuge };
constexpr int kFaults = 6;

class Soak {
 public:
  Soak(SoakController& controller, const SoakTuning& tuning, int map_sets, const SoakOptions& options)
      : controller_(controller),
        made_with_(tuning),
        map_sets_(map_sets),
        random_(options.seed),
        options_(options),
        law_count_(static_cast<int>(options.laws.size())),
        plant_(plantOptions(options.seed), startState()) {}

  SoakResult run(const std::function<void(double)>& progress) {
    const long count = std::lround(options_.duration / kPeriod);
    long in_use = 0;
    for (long i = 0; i < count; ++i) {
      if (i == count / 10) in_use = bytesInUse();
      if (progress && i % 6000 == 0) progress(plant_.time());
      disturb();
      sample();
      ++result_.samples;
    }
    result_.allocated_growth = bytesInUse() - in_use;
    return result_;
  }

 private:
// Its successor is of glibc 2.33. A soak uses less than the 2 GB that it can count.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
  static long bytesInUse() { return mallinfo().uordblks; }
#pragma GCC diagnostic pop

  static PlantOptions plantOptions(std::uint32_t seed) {
    PlantOptions options;
    options.wind = {0.3, -0.2, 0.1};
    options.gust_sigma = {0.2, 0.2, 0.1};
    options.position_noise = 0.003;
    options.velocity_noise = 0.01;
    options.attitude_noise = 0.003;
    options.seed = static_cast<int>(seed);
    return options;
  }

  static PlantState startState() {
    PlantState state;
    state.position.z() = 1.0;
    state.thrust = PlantOptions{}.gravity;
    return state;
  }

  double uniform(double least, double greatest) {
    return std::uniform_real_distribution<double>(least, greatest)(random_);
  }
  int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }

  /// New weights, limits and gains, such as fly.
  SoakTuning otherTuning() {
    SoakTuning next = made_with_;
    next.options.mass *= uniform(0.97, 1.03);
    next.options.yaw_gain = uniform(0.8, 3.0);
    next.options.angle_max = uniform(0.3, 0.45);
    next.options.thrust_min = uniform(4.0, 6.0);
    next.options.thrust_max = uniform(15.0, 20.0);
    next.options.disturbance_drift = uniform(0.002, 0.01);
    next.nonlinear.position_weight *= uniform(0.5, 2.0);
    next.nonlinear.thrust_weight = uniform(0.5, 2.0);
    for (AxisTuning& axis : next.linear) {
      axis.position_weight *= uniform(0.6, 1.5);
      axis.command_weight *= uniform(0.7, 1.4);
    }
    return next;
  }

  void disturb() {
    const double now = plant_.time();
    if (now >= next_reference_) newReference(now);
    if (now >= next_change_) {
      change();
      next_change_ = now + uniform(0.3, 1.5);
    }
    if (fault_ != Fault::kNone && now >= fault_end_) {
      fault_ = Fault::kNone;
      recovered_ = false;
    }
    if (now >= next_fault_) {
      judge(now);
      beginFault(now);
    }
  }

  void newReference(double now) {
    FigureOptions figure;
    figure.rate = uniform(0.3, 0.6);
    figure.laps = 1 + below(2);
    figure.yaw_turn = uniform(-6.0, 6.0);
    figure.hold_time = 2.0;
    const FlightFigure path(figure);
    points_ = path.sample();
    point_period_ = figure.sample_period;
    reference_start_ = now;
    controller_.setReference(points_, point_period_, now);
    next_reference_ = now + path.duration();
    ++result_.references;
  }

  /// Where the vehicle should be.
  Eigen::Vector3d wanted(double now) const {
    const double place = (now - reference_start_) / point_period_;
    const auto before = std::min(static_cast<std::size_t>(place), points_.size() - 1);
    const auto after = std::min(before + 1, points_.size() - 1);
    const double share = std::min(place - static_cast<double>(before), 1.0);
    return (1.0 - share) * points_[before].position + share * points_[after].position;
  }

  void change() {
    switch (below(4)) {
      case 0:
        controller_.swapMaps(static_cast<std::size_t>(below(map_sets_)));
        ++result_.swaps;
        break;
      case 1:
        controller_.select(lawOfName(options_.laws.at(static_cast<std::size_t>(below(law_count_)))));
        ++result_.selections;
        break;
      default:
        controller_.reconfigure(otherTuning());
        ++result_.reconfigurations;
        break;
    }
  }

  void beginFault(double now) {
    fault_ = static_cast<Fault>(1 + below(kFaults));
    const bool is_short = fault_ != Fault::kSilence && below(2) == 0;
    fault_end_ =
        now + (is_short ? uniform(0.01, 0.05) : uniform(0.05, fault_ == Fault::kSilence ? 1.5 : 0.6));
    next_fault_ = fault_end_ + uniform(6.0, 12.0);
    offset_ = {uniform(-4.0, 4.0), uniform(-4.0, 4.0), uniform(-4.0, 4.0)};
    long* const counts[] = {&result_.silences,     &result_.not_numbers,  &result_.jumps,
                            &result_.out_of_order, &result_.wrong_frames, &result_.huge};
    ++*counts[static_cast<int>(fault_) - 1];
    faulted_ = true;
  }

  /// Before the next fault the last one must be over.
  void judge(double now) {
    if (!faulted_) return;
    if (recovered_) {
      ++result_.recoveries;
      return;
    }
    result_.violations.push_back(std::to_string(now) + " s: not recovered from fault " +
                                 std::to_string(static_cast<int>(last_fault_)));
  }

  void sample() {
    const double now = plant_.time();
    VehicleState state = plant_.measure();
    if (fault_ != Fault::kNone) last_fault_ = fault_;
    if (fault_ == Fault::kSilence) {
      check(controller_.onSilence(now, ++silent_), now);
    } else {
      silent_ = 0;
      spoil(state);
      check(controller_.onOdometry(state, fault_ != Fault::kWrongFrame), now);
    }
    plant_.advance(sent_);
    watch(now);
  }

  void spoil(VehicleState& state) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    switch (fault_) {
      case Fault::kNotANumber:
        (below(2) == 0 ? state.position : state.velocity)[below(3)] = kNan;
        if (below(3) == 0) state.attitude.coeffs().setConstant(kNan);
        break;
      case Fault::kJump:
        state.position += offset_;
        break;
      case Fault::kOutOfOrder:
        state.stamp -= uniform(0.02, 0.5);
        break;
      case Fault::kHuge:
        state.velocity[below(3)] = below(2) == 0 ? 1e9 : std::numeric_limits<double>::infinity();
        break;
      case Fault::kNone:
      case Fault::kSilence:
      case Fault::kWrongFrame:
        break;
    }
  }

  /// What is sent keeps the limits in force, whatever led to it.
  void check(const SoakAnswer& answer, double now) {
    status_ = answer.status;
    result_.failsafe += isAnswer(answer.status) ? 0 : 1;
    if (!answer.sends) return;
    ++result_.commands;
    sent_ = answer.command;
    const MultirotorOptions& limits = answer.limits;
    const double thrust = sent_.thrust / limits.mass;
    const bool off = answer.status == ControlStatus::kMotorsOff && thrust == 0.0;
    const bool within =
        std::abs(sent_.roll) <= limits.angle_max + kRounding &&
        std::abs(sent_.pitch) <= limits.angle_max + kRounding &&
        std::abs(sent_.yaw_rate) <= limits.yaw_rate_max + kRounding &&
        (off || (thrust >= limits.thrust_min - kRounding && thrust <= limits.thrust_max + kRounding));
    if (within) return;  // written so that NaN is none
    result_.violations.push_back(std::to_string(now) + " s: sent roll " + std::to_string(sent_.roll) +
                                 ", pitch " + std::to_string(sent_.pitch) + ", yaw rate " +
                                 std::to_string(sent_.yaw_rate) + ", thrust " + std::to_string(thrust) +
                                 ", status " + std::to_string(static_cast<int>(answer.status)));
  }

  void watch(double now) {
    if (fault_ != Fault::kNone || !isAnswer(status_)) return;
    const double error = (plant_.state().position - wanted(now)).norm();
    if (recovered_) {
      result_.greatest_error = std::max(result_.greatest_error, error);
    } else if (error < kOnPath) {
      recovered_ = true;
      if (faulted_) result_.slowest = std::max(result_.slowest, now - fault_end_);
    }
  }

  SoakController& controller_;
  SoakTuning made_with_;
  int map_sets_;
  std::mt19937 random_;
  SoakOptions options_;
  int law_count_;
  MultirotorPlant plant_;
  AttitudeCommand sent_{0.0, 0.0, 0.0, PlantOptions{}.mass* PlantOptions{}.gravity};
  ControlStatus status_ = ControlStatus::kNoReference;
  SoakResult result_;

  // Points of the trajectory in force.
  std::vector<Reference> points_;
  double point_period_ = 1.0;     // [s]
  double reference_start_ = 0.0;  // [s]
  // Times of the next reference, change and fault, and of the end of the fault [s].
  double next_reference_ = 0.0, next_change_ = 5.0, next_fault_ = 12.0, fault_end_ = 0.0;
  Fault fault_ = Fault::kNone;
  Fault last_fault_ = Fault::kNone;
  // Position offset of a jump [m].
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  bool recovered_ = false;
  bool faulted_ = false;
  // Periods without odometry.
  int silent_ = 0;
};

}  // namespace

SoakResult soak(SoakController& controller, const SoakTuning& tuning, int map_sets,
                const SoakOptions& options, const std::function<void(double)>& progress) {
  return std::make_unique<Soak>(controller, tuning, map_sets, options)->run(progress);
}

}  // namespace polyfly_test
