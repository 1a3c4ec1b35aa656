#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>

#include "loaded_map.hpp"

namespace polyfly::python {

/// VerifyReport, or RobustSampling for the map of a robust problem.
pybind11::object verifyMap(const LoadedMap& map, std::uint64_t samples, std::uint64_t seed, double tolerance,
                           int threads, pybind11::object progress);

/// CertifyReport, or RobustProof for the map of a robust problem.
pybind11::object certifyMap(const LoadedMap& map, int threads, pybind11::object progress);

}  // namespace polyfly::python
