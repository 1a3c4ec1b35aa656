#pragma once

#include <glpk.h>

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace polyfly {

/// A linear program as GLPK's simplex method sees it: the tests' second opinion.
struct LpAnswer {
  int status = GLP_UNDEF;  ///< GLP_OPT, GLP_NOFEAS, GLP_UNBND
  double objective = 0.0;
  Eigen::VectorXd z;
};

/// min g'z s.t. A z <= b, rows in `equalities` with "="; with `exact` by GLPK's simplex method in rational
/// arithmetic, from the basis that the one in doubles ends with. It takes each double for the simplest
/// fraction within a part in 1e9 of it. GLP_UNDEF where it does not end within 20 s.
inline LpAnswer solveByGlpk(const Eigen::VectorXd& g, const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                            const std::vector<int>& equalities = {}, bool exact = false) {
  const std::unique_ptr<glp_prob, decltype(&glp_delete_prob)> lp(glp_create_prob(), &glp_delete_prob);
  glp_term_out(GLP_OFF);
  const int m = static_cast<int>(A.rows()), n = static_cast<int>(A.cols());
  glp_add_cols(lp.get(), n);
  for (int j = 0; j < n; ++j) {
    glp_set_col_bnds(lp.get(), j + 1, GLP_FR, 0.0, 0.0);
    glp_set_obj_coef(lp.get(), j + 1, g[j]);
  }
  std::vector<int> index(static_cast<std::size_t>(n) + 1);
  std::vector<double> value(static_cast<std::size_t>(n) + 1);
  if (m > 0) glp_add_rows(lp.get(), m);
  for (int i = 0; i < m; ++i) {
    glp_set_row_bnds(lp.get(), i + 1, GLP_UP, 0.0, b[i]);
    for (int j = 0; j < n; ++j) {
      index[static_cast<std::size_t>(j) + 1] = j + 1;
      value[static_cast<std::size_t>(j) + 1] = A(i, j);
    }
    glp_set_mat_row(lp.get(), i + 1, n, index.data(), value.data());
  }
  for (const int i : equalities) glp_set_row_bnds(lp.get(), i + 1, GLP_FX, b[i], b[i]);
  glp_smcp options;
  glp_init_smcp(&options);
  options.msg_lev = GLP_MSG_OFF;
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

}  // namespace polyfly
