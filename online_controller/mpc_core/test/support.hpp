#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <fstream>
#include <iterator>
#include <string>

#include "polyfly_base/error.hpp"
#include "reference_data.hpp"
#include "spectrum.hpp"

namespace polyfly_test {

using polyfly::problemFile;
using polyfly::projectRoot;
using polyfly::referenceData;

inline std::string fileText(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
}

/// `text` with the one occurrence of `from` replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t place = text.find(from);
  EXPECT_NE(place, std::string::npos) << "no '" << from << "'";
  if (place == std::string::npos) return text;
  EXPECT_EQ(text.find(from, place + 1), std::string::npos) << "'" << from << "' is not unique";
  return text.replace(place, from.size(), to);
}

/// 1-based line of the first occurrence of `part`.
inline int lineOf(const std::string& text, const std::string& part) {
  const std::size_t place = text.find(part);
  EXPECT_NE(place, std::string::npos) << "no '" << part << "'";
  int line = 1;
  for (std::size_t i = 0; i < place && i < text.size(); ++i) line += text[i] == '\n' ? 1 : 0;
  return line;
}

/// The message of the polyfly::Error that `action` throws.
template <typename Action>
std::string errorOf(const Action& action) {
  try {
    action();
  } catch (const polyfly::Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "no polyfly::Error";
  return {};
}

inline double maxAbs(const Eigen::MatrixXd& matrix) {
  return matrix.size() == 0 ? 0.0 : matrix.cwiseAbs().maxCoeff();
}

/// exp(matrix) by its power series in long double after halving, squared back: slow, simple, accurate.
inline Eigen::MatrixXd exponentialSeries(const Eigen::MatrixXd& matrix) {
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  constexpr int kHalvings = 10;
  constexpr int kTerms = 40;
  const Matrix small = matrix.cast<long double>() / static_cast<long double>(1 << kHalvings);
  Matrix term = Matrix::Identity(matrix.rows(), matrix.cols());
  Matrix sum = term;
  for (int k = 1; k <= kTerms; ++k) {
    term = (term * small / static_cast<long double>(k)).eval();
    sum += term;
  }
  for (int k = 0; k < kHalvings; ++k) sum = (sum * sum).eval();
  return sum.cast<double>();
}

}  // namespace polyfly_test
