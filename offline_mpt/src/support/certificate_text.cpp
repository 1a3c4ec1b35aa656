#include "support/certificate_text.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdio>

#include "polyfly_base/provenance.hpp"

namespace polyfly {

std::string hex(std::uint64_t value) { return hexDigits(value); }

std::string hex(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%a", value);
  return text;
}

void appendMatrix(const char* name, const Eigen::MatrixXd& matrix, std::string& text) {
  text += std::string(name) + " " + std::to_string(matrix.rows()) + " " + std::to_string(matrix.cols());
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) text += " " + hex(matrix(i, j));
  }
  text += "\n";
}

void appendList(const char* name, const std::vector<int>& list, std::string& text) {
  text += std::string(name) + " " + std::to_string(list.size());
  for (const int value : list) text += " " + std::to_string(value);
  text += "\n";
}

std::string problemLine(std::string_view problem) {
  return "problem " + hex(static_cast<std::uint64_t>(XXH64(problem.data(), problem.size(), 0))) + " " +
         std::to_string(problem.size()) + "\n";
}

std::string programLines(const ParametricProgram& program) {
  std::string text;
  Eigen::MatrixXd box(program.parameterCount(), 2);
  for (int j = 0; j < program.parameterCount(); ++j)
    box.row(j) << program.parameters[static_cast<std::size_t>(j)].lower,
        program.parameters[static_cast<std::size_t>(j)].upper;
  appendMatrix("box", box, text);
  appendMatrix("H", program.H, text);
  appendMatrix("f", program.f, text);
  appendMatrix("F", program.F, text);
  appendMatrix("A", program.A, text);
  appendMatrix("b", program.b, text);
  appendMatrix("S", program.S, text);
  appendMatrix("A_theta", program.A_theta, text);
  appendMatrix("b_theta", program.b_theta, text);
  appendMatrix("E", program.E, text);
  appendMatrix("C", program.C, text);
  appendMatrix("c", program.c, text);
  appendList("equalities", program.equalities, text);
  return text;
}

}  // namespace polyfly
