#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// A record of a count's proof, as COUNT.md states it.
struct CountedSet {
  std::vector<int> rows;
  std::vector<mpq_class> theta;
};

inline std::vector<CountedSet> readCountProof(const ParametricProgram& program, const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string line;
  while (std::getline(file, line) && line.rfind("records ", 0) != 0) {
  }
  std::vector<CountedSet> sets;
  const std::size_t key = (static_cast<std::size_t>(program.rowCount()) + 7) / 8;
  std::vector<char> bytes(key + 5 * program.parameters.size());
  while (file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    CountedSet& set = sets.emplace_back();
    for (int i = 0; i < program.rowCount(); ++i) {
      if ((bytes[static_cast<std::size_t>(i) / 8] >> i % 8 & 1) != 0) set.rows.push_back(i);
    }
    for (std::size_t j = 0; j < program.parameters.size(); ++j) {
      std::int64_t steps = static_cast<int>(static_cast<signed char>(bytes[key + 5 * j + 4]));
      for (std::size_t k = 4; k-- > 0;)
        steps = steps * 256 + static_cast<unsigned char>(bytes[key + 5 * j + k]);
      const mpq_class lower(program.parameters[j].lower), upper(program.parameters[j].upper);
      set.theta.push_back((lower + upper) / 2 + (upper - lower) / 2 * mpq_class(static_cast<long>(steps)) /
                                                    mpq_class(std::ldexp(1.0, 39)));
    }
  }
  return sets;
}

/// Solves M x = r by elimination; false where M is singular.
inline bool solveFractions(std::vector<std::vector<mpq_class>> M, std::vector<mpq_class>& x) {
  const std::size_t n = M.size();
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t pivot = c;
    while (pivot < n && M[pivot][c] == 0) ++pivot;
    if (pivot == n) return false;
    std::swap(M[c], M[pivot]);
    for (std::size_t r = 0; r < n; ++r) {
      if (r == c || M[r][c] == 0) continue;
      const mpq_class factor = M[r][c] / M[c][c];
      for (std::size_t j = c; j <= n; ++j) M[r][j] -= factor * M[c][j];
    }
  }
  x.clear();
  for (std::size_t r = 0; r < n; ++r) x.push_back(M[r][n] / M[r][r]);
  return true;
}

/// Whether the set is the active one at theta, strictly: (z, lambda) of H z + f + F theta + A'lambda = 0 and
/// the active rows with equality is unique, theta inside, multipliers and all other slacks positive. Rows in
/// `silent` may be anything. H must be positive definite.
inline bool strictlyOptimal(const ParametricProgram& program, const CountedSet& set,
                            const std::vector<int>& silent = {}) {
  const auto n = static_cast<std::size_t>(program.variableCount());
  const auto p = static_cast<std::size_t>(program.parameterCount());
  std::vector<int> rows(program.equalities.begin(), program.equalities.end());
  rows.insert(rows.end(), set.rows.begin(), set.rows.end());
  const auto affine = [&](const Eigen::MatrixXd& M, const Eigen::VectorXd& v, Eigen::Index row) {
    mpq_class sum(v(row));
    for (std::size_t j = 0; j < p; ++j) sum += mpq_class(M(row, static_cast<Eigen::Index>(j))) * set.theta[j];
    return sum;
  };
  for (std::size_t j = 0; j < p; ++j) {
    if (set.theta[j] <= program.parameters[j].lower || set.theta[j] >= program.parameters[j].upper)
      return false;
  }
  for (Eigen::Index i = 0; i < program.A_theta.rows(); ++i) {
    mpq_class room(program.b_theta(i));
    for (std::size_t j = 0; j < p; ++j)
      room -= mpq_class(program.A_theta(i, static_cast<Eigen::Index>(j))) * set.theta[j];
    if (room <= 0) return false;
  }
  const std::size_t size = n + rows.size();
  std::vector<std::vector<mpq_class>> M(size, std::vector<mpq_class>(size + 1));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j)
      M[i][j] = program.H(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    for (std::size_t r = 0; r < rows.size(); ++r)
      M[i][n + r] = M[n + r][i] = program.A(rows[r], static_cast<Eigen::Index>(i));
    M[i][size] = -affine(program.F, program.f, static_cast<Eigen::Index>(i));
  }
  for (std::size_t r = 0; r < rows.size(); ++r) M[n + r][size] = affine(program.S, program.b, rows[r]);
  std::vector<mpq_class> x;
  if (!solveFractions(M, x)) return false;
  for (std::size_t r = program.equalities.size(); r < rows.size(); ++r) {
    if (x[n + r] <= 0) return false;
  }
  for (int i = 0; i < program.rowCount(); ++i) {
    const auto in = [i](const std::vector<int>& list) {
      return std::find(list.begin(), list.end(), i) != list.end();
    };
    if (in(rows) || in(silent)) continue;
    mpq_class slack = affine(program.S, program.b, i);
    for (std::size_t j = 0; j < n; ++j) slack -= mpq_class(program.A(i, static_cast<Eigen::Index>(j))) * x[j];
    if (slack <= 0) return false;
  }
  return true;
}

}  // namespace polyfly
