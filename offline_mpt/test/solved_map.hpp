#pragma once

#include <vector>

#include "map_in_memory.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"

namespace polyfly {

/// The map of a program that is explored to its end.
inline MapContent solved(const ParametricProgram& program) { return encode(program, explore(program)); }

inline CertifyReport certified(const MapContent& content, const ParametricProgram& program,
                               const CertifyOptions& options = {}) {
  return certify(MapInMemory(content).map(), program, options);
}
inline CertifyReport certified(const Partition& partition, const ParametricProgram& program) {
  return certified(encode(program, partition), program);
}
inline CertifyReport certified(const ParametricProgram& program) {
  return certified(solved(program), program);
}

/// The regions that hold a parameter, up to a scaled distance.
inline std::vector<CriticalRegion> holders(const Partition& partition, const Eigen::VectorXd& theta,
                                           double distance = 1e-9) {
  std::vector<CriticalRegion> found;
  for (const CriticalRegion& region : partition.regions) {
    if ((region.G * theta - region.g).maxCoeff() <= distance) found.push_back(region);
  }
  return found;
}

}  // namespace polyfly
