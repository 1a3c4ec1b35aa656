#pragma once

#include <algorithm>

#include "fixedwing_lateral/lateral_nmpc.hpp"

namespace lateral_test {

struct IterationReport : polyfly::NmpcReport {
  int iterations = 0;
};

/// Iterations until the KKT measure is below the tolerance, at most `most` (at least one).
inline IterationReport iterate(polyfly::LateralNmpc& nmpc, const polyfly::HorizonData& data,
                               const polyfly::LateralState& state, int most, double tolerance) {
  IterationReport report;
  for (int i = 0; i < std::max(most, 1); ++i) {
    nmpc.prepare(data);
    static_cast<polyfly::NmpcReport&>(report) = nmpc.feedback(state);
    if (i > 0 && report.kkt < tolerance) break;
    report.iterations = i + 1;
    if (!report.hasMoves()) break;
  }
  return report;
}

/// Derivatives of a step by the state and, in the last column, by the roll reference.
using StepJacobian = Eigen::Matrix<double, polyfly::LateralIndex::kSize, polyfly::LateralIndex::kSize + 1>;

/// By differences of fourth order.
inline StepJacobian stepByDifferences(const polyfly::LateralModel& model,
                                      const polyfly::LateralConditions& conditions,
                                      const polyfly::LateralState& state, const polyfly::LateralStep& step) {
  constexpr double kDifference = 1e-3;
  StepJacobian jacobian;
  for (Eigen::Index column = 0; column < StepJacobian::ColsAtCompileTime; ++column) {
    const auto at = [&](double change) {
      polyfly::LateralState moved = state;
      polyfly::LateralStep flown = step;
      (column < state.size() ? moved[column] : flown.roll_reference) += change;
      return integrate(model, conditions, moved, flown);
    };
    jacobian.col(column) =
        (8.0 * (at(kDifference) - at(-kDifference)) - at(2.0 * kDifference) + at(-2.0 * kDifference)) /
        (12.0 * kDifference);
  }
  return jacobian;
}

}  // namespace lateral_test
