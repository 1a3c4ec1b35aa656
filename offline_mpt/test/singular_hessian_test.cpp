// Programs whose H is singular: of several optima the shortest is answered, and proven. The oracle is GLPK,
// asked whether any direction improves the answer.
#include <gtest/gtest.h>

#include <algorithm>

#include "extensions/read_certificate.hpp"
#include "glpk_lp.hpp"
#include "map_in_memory.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "random.hpp"
#include "random_program.hpp"

namespace polyfly {
namespace {

constexpr double kTight = 1e-8;

/// What the random programs differ in.
enum class Family {
  /// Optima are not unique almost everywhere. Half of the rows lie in the range of H.
  kCostInRange,
  /// The cost drives z to the bounds along the null space of H.
  kCostOutside,
  /// Some variables are not in H at all, like slacks of soft constraints.
  kZeroRows,
  /// H has rank one.
  kRankOne,
  /// There are equalities that do not lie in the range of H.
  kEqualities,
  /// There are rows that repeat, parallel rows and rows that never bind.
  kRepeatedRows,
  /// The cost does not depend on theta, so the shortest optimum is continuous.
  kConstantCost,
  /// H, cost and rows are small whole numbers, which gives coincidences of every kind.
  kWholeNumbers,
  kCount
};

ParametricProgram singularProgram(Family family, unsigned seed) {
  Random random(1000u * static_cast<unsigned>(family) + seed);
  const int n = 2 + random.below(4), p = 1 + random.below(3);
  int rank = family == Family::kRankOne ? 1 : 1 + random.below(n - 1);
  const auto numbers = [&](int rows, int columns) -> Eigen::MatrixXd {
    const Eigen::MatrixXd values = 3.0 * random.matrix(rows, columns);
    return family == Family::kWholeNumbers ? Eigen::MatrixXd(values.array().round()) : values;
  };
  Eigen::MatrixXd root = numbers(rank, n);
  if (family == Family::kZeroRows) root.rightCols(n - rank).setZero();
  if (root.isZero()) root(0, 0) = 1.0;
  ParametricProgram program = randomProgram(n, 1, p, seed);
  program.name = "singular_" + std::to_string(static_cast<int>(family)) + "_" + std::to_string(seed);
  program.H = root.transpose() * root;
  program.f = numbers(n, 1);
  program.F = numbers(n, p);
  if (family == Family::kCostInRange || family == Family::kEqualities) {
    program.f = root.transpose() * numbers(rank, 1);
    program.F = root.transpose() * numbers(rank, p);
  }
  if (family == Family::kConstantCost || family == Family::kZeroRows) program.F.setZero();
  program.A.resize(0, n);
  program.b.resize(0);
  program.S.resize(0, p);
  for (int i = 0; i < n; ++i) {
    for (const double sign : {1.0, -1.0})
      appendRow(program, sign * Eigen::VectorXd::Unit(n, i), 2.0, Eigen::VectorXd::Zero(p));
  }
  for (int i = 0; i < 3; ++i) appendRow(program, numbers(n, 1), 0.5 + 0.5 * i, 0.3 * numbers(p, 1));
  if (family == Family::kCostInRange) appendRow(program, root.row(0), 0.5, 0.3 * numbers(p, 1));
  if (family == Family::kEqualities) {
    program.equalities = {static_cast<int>(program.A.rows())};
    appendRow(program, numbers(n, 1), 0.1, 0.1 * numbers(p, 1));
  }
  if (family == Family::kRepeatedRows) {
    const int last = static_cast<int>(program.A.rows()) - 1;
    appendRow(program, program.A.row(last), program.b(last), program.S.row(last));
    appendRow(program, 2.0 * program.A.row(last), 2.0 * program.b(last), 2.0 * program.S.row(last));
    appendRow(program, program.A.row(last - 1), program.b(last - 1) + 1.0, program.S.row(last - 1));
  }
  outputAllVariables(program);
  return program;
}

/// How much `slope` can fall along a direction that keeps all rows which are tight at z, |d_i| <= 1; `fixed`
/// rows are kept with equality.
double descent(const ParametricProgram& program, const Eigen::VectorXd& theta, const Eigen::VectorXd& z,
               const Eigen::VectorXd& slope, const Eigen::MatrixXd& fixed) {
  const Eigen::Index n = z.size();
  std::vector<Eigen::VectorXd> rows;
  std::vector<double> bounds;
  std::vector<int> equalities;
  for (int i = 0; i < program.rowCount(); ++i) {
    const bool equality =
        std::find(program.equalities.begin(), program.equalities.end(), i) != program.equalities.end();
    const double slack = program.b(i) + program.S.row(i).dot(theta) - program.A.row(i).dot(z);
    if (!equality && slack > kTight) continue;
    if (equality) equalities.push_back(static_cast<int>(rows.size()));
    rows.emplace_back(program.A.row(i));
    bounds.push_back(0.0);
  }
  for (Eigen::Index i = 0; i < fixed.rows(); ++i) {
    equalities.push_back(static_cast<int>(rows.size()));
    rows.emplace_back(fixed.row(i));
    bounds.push_back(0.0);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (const double sign : {1.0, -1.0}) {
      rows.emplace_back(sign * Eigen::VectorXd::Unit(n, i));
      bounds.push_back(1.0);
    }
  }
  Eigen::MatrixXd A(static_cast<Eigen::Index>(rows.size()), n);
  for (std::size_t i = 0; i < rows.size(); ++i) A.row(static_cast<Eigen::Index>(i)) = rows[i];
  const LpAnswer answer =
      solveByGlpk(slope, A, Eigen::Map<Eigen::VectorXd>(bounds.data(), A.rows()), equalities);
  EXPECT_EQ(answer.status, GLP_OPT);
  return -answer.objective;
}

bool feasible(const ParametricProgram& program, const Eigen::VectorXd& theta, double margin) {
  const Eigen::VectorXd bound = program.b + program.S * theta;
  Eigen::VectorXd widened = bound.array() + margin;
  for (const int row : program.equalities) widened(row) = bound(row);
  return solveByGlpk(Eigen::VectorXd::Zero(program.variableCount()), program.A, widened, program.equalities)
             .status == GLP_OPT;
}

/// The map's answer is feasible, optimal, and the shortest of all that are.
void expectShortestOptimum(const ParametricProgram& program, const RegionMap& map, unsigned seed) {
  Random random(seed);
  const int n = program.variableCount();
  for (int k = 0; k < 10; ++k) {
    const Eigen::VectorXd theta = random.matrix(program.parameterCount(), 1);
    Eigen::VectorXd z(n);
    const bool inside = map.evaluate(theta.data(), z.data()).status == LookupStatus::kInside;
    EXPECT_LE(feasible(program, theta, -1e-6), inside) << program.name << " misses " << theta.transpose();
    EXPECT_GE(feasible(program, theta, 1e-6), inside) << program.name << " answers " << theta.transpose();
    if (!inside) continue;
    const Eigen::VectorXd slack = program.b + program.S * theta - program.A * z;
    EXPECT_GT(slack.minCoeff(), -kTight) << program.name;
    for (const int row : program.equalities) EXPECT_LT(std::abs(slack(row)), kTight);
    const Eigen::VectorXd cost = program.f + program.F * theta;
    EXPECT_LT(descent(program, theta, z, program.H * z + cost, Eigen::MatrixXd(0, n)), 1e-6)
        << program.name << ": not optimal at " << theta.transpose();
    Eigen::MatrixXd face(n + 1, n);
    face << program.H, cost.transpose();
    EXPECT_LT(descent(program, theta, z, z, face), 1e-6)
        << program.name << ": not the shortest at " << theta.transpose();
  }
}

class SingularHessian : public testing::TestWithParam<int> {};

TEST_P(SingularHessian, TheShortestOptimumIsAnsweredAndProven) {
  const auto family = static_cast<Family>(GetParam());
  for (unsigned seed = 1; seed <= 15; ++seed) {
    const ParametricProgram program = singularProgram(family, seed);
    const Partition partition = explore(program);
    ASSERT_EQ(partition.status, ExploreStatus::kComplete) << program.name;
    const MapInMemory map(encode(program, partition));
    expectShortestOptimum(program, map.map(), seed);
    const CertifyReport report = certify(map.map(), program);
    EXPECT_TRUE(report.passed()) << program.name << "\n" << certifyText(report);
    const checker::Map read(map.bytes());
    EXPECT_NO_THROW(checker::readCertificate(report.certificate, read)->check()) << program.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Families, SingularHessian, testing::Range(0, static_cast<int>(Family::kCount)));

}  // namespace
}  // namespace polyfly
