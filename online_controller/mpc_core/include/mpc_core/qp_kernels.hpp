#pragma once

namespace polyfly {

/// Dense linear algebra of the size of a control problem, on columns that start `stride` numbers apart.
/// Sizes `n` are multiples of kPack; what is added to a matrix to reach one is the identity, to a vector 0.
struct QpKernels {
  /// Overwrites the lower triangle of a symmetric matrix by its Cholesky factor L. `blocks` takes the
  /// inverses of its diagonal blocks: for each block of kPack columns the inverse by columns, then by rows. A
  /// pivot must exceed `relative` times the diagonal entry: returns the first one that does not, or n. The
  /// leading `done` rows and columns, whole packs, are a factor already; the bits are the same as without.
  int (*factorise)(double* matrix, int n, int stride, double relative, double* blocks, int done);

  void (*solveLower)(const double* factor, const double* blocks, int n, int stride, double* x);  ///< L x = x
  void (*solveUpper)(const double* factor, const double* blocks, int n, int stride, double* x);  ///< L' x = x

  /// y += sum_j x_j (column columns[j] of M), n rows; with `columns` nullptr the first `count` columns.
  void (*addColumns)(const double* matrix, int n, int stride, const int* columns, int count, const double* x,
                     double* y);

  /// One sweep of Gauss and Seidel over the first n of `packed` variables, each moved to its minimum within
  /// its bounds. `gradient` is that of 1/2 x'Mx + g'x at x and is kept so.
  void (*sweep)(const double* matrix, int n, int packed, int stride, const double* lower, const double* upper,
                double* gradient, double* x);

  void (*addMultiple)(int n, double factor, const double* x, double* y);  ///< y += factor x
  double (*dot)(int n, const double* x, const double* y);

  /// Greatest magnitude; not finite if an entry is not.
  double (*greatest)(int n, const double* x);
};

constexpr int kPack = 4;
constexpr int kBlockInverse = 2 * kPack * kPack;  ///< numbers in `blocks` for each kPack columns

constexpr int wholePacks(int n) { return (n + kPack - 1) / kPack * kPack; }

/// The fastest version that this processor runs. All versions give the same bits: they do the same operations
/// in the same order, and none fuses a product with a sum.
const QpKernels& qpKernels() noexcept;

/// The version for any processor.
const QpKernels& plainQpKernels() noexcept;

}  // namespace polyfly
