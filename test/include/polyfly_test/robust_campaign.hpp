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
  kRandom,     ///< uniform
  kTelegraph,  ///< either bound, changed now and then
  kWorst,      ///< the bound that pushes the position outwards, as it is some steps ahead
  kGreedy,     ///< the bound after which the least peak that can be promised is greatest
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
    double share = 1.0;        ///< of the bound, in the first half of the flight
    double late_share = 1.0;   ///< in the second half
    bool from_origin = false;  ///< else from a random state with a plan, |p| <= 1.5 m
  };

  struct Result {
    std::uint64_t steps = 0;
    std::uint64_t violations = 0;       ///< steps that end with a state beyond its range
    double worst_violation = 0.0;       ///< in half ranges
    std::uint64_t infeasible = 0;       ///< steps at which the robust program had no plan
    std::uint64_t late_degraded = 0;    ///< of these, in the last quarter of a flight
    std::uint64_t broken_promises = 0;  ///< |p| after a step above tau before it
    double peak = 0.0;                  ///< greatest |p| [m]
    double peak_promised = 0.0;         ///< greatest tau [m]
    double greatest_speed = 0.0;        ///< [m/s]
    double last_position = 0.0;         ///< greatest |p| in the last quarter [m]
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
