#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// Lines that proofs begin with (CERTIFICATE.md). Numbers are exact.
std::string hex(std::uint64_t value);  ///< 16 digits
std::string hex(double value);         ///< short
void appendMatrix(const char* name, const Eigen::MatrixXd& matrix, std::string& text);
void appendList(const char* name, const std::vector<int>& list, std::string& text);
std::string problemLine(std::string_view problem);  ///< checksum and size of its text
std::string programLines(const ParametricProgram& program);

}  // namespace polyfly
