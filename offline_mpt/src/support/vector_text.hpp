#pragma once

#include <Eigen/Core>
#include <cstdio>
#include <string>
#include <vector>

namespace polyfly {

/// "(1, 2.5)", with as many digits as give the same numbers when they are read again.
inline std::string vectorText(const Eigen::VectorXd& vector) {
  std::string text = "(";
  char number[32];
  for (Eigen::Index i = 0; i < vector.size(); ++i) {
    std::snprintf(number, sizeof number, "%s%.17g", i > 0 ? ", " : "", vector[i]);
    text += number;
  }
  return text + ")";
}

inline std::vector<double> numbersOf(const Eigen::VectorXd& vector) {
  return {vector.data(), vector.data() + vector.size()};
}

}  // namespace polyfly
