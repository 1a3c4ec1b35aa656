// The soak of the controller's core: laws are built, offered and exchanged as the node does it.
#include <memory>

#include "online_controller/flight/flight_supervisor.hpp"
#include "online_controller/laws/law_registry.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "online_controller/realtime/object_swap.hpp"
#include "polyfly_test/soak.hpp"

namespace polyfly_test {
namespace {

using namespace polyfly;

constexpr int kStalePeriods = 10;  // until silence is noticed

/// A set of laws with the options that they were made with, as the node hands it over.
struct LawSet {
  MultirotorOptions options;
  std::unique_ptr<LawSwitch> laws;
};

class CoreController final : public SoakController {
 public:
  CoreController(const SoakLaws& laws, const SoakTuning& tuning)
      : sources_(laws),
        tuning_(tuning),
        set_(build()),
        flight_(*set_->laws, set_->options, FlightOptions{}, PilotRule::kNotRequired) {}

  SoakAnswer onOdometry(const VehicleState& state, bool frame_fits) override {
    flight_.onTime(state.stamp);
    flight_.onOdometry(state, frame_fits);
    const SoakAnswer result = answer();
    exchange();
    set_->laws->prepare();
    return result;
  }

  SoakAnswer onSilence(double now, int periods) override {
    flight_.onTime(now);
    if (periods <= kStalePeriods) return {};
    exchange();
    flight_.onSilence(now);
    return answer();
  }

  void setReference(const std::vector<Reference>& points, double period, double start) override {
    std::vector<TrajectorySample> samples;
    for (const Reference& point : points) {
      TrajectorySample sample;
      sample.time = static_cast<double>(samples.size()) * period;
      sample.position = point.position;
      sample.velocity = point.velocity;
      sample.acceleration = point.acceleration;
      sample.yaw = point.yaw;
      sample.yaw_rate = point.yaw_rate;
      sample.has_velocity = sample.has_acceleration = true;
      samples.push_back(sample);
    }
    flight_.onReference(ReferenceTrajectory(std::move(samples)), start);
  }

  void reconfigure(const SoakTuning& tuning) override {
    tuning_ = tuning;
    slot_.stage(build());
  }

  void swapMaps(std::size_t set) override {
    map_set_ = set;
    slot_.stage(build());
  }

  void select(Law law) override { set_->laws->select(law); }

 private:
  std::unique_ptr<LawSet> build() const {
    auto set = std::make_unique<LawSet>();
    set->options = tuning_.options;
    std::vector<std::unique_ptr<ControlLaw>> laws(lawTypes().size());
    const auto place = [&](const char* name) -> auto& {
      return laws[static_cast<std::size_t>(lawOfName(name))];
    };
    place("explicit_linear") = std::make_unique<MultirotorController>(sources_.maps[map_set_], set->options);
    place("linear") =
        std::make_unique<MultirotorController>(tuned(sources_.problems, tuning_.linear), set->options);
    place("nonlinear") = std::make_unique<NonlinearController>(set->options, tuning_.nonlinear);
    if (!sources_.robust_maps.empty())
      place("robust_explicit") =
          std::make_unique<MultirotorController>(sources_.robust_maps.at(map_set_), set->options);
    set->laws = std::make_unique<LawSwitch>(std::move(laws), lawOfName("explicit_linear"), set->options);
    return set;
  }

  SoakAnswer answer() const {
    return {flight_.sends(), flight_.report().command, flight_.report().status, set_->options};
  }

  void exchange() {
    const bool taken =
        slot_.swap(set_, [](LawSet& next, const LawSet& old) { next.laws->transferState(*old.laws); });
    if (!taken) return;
    flight_.setLaw(*set_->laws, set_->options);
    slot_.reclaim();
  }

  const SoakLaws& sources_;
  SoakTuning tuning_;
  std::size_t map_set_ = 0;
  ObjectSwap<LawSet> slot_;
  std::unique_ptr<LawSet> set_;
  FlightSupervisor flight_;
};

}  // namespace

SoakResult soak(const SoakLaws& laws, const SoakOptions& options,
                const std::function<void(double)>& progress) {
  SoakTuning tuning;
  tuning.linear = linearTuning(laws.problems);
  // The vehicle's mass and the wind are not those of the robust maps.
  tuning.options.robust_estimate_time = 1.0;
  CoreController controller(laws, tuning);
  return soak(controller, tuning, static_cast<int>(laws.maps.size()), options, progress);
}

}  // namespace polyfly_test
