#include "program/normalised_program.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "arithmetic/tolerances.hpp"
#include "mpc_core/decompositions.hpp"
#include "mpc_core/scaled_program.hpp"
#include "polyfly_base/error.hpp"
#include "program/definite_hessian.hpp"
#include "program/program_rows.hpp"
#include "program/repeated_rows.hpp"
#include "program/tolerances.hpp"

namespace polyfly {
namespace {

/// Columns (t, 1) -> columns of theta: M theta + v = M half .* t + (M centre + v).
Eigen::MatrixXd affineInScaled(const Eigen::MatrixXd& M, const Eigen::VectorXd& v,
                               const NormalisedProgram& out) {
  Eigen::MatrixXd result(v.size(), out.p + 1);
  result.leftCols(out.p) = M * out.half.asDiagonal();
  result.col(out.p) = v + M * out.centre;
  return result;
}

void addDomainRow(NormalisedProgram& out, const Eigen::VectorXd& a, double b, double scale) {
  const double length = a.norm();
  if (length <= tolerance::kProgramRank * scale) {
    if (b < -tolerance::kProgramRank * scale) out.domain_empty = true;
    return;
  }
  for (int j = 0; j < out.p; ++j) out.domain.push_back(a(j) / length);
  out.domain.push_back(b / length);
}

void setDomain(const ParametricProgram& program, NormalisedProgram& out) {
  for (int j = 0; j < out.p; ++j) {
    addDomainRow(out, Eigen::VectorXd::Unit(out.p, j), 1.0, 1.0);
    addDomainRow(out, -Eigen::VectorXd::Unit(out.p, j), 1.0, 1.0);
  }
  if (program.A_theta.rows() == 0) return;
  const Eigen::MatrixXd rows = affineInScaled(program.A_theta, -program.b_theta, out);
  for (int i = 0; i < rows.rows(); ++i) {
    addDomainRow(out, rows.row(i).head(out.p), -rows(i, out.p), rows.row(i).cwiseAbs().maxCoeff());
  }
}

/// z = Z y + z_p (t, 1): what the equalities leave free.
struct EqualityElimination {
  Eigen::MatrixXd Z;
  Eigen::MatrixXd z_p;
};

EqualityElimination eliminateEqualities(const ParametricProgram& program, const NormalisedProgram& out) {
  const int n = program.variableCount();
  const int count = static_cast<int>(program.equalities.size());
  if (count == 0) return {Eigen::MatrixXd::Identity(n, n), Eigen::MatrixXd::Zero(n, out.p + 1)};
  Eigen::MatrixXd A(count, n);
  Eigen::MatrixXd S(count, out.p);
  Eigen::VectorXd b(count);
  for (int k = 0; k < count; ++k) {
    A.row(k) = program.A.row(program.equalities[k]);
    S.row(k) = program.S.row(program.equalities[k]);
    b(k) = program.b(program.equalities[k]);
  }
  const Eigen::MatrixXd rhs = affineInScaled(S, b, out);
  const PivotedQr qr(A.transpose(), tolerance::kProgramRank);
  const int rank = static_cast<int>(qr.rank());
  const Eigen::MatrixXd Q = qr.Q();
  const Eigen::MatrixXd range = Q.leftCols(rank);
  Eigen::MatrixXd z_p = Eigen::MatrixXd::Zero(n, out.p + 1);
  if (rank > 0) z_p = range * ShortestLeastSquares(A * range).solve(rhs);
  const Eigen::VectorXd rest = (A * z_p - rhs).rowwise().lpNorm<Eigen::Infinity>();
  Eigen::Index worst = 0;
  if (rest.maxCoeff(&worst) > 1e3 * tolerance::kProgramRank * (1.0 + rhs.cwiseAbs().maxCoeff())) {
    throw Error(program.name + ": row " +
                std::to_string(program.equalities[static_cast<std::size_t>(worst)]) +
                ": can only hold with equality, on a lower-dimensional set of parameters");
  }
  return {Q.rightCols(n - rank), z_p};
}

/// Whether row `i` is implied by the row `k` kept before it, or the other way round (then `k` takes its
/// place).
enum class Parallel { kNo, kImplied, kReplaces };

Parallel compare(const NormalisedProgram& ld, const Eigen::MatrixXd& M, int i, int k) {
  if ((M.row(i) - M.row(k)).cwiseAbs().maxCoeff() > tolerance::kParallelRows) return Parallel::kNo;
  const Eigen::VectorXd difference = ld.D.row(i) - ld.D.row(k);
  const double spread = difference.head(ld.p).cwiseAbs().sum();  // greatest change over the box
  const double scale = tolerance::kSameSide * (1.0 + ld.D.row(k).cwiseAbs().maxCoeff());
  if (difference(ld.p) - spread >= -scale) return Parallel::kImplied;
  if (difference(ld.p) + spread <= 0.0) return Parallel::kReplaces;
  return Parallel::kNo;
}

void keepRows(NormalisedProgram& ld, const Eigen::MatrixXd& M, const std::vector<int>& kept) {
  const int count = static_cast<int>(kept.size());
  Eigen::MatrixXd M_kept(count, ld.n), D(count, ld.p + 1), A(count, ld.n), S(count, ld.p + 1),
      V(ld.V.rows(), count);
  Eigen::VectorXd length(count);
  std::vector<int> ids(count);
  for (int k = 0; k < count; ++k) {
    M_kept.row(k) = M.row(kept[k]);
    D.row(k) = ld.D.row(kept[k]);
    A.row(k) = ld.A.row(kept[k]);
    S.row(k) = ld.S.row(kept[k]);
    V.col(k) = ld.V.col(kept[k]);
    length(k) = ld.length(kept[k]);
    ids[k] = ld.row_ids[kept[k]];
  }
  ld.m = count;
  ld.gram = M_kept * M_kept.transpose();
  ld.gram.diagonal().setOnes();
  ld.M = std::move(M_kept);
  ld.D = std::move(D);
  ld.A = std::move(A);
  ld.S = std::move(S);
  ld.V = std::move(V);
  ld.length = std::move(length);
  ld.row_ids = std::move(ids);
}

void dropParallelRows(NormalisedProgram& ld, const Eigen::MatrixXd& M) {
  const RepeatedRows rows(ld.source);
  std::vector<int> kept;
  for (int i = 0; i < ld.m; ++i) {
    bool implied = false;
    for (int& k : kept) {
      Parallel relation = compare(ld, M, i, k);
      if (relation == Parallel::kNo && rows.distance(ld.row_ids[i], ld.row_ids[k]) <= tolerance::kRepeatedRow)
        relation = Parallel::kImplied;
      if (relation == Parallel::kNo) continue;
      if (relation == Parallel::kReplaces) k = i;
      implied = true;
      break;
    }
    if (!implied) kept.push_back(i);
  }
  keepRows(ld, M, kept);
}

/// (M theta + v) in t, for centres and half ranges as they are rounded: laws are turned back by the same numbers, so that a
/// law of whole numbers stays one.
WideMatrix wideInScaled(const Eigen::MatrixXd& M, const Eigen::VectorXd& v,
                        const ParametricProgram& program) {
  const Eigen::Index p = program.parameterCount();
  WideMatrix result(v.size(), p + 1);
  result.col(p) = wide(v);
  for (Eigen::Index j = 0; j < p; ++j) {
    const Signal& signal = program.parameters[static_cast<std::size_t>(j)];
    const WideMatrix column = wide(M.col(j));
    result.col(j) = column * DoubleDouble{0.5 * (signal.upper - signal.lower), 0.0};
    result.col(p) += column * DoubleDouble{0.5 * (signal.lower + signal.upper), 0.0};
  }
  return result;
}

/// What the equalities leave of the program.
AffineProgram withoutEqualities(const AffineProgram& whole, const EqualityElimination& free) {
  const WideMatrix Z = wide(free.Z), z_p = wide(free.z_p);
  AffineProgram reduced;
  reduced.H = Z.transpose() * whole.H * Z;
  reduced.cost = Z.transpose() * (whole.cost + whole.H * z_p);
  reduced.A = whole.A * Z;
  reduced.bound = whole.bound - whole.A * z_p;
  reduced.E = whole.E * Z;
  reduced.offset = whole.offset + whole.E * z_p;
  return reduced;
}

/// The reduced program in the metric of H, or of the identity where H is zero.
IdentityForm metricForm(const ParametricProgram& program, AffineProgram reduced, NormalisedProgram& ld) {
  if (program.H.isZero(0.0)) {
    ld.linear = true;
    ld.cost = rounded(reduced.cost);
    reduced.H.setIdentity();
    reduced.cost.setZero();
    return *identityForm(reduced);
  }
  ld.cost = Eigen::MatrixXd::Zero(ld.n, ld.p + 1);
  requireDefinite(program, program.equalities);
  std::optional<IdentityForm> form = identityForm(reduced);
  if (!form) throw Error(program.name + ": H: its condition is beyond 1e28");
  // The equalities are eliminated in doubles.
  if (!program.equalities.empty() && ld.n > 0) {
    const double least = rounded(form->root).diagonal().minCoeff();
    ld.rounding *= std::max(1.0, std::sqrt(program.H.cwiseAbs().maxCoeff()) / least);
  }
  return *std::move(form);
}

}  // namespace

AffineProgram affineInBox(const ParametricProgram& program) {
  return {wide(program.H), wideInScaled(program.F, program.f, program),
          wide(program.A), wideInScaled(program.S, program.b, program),
          wide(program.E), wideInScaled(program.C, program.c, program)};
}

NormalisedProgram normalise(const ParametricProgram& given) {
  if (given.parameterCount() > kMostParameters)
    throw Error(given.name + ": parameters: must be at most " + std::to_string(kMostParameters) + ", got " +
                std::to_string(given.parameterCount()));
  ScaledProgram scaled = scaleProgram(given);
  NormalisedProgram ld;
  ld.source = std::move(scaled.program);
  ld.outputs = std::move(scaled.outputs);
  const ParametricProgram& program = ld.source;
  ld.rounding = tolerance::kDoubleRounding;
  ld.p = program.parameterCount();
  ld.centre.resize(ld.p);
  ld.half.resize(ld.p);
  for (int j = 0; j < ld.p; ++j) {
    ld.centre(j) = 0.5 * (program.parameters[j].lower + program.parameters[j].upper);
    ld.half(j) = 0.5 * (program.parameters[j].upper - program.parameters[j].lower);
  }
  setDomain(program, ld);

  AffineProgram reduced = affineInBox(program);
  if (!program.equalities.empty()) reduced = withoutEqualities(reduced, eliminateEqualities(program, ld));
  ld.n = static_cast<int>(reduced.H.rows());
  const Eigen::MatrixXd A = rounded(reduced.A), S = rounded(reduced.bound);
  const IdentityForm form = metricForm(program, std::move(reduced), ld);
  const Eigen::MatrixXd M_all = rounded(form.rows), D = rounded(form.slack);
  Eigen::MatrixXd M(program.rowCount(), ld.n);
  ld.A.resize(program.rowCount(), ld.n);
  ld.S.resize(program.rowCount(), ld.p + 1);
  ld.D.resize(program.rowCount(), ld.p + 1);
  ld.length.resize(program.rowCount());
  for (int i = 0; i < program.rowCount(); ++i) {
    if (isEquality(program, i)) continue;
    const double scale = std::max(program.A.row(i).cwiseAbs().maxCoeff(), S.row(i).cwiseAbs().maxCoeff());
    if (A.row(i).norm() <= tolerance::kProgramRank * scale) {
      addDomainRow(ld, -S.row(i).head(ld.p), S(i, ld.p), scale);
      continue;
    }
    M.row(ld.m) = M_all.row(i);
    ld.A.row(ld.m) = A.row(i);
    ld.S.row(ld.m) = S.row(i);
    ld.length(ld.m) = form.length(i);
    ld.D.row(ld.m) = D.row(i);
    ld.row_ids.push_back(i);
    ++ld.m;
  }
  ld.U = rounded(form.law);
  ld.V = -rounded(form.output) * M.topRows(ld.m).transpose();
  dropParallelRows(ld, M);
  return ld;
}

}  // namespace polyfly
