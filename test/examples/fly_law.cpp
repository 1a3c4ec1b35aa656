// Flies a multirotor one metre forward and up by its maps: fly_law LONGITUDINAL LATERAL VERTICAL
#include <Eigen/Geometry>
#include <cstdio>

#include "online_controller/laws/multirotor_controller.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::fprintf(stderr, "usage: fly_law LONGITUDINAL LATERAL VERTICAL\n");
    return 2;
  }
  const polyfly::RegionMap maps[] = {polyfly::RegionMap::open(argv[1]), polyfly::RegionMap::open(argv[2]),
                                     polyfly::RegionMap::open(argv[3])};
  const polyfly::MultirotorOptions options;
  polyfly::MultirotorController law({&maps[0], &maps[1], &maps[2]}, options);
  polyfly::VehicleState state;
  polyfly::Reference goal;
  goal.position = {1.0, 0.0, 1.0};
  const double period = options.control_period;
  const double lag = 0.2;  // of the attitude loops [s]
  for (int k = 0; k < 600; ++k) {
    const polyfly::AttitudeCommand command = law.step(state, goal).command;
    const Eigen::Quaterniond wanted = Eigen::AngleAxisd(command.pitch, Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(command.roll, Eigen::Vector3d::UnitX());
    state.attitude = state.attitude.slerp(period / lag, wanted);
    const Eigen::Vector3d lift = state.attitude * Eigen::Vector3d(0.0, 0.0, command.thrust / options.mass);
    state.velocity += period * (lift - Eigen::Vector3d(0.0, 0.0, options.gravity));
    state.position += period * state.velocity;
    state.stamp += period;
  }
  std::printf("%.4f\n", (state.position - goal.position).norm());
  return 0;
} catch (const polyfly::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
