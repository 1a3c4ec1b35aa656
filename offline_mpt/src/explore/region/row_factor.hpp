#pragma once

#include <cstddef>
#include <vector>

#include "explore/sets/active_set_list.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// Matrices of a NormalisedProgram by rows, so that inner loops run along memory.
struct RowTables {
  explicit RowTables(const NormalisedProgram& program);

  const double* products(int row) const { return gram.data() + static_cast<std::size_t>(row) * m; }
  const double* bound(int row) const { return D.data() + static_cast<std::size_t>(row) * width; }
  const double* normal(int row) const { return M.data() + static_cast<std::size_t>(row) * n; }

  std::size_t m, n, width;     ///< width: p + 1
  std::vector<double> gram;    ///< m x m
  std::vector<double> D;       ///< m x (p + 1)
  std::vector<double> M;       ///< m x n
  std::vector<double> D_size;  ///< m; greatest |entry| of each row of D
};

/// Cholesky factor of the products of active rows. One object, one thread.
class RowFactor {
 public:
  RowFactor(const NormalisedProgram& program, const RowTables& tables) : program_(program), tables_(tables) {}

  /// False where the rows are linearly dependent.
  bool factorise(const ActiveSet& active);

  // The rest is about the set that was factorised last.

  /// Solves (products of active rows) X = X in place for `width` right-hand sides lying side by side.
  void solve(double* x, std::size_t width) const;
  /// Least distance of a row from the span of those before it; at most 1.
  double pivot() const { return pivot_; }
  /// Whether `row` lies in the span of the active rows, with their weights(). `active` is the set factorised.
  /// `is_sound`: the pivots alone may show that the active rows span all there is.
  bool depends(const ActiveSet& active, int row, bool is_sound);
  /// Weights of the active rows in the last row that depends() asked for.
  const std::vector<double>& weights() const { return weights_; }

 private:
  bool factoriseRows(const ActiveSet& active);
  void findWeights(const ActiveSet& active, int row, double& squared);
  void refineWeights(const ActiveSet& active, int row);

  const NormalisedProgram& program_;
  const RowTables& tables_;
  // Lower triangle.
  std::vector<double> factor_;  // k x k
  // Inverse of each diagonal entry of factor_.
  std::vector<double> inverse_;
  double pivot_ = 1.0;
  std::vector<double> weights_;
  std::vector<double> column_;
};

}  // namespace polyfly
