#include "polyfly_test/slung_load.hpp"

#include <algorithm>

namespace polyfly {

Eigen::Vector3d SlungLoad::pull(const Eigen::Vector3d& offset, const Eigen::Vector3d& velocity) const {
  const double distance = offset.norm();
  if (distance <= length) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d direction = offset / distance;
  // A string cannot push, however fast it shortens.
  const double tension = std::max(0.0, stiffness * (distance - length) + damping * direction.dot(velocity));
  return tension * direction;
}

}  // namespace polyfly
