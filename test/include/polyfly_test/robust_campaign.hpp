#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "online_controller/laws/axis.hpp"
#include "region_maps/region_map.hpp"
#include "robust_mpc/robust_problem.hpp"

namespace polyfly_test {

/// How the disturbance is chosen at each step, within `share` of its bound.
enum class Adversary {
  /// Uniformly distributed within the bound.
  kRandom,
  /// Either bound, changed at random steps.
  kTelegraph,
  /// Bound that pushes the position outwards, judged by the position some steps ahead.
  kWorst,
  /// Bound after which the least peak that can be promised is greatest.
  kGreedy,
};

/// A lateral axis in discrete time with its robust map, the controllers beside it, and all adversaries.
class RobustCampaign {
 public:
  enum class Controller { kRobust, kLqr, kNominalMpc };

  /// Solves `problem_file` (region_maps/problems/reference/robust_lateral.yaml). `nominal` is a tracking MPC
  /// of the same model; maps are written to `folder`. Throws Error.
  RobustCampaign(const std::string& problem_file, const std::string& folder);

  struct Options {
    Controller controller = Controller::kRobust;
    Adversary adversary = Adversary::kRandom;
    std::uint64_t seed = 1;
    int flights = 100;
    int steps = 125;
    /// Share of the bound in the first half of the flight.
    double share = 1.0;
    /// Share of the bound in the second half of the flight.
    double late_share = 1.0;
    /// True: start at the origin. False: start at a random state with a plan, |p| <= 1.5 m.
    bool from_origin = false;
  };

  struct Result {
    std::uint64_t steps = 0;
    /// Steps that end with a state beyond its range.
    std::uint64_t violations = 0;
    /// Greatest excess over a state range, in half ranges.
    double worst_violation = 0.0;
    /// Steps at which the robust program had no plan.
    std::uint64_t infeasible = 0;
    /// Steps without a plan in the last quarter of a flight.
    std::uint64_t late_degraded = 0;
    /// Steps after which |p| is above the tau from before the step.
    std::uint64_t broken_promises = 0;
    /// Greatest |p| [m].
    double peak = 0.0;
    /// Greatest tau [m].
    double peak_promised = 0.0;
    double greatest_speed = 0.0;  ///< [m/s]
    /// Greatest |p| in the last quarter of a flight [m].
    double last_position = 0.0;
    bool finite = true;

    void add(const Result& other);
  };
  Result fly(const Options& options) const;

 private:
  double command(Controller controller, const Eigen::Vector3d& x, bool& degraded) const;
  double promise(const Eigen::Vector3d& x) const;  ///< tau; infinite without a plan
  double choose(const Options& options, double share, const Eigen::Vector3d& x, double u, double uniform,
                double& telegraph) const;

  Eigen::Matrix3d A_;
  Eigen::Vector3d B_, G_, range_;
  Eigen::RowVector3d K_;
  double input_range_ = 0.0;
  std::unique_ptr<polyfly::RegionMap> map_;
  std::unique_ptr<polyfly::RegionMap> peak_map_;
  std::unique_ptr<polyfly::RegionMap> nominal_map_;
  std::unique_ptr<polyfly::Axis> axis_;
};

}  // namespace polyfly_test
