#pragma once

#include <glpk.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <vector>

namespace polyfly {

/// A linear program as GLPK's simplex method sees it: the tests' second opinion.
struct LpAnswer {
  int status = GLP_UNDEF;  ///< GLP_OPT, GLP_NOFEAS, GLP_UNBND
  double objective = 0.0;
  Eigen::VectorXd z;
};

/// Without ends where it says nothing.
struct LpRange {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

/// min or max c'z, A z and z in ranges.
struct RangedLp {
  Eigen::VectorXd c;
  Eigen::MatrixXd A;
  std::vector<LpRange> rows, columns;
  bool maximise = false;
  double tolerance = 1e-7;  ///< of the simplex method
};

inline int glpkType(const LpRange& range) {
  if (range.lower == range.upper) return GLP_FX;
  if (std::isinf(range.upper)) return std::isinf(range.lower) ? GLP_FR : GLP_LO;
  return std::isinf(range.lower) ? GLP_UP : GLP_DB;
}

/// With `exact` by GLPK's simplex method in rational arithmetic, from the basis that the one in doubles ends with. It takes
/// each double for the simplest fraction within a part in 1e9 of it. GLP_UNDEF where it does not end within 20 s.
inline LpAnswer solveByGlpk(const RangedLp& program, bool exact = false) {
  const std::unique_ptr<glp_prob, decltype(&glp_delete_prob)> lp(glp_create_prob(), &glp_delete_prob);
  glp_term_out(GLP_OFF);
  glp_set_obj_dir(lp.get(), program.maximise ? GLP_MAX : GLP_MIN);
  const int m = static_cast<int>(program.A.rows()), n = static_cast<int>(program.c.size());
  glp_add_cols(lp.get(), n);
  for (int j = 0; j < n; ++j) {
    const LpRange& range = program.columns[static_cast<std::size_t>(j)];
    glp_set_col_bnds(lp.get(), j + 1, glpkType(range), range.lower, range.upper);
    glp_set_obj_coef(lp.get(), j + 1, program.c[j]);
  }
  std::vector<int> index(static_cast<std::size_t>(n) + 1);
  std::iota(index.begin(), index.end(), 0);
  std::vector<double> value(static_cast<std::size_t>(n) + 1);
  if (m > 0) glp_add_rows(lp.get(), m);
  for (int i = 0; i < m; ++i) {
    const LpRange& range = program.rows[static_cast<std::size_t>(i)];
    glp_set_row_bnds(lp.get(), i + 1, glpkType(range), range.lower, range.upper);
    for (int j = 0; j < n; ++j) value[static_cast<std::size_t>(j) + 1] = program.A(i, j);
    glp_set_mat_row(lp.get(), i + 1, n, index.data(), value.data());
  }
  glp_smcp options;
  glp_init_smcp(&options);
  options.msg_lev = GLP_MSG_OFF;
  options.tol_bnd = options.tol_dj = program.tolerance;
  LpAnswer answer;
  glp_smcp first = options;
  // The simplex method may cycle in doubles.
  if (exact) first.it_lim = 5000;
  const int failed = glp_simplex(lp.get(), &first);
  options.tm_lim = exact ? 20000 : options.tm_lim;  // [ms]
  if (exact ? glp_exact(lp.get(), &options) != 0 : failed != 0) return answer;
  answer.status = glp_get_status(lp.get());
  answer.objective = glp_get_obj_val(lp.get());
  answer.z.resize(n);
  for (int j = 0; j < n; ++j) answer.z[j] = glp_get_col_prim(lp.get(), j + 1);
  return answer;
}

/// min g'z s.t. A z <= b, rows in `equalities` with "=".
inline LpAnswer solveByGlpk(const Eigen::VectorXd& g, const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                            const std::vector<int>& equalities = {}, bool exact = false) {
  RangedLp program{g, A, {}, std::vector<LpRange>(static_cast<std::size_t>(g.size()))};
  for (const double upper : std::vector<double>(b.data(), b.data() + b.size()))
    program.rows.emplace_back().upper = upper;
  for (const int i : equalities) program.rows[static_cast<std::size_t>(i)].lower = b[i];
  return solveByGlpk(program, exact);
}

}  // namespace polyfly
