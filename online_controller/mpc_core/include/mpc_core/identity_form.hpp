#pragma once

#include <optional>

#include "mpc_core/parametric_program.hpp"
#include "mpc_core/wide_matrix.hpp"

namespace polyfly {

/// min_z 1/2 z'Hz + (cost x)'z, A z <= bound x, u = E z + offset x, with x = (parameters, 1).
struct AffineProgram {
  WideMatrix H;       ///< n x n
  WideMatrix cost;    ///< n x w
  WideMatrix A;       ///< m x n
  WideMatrix bound;   ///< m x w
  WideMatrix E;       ///< q x n
  WideMatrix offset;  ///< q x w
};

/// The program in its own parameters.
AffineProgram affineProgram(const ParametricProgram& program);

/// The same in v = L'z + L^-1 cost x with H = L L', where the cost is 1/2 v'v: rounding this form to doubles costs the
/// root of H's condition in accuracy, not the condition.
///
///     rows v <= slack x,   u = law x + output v
///
/// Rows that do not depend on z are zero, and have the length 1.
struct IdentityForm {
  WideMatrix root;         ///< L, n x n
  WideMatrix rows;         ///< A L^-T, m x n, of unit length
  Eigen::VectorXd length;  ///< m, the lengths that they had
  WideMatrix slack;        ///< m x w, of the unconstrained minimiser
  WideMatrix output;       ///< E L^-T, q x n
  WideMatrix law;          ///< q x w, of the unconstrained minimiser
  /// sqrt(H_ii) / L_ii at most: about the root of H's condition where its diagonal is scaled to one.
  double root_condition = 1.0;
};

/// None where H is not positive definite, or so little that 32 digits do not tell.
std::optional<IdentityForm> identityForm(const AffineProgram& program);

/// The root alone.
std::optional<WideMatrix> choleskyRoot(const WideMatrix& H);

}  // namespace polyfly
