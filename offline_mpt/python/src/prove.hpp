#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <variant>

#include "loaded_map.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/verify.hpp"
#include "robust_mpc/prove_map.hpp"

namespace polyfly::python {

/// RobustSampling for the map of a robust problem.
std::variant<VerifyReport, RobustSampling> verifyMap(const LoadedMap& map, std::uint64_t samples,
                                                     std::uint64_t seed, double tolerance, int threads,
                                                     pybind11::object progress);

/// RobustProof for the map of a robust problem.
std::variant<CertifyReport, RobustProof> certifyMap(const LoadedMap& map, int threads,
                                                    pybind11::object progress);

}  // namespace polyfly::python
