#pragma once

#include <utility>
#include <vector>

#include "arithmetic/exact_matrix.hpp"
#include "exact_kkt/exact_ranges.hpp"
#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// Numbers that prove rows to hold with equality wherever the program is feasible: the sum of weight times
/// row, in z, b and S alike, is zero, and the weights of inequalities are positive.
using ZeroCombination = std::vector<std::pair<int, Integer>>;

/// What is certified in place of the program as it was given; nothing, where all fields are empty.
struct ProgramPerturbation {
  /// H + penalty A_e'A_e, over the equalities, is positive semidefinite.
  double penalty = 0.0;
  /// Rows that others imply up to rounding, ascending.
  std::vector<int> dropped;
  /// H is zero: of several optima that of the least sum of 2^weights[j] z_j^2 counts. Empty: they are all the same.
  std::vector<int> weights;
  /// Independent rows taken as equalities. All other equalities follow from them.
  std::vector<int> basis;
  /// Proofs that the inequalities in the basis are implied equalities.
  std::vector<ZeroCombination> implied;
};

/// The numbers of a program, matrices by rows. All but those of E, C and c have a power of two as denominator.
struct RationalProgram {
  std::vector<Rational> H, f, F, A, b, S, A_theta, b_theta, E, C, c;
};

/// A ParametricProgram in whole numbers. Its doubles are taken at their exact values; parameters are
/// theta = centre + half .* t, with t in [-1, 1]^p; an affine function of t is p + 1 numbers, constant last.
///
///     H z + cost (t, 1) + A' lambda = 0,   A z + slack = bound (t, 1)
///
/// in z and t multiplied by 2^shift, each row by a power of two of its own, H and cost by another: signs are
/// those of the program.
struct ExactProgram : ExactRanges {
  ExactProgram(const ParametricProgram& program, const ProgramPerturbation& adjustment);
  /// With `numbers` in place of those of `program`, which has the sizes, the box and whether H is zero.
  ExactProgram(const ParametricProgram& program, const RationalProgram& numbers,
               const ProgramPerturbation& adjustment);

  int n = 0;
  int m = 0;
  int p = 0;
  int q = 0;
  bool linear = false;  ///< H = 0; `H` is then that of the weights: of several optima the shortest
  long shift = 0;
  long H_exponent = 0;             ///< H and cost are multiplied by 2^H_exponent
  std::vector<long> row_exponent;  ///< m, row i of A and bound is multiplied by 2^row_exponent[i]
  IntegerMatrix H;
  IntegerMatrix cost;             ///< n x (p + 1)
  IntegerMatrix A;                ///< m x n
  IntegerMatrix bound;            ///< m x (p + 1)
  IntegerMatrix domain;           ///< rows >= 0 from A_theta
  std::vector<Rational> E;        ///< q x n, u = E z + offset (t, 1), z not shifted
  std::vector<Rational> offset;   ///< q x (p + 1)
  std::vector<int> basis;         ///< ProgramPerturbation::basis
  std::vector<char> in_basis;     ///< m
  std::vector<char> is_equality;  ///< m, of the program
  std::vector<char> is_dropped;   ///< m
  bool forgiving = false;         ///< slacks may be negative by rounding, see ExactRegion::forgiven
  std::vector<Integer> row_size;  ///< m, greatest |entry| of the row of A
};

/// How far below zero a dropped inequality's slack may be, relative to the row's greatest entry:
/// 2^-kDroppedBits.
constexpr int kDroppedBits = 30;

/// By how much a forgiven slack may be negative, or a dropped equality may fail, relative to the row's greatest
/// entry: 2^-kForgivenBits.
constexpr int kForgivenBits = 40;

/// H, symmetric, by rows. `penalty` times A_e'A_e over the rows of `basis` is added.
std::vector<Rational> hessian(const ParametricProgram& program, const std::vector<int>& basis,
                              double penalty);

/// Finds what has to be adjusted. `may_drop` tells which rows no region of the map counts as active. Throws
/// Error when the equalities contradict each other, or H is neither zero nor positive definite where they
/// leave z free.
ProgramPerturbation adjust(const ParametricProgram& program, const std::vector<char>& may_drop);

}  // namespace polyfly
