#include "online_controller/reference/reference_excess.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

namespace polyfly {
namespace {

constexpr const char* kDistance = "reference_limits/distance";
constexpr const char* kSpeed = "reference_limits/speed";

}  // namespace

ReferenceExcess findExcess(const ReferenceTrajectory& trajectory, const Eigen::Vector3d* vehicle,
                           const ReferenceLimits& limits) noexcept {
  const std::vector<TrajectorySample>& samples = trajectory.samples();
  const bool pose = samples.size() == 1;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto exceeds = [&](const char* limit, double value, double most) {
      return ReferenceExcess{limit, value, most, i, pose};
    };
    if (vehicle != nullptr) {
      const Eigen::Vector3d way = samples[i].position - *vehicle;
      // Written so that NaN is too much.
      if (!(way.norm() <= limits.distance)) return exceeds(kDistance, way.norm(), limits.distance);
    }
    if (pose) break;
    double speed = samples[i].velocity.norm();
    if (i + 1 < samples.size()) {
      const double midway = 0.5 * (samples[i].time + samples[i + 1].time);
      speed = std::max(speed, trajectory.sample(midway).velocity.norm());
    }
    if (!(speed <= limits.speed)) return exceeds(kSpeed, speed, limits.speed);
  }
  return {};
}

std::string describe(const ReferenceExcess& excess) {
  std::ostringstream text;
  if (excess.pose) {
    text << "pose: ";
  } else {
    text << "trajectory: sample " << excess.sample << ": ";
  }
  if (excess.limit == kSpeed) {
    text << "asks for " << excess.value << " m/s, more than " << kSpeed << ", " << excess.most << " m/s";
  } else {
    text << "lies " << excess.value << " m from the vehicle, more than " << kDistance << ", " << excess.most
         << " m";
  }
  return text.str();
}

}  // namespace polyfly
