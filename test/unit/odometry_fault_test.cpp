#include "polyfly_test/odometry_fault.hpp"

#include <gtest/gtest.h>

namespace polyfly {
namespace {

VehicleState odometry() {
  VehicleState state;
  state.stamp = 3.0;
  state.position = Eigen::Vector3d(1.0, 2.0, 3.0);
  state.velocity = Eigen::Vector3d(0.1, 0.2, 0.3);
  return state;
}

TEST(OdometryFault, NothingGoesWrongByDefault) {
  const FaultOptions faults;
  for (double t = 0.0; t < 10.0; t += 0.5) {
    EXPECT_FALSE(isSilent(faults, t));
    EXPECT_EQ(applyFaults(faults, t, odometry()).position, odometry().position);
  }
}

TEST(OdometryFault, EachFaultKeepsItsTime) {
  FaultOptions faults;
  faults.nan_start = 1.0;
  faults.nan_time = 0.5;
  faults.silence_start = 2.0;
  faults.silence_time = 0.25;
  faults.jump_start = 3.0;
  faults.jump_time = 1.0;
  faults.jump = Eigen::Vector3d(0.0, -5.0, 0.0);
  for (int i = 0; i < 500; ++i) {
    const double t = 0.01 * i;
    const VehicleState changed = applyFaults(faults, t, odometry());
    EXPECT_EQ(changed.position.hasNaN(), t >= 1.0 && t < 1.5) << t;
    EXPECT_EQ(isSilent(faults, t), t >= 2.0 && t < 2.25) << t;
    EXPECT_EQ(changed.position.y() == -3.0, t >= 3.0 && t < 4.0) << t;
    EXPECT_EQ(changed.velocity, odometry().velocity);
    EXPECT_EQ(changed.stamp, odometry().stamp);
  }
}

}  // namespace
}  // namespace polyfly
