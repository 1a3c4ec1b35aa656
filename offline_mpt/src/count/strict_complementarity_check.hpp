#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "count/strict_complementarity_system.hpp"

namespace polyfly {

/// A parameter at which one active set alone is optimal.
struct Witness {
  std::vector<std::int64_t> t;  ///< p, in units of kWitnessStep
  bool law_apart = false;       ///< its law is no other's, see LawSeparation
};

/// Shows that active sets have critical regions with an interior. At some parameter strictly inside the
/// box and A_theta, the active rows (with the equalities) are independent, their multipliers positive and the
/// slacks of all other rows, too, by far more than rounding can change. H being positive definite, that is
/// the one solution there; multipliers and slacks are continuous, so the set is optimal in a ball around it,
/// of radius kLeastRadius at least. A row that is an exact positive multiple of an active one says nothing.
/// One object, one thread.
class StrictComplementarityCheck {
 public:
  static constexpr int kNone = -1;  ///< no row

  /// `gap`: m, slacks beyond which laws are apart, of rows of unit length; empty: never.
  StrictComplementarityCheck(const StrictComplementaritySystem& system, const std::vector<double>& gap);

  /// Looks along from + s direction, s > 0, |direction| = 1. `set`: rows of the program without equalities.
  bool onRay(const std::vector<int>& set, const double* from, const double* direction, Witness& witness);

  /// Row of the set whose multiplier vanishes first as that of `entering`, which depends on the set's rows,
  /// grows at `from`; kNone where it is independent, or none does.
  int leaving(const std::vector<int>& set, int entering, const double* from);

  /// Looks at t, the centre of a ball of radius `radius` of which every parameter satisfies the conditions
  /// but for rounding.
  bool at(const std::vector<int>& set, const double* t, double radius, Witness& witness);

 private:
  void evaluate(const double* t);
  void differentiate(const double* direction);
  double edge(const double* direction) const;
  bool take(const std::vector<int>& set);
  bool invert();
  void solve(const Eigen::VectorXd& distances, Eigen::VectorXd& values);
  void carry(const Eigen::VectorXd& distances, Eigen::VectorXd& values);
  void findDoubts();
  bool accept(const Eigen::VectorXd& t, double radius, Witness& witness);

  const StrictComplementaritySystem& system_;
  const std::vector<double>& gap_;
  Eigen::MatrixXd size_;  // |gram|
  // Active rows, with the equalities.
  std::vector<int> active_;
  // What has to hold for each row.
  std::vector<char> state_;  // m
  // Inverse of the Cholesky factor of the active rows' gram matrix, lower triangular.
  Eigen::MatrixXd factor_;
  // Inverse of the active rows' gram matrix.
  Eigen::MatrixXd inverse_;
  // Multipliers of active rows, slacks of all others.
  Eigen::VectorXd values_;  // m
  // Change of values_ along a ray.
  Eigen::VectorXd changes_;  // m
  // Upper bounds of the slope of values_ in t.
  Eigen::VectorXd slopes_;  // m
  // Errors of values_ by rounding.
  Eigen::VectorXd doubts_;  // m
  // The point at which values_ are evaluated.
  Eigen::VectorXd point_;  // p
  // Work space.
  Eigen::VectorXd distances_, right_, multipliers_;
};

/// Whether a witness lies in the box and in A_theta, off their edges.
bool insideDomain(const StrictComplementaritySystem& system, const Witness& witness);

}  // namespace polyfly
