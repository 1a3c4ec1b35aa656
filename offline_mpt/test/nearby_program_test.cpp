// Of which program an answer is the optimum, against optimality conditions that Eigen solves.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstddef>
#include <string>

#include "exact_programs.hpp"
#include "map_in_memory.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "random_program.hpp"
#include "robust/read_map_certificate.hpp"

namespace polyfly {
namespace {

constexpr double kReach = 8.0;  // tolerances by which an answer may violate a half-space

/// How much bounds and f have to change: of a bound relative to its row of A, of f relative to H.
struct Changes {
  double bound = 0.0, cost = 0.0;
  void include(const Changes& other) {
    bound = std::max(bound, other.bound);
    cost = std::max(cost, other.cost);
  }
};

Changes statedBy(const std::string& conditions) {
  const auto numberAfter = [&](const std::string& words) {
    const std::size_t at = conditions.find(words);
    return at == std::string::npos ? -1.0 : std::stod(conditions.substr(at + words.size()));
  };
  return {numberAfter("whose bounds differ by at most "), numberAfter("and whose f by ")};
}

/// What makes the solution of an active set the optimum at theta.
Changes changesAt(const ParametricProgram& program, const CriticalRegion& region,
                  const Eigen::VectorXd& theta) {
  const Eigen::Index n = program.H.rows(), k = static_cast<Eigen::Index>(region.active.size());
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + k, n + k);
  Eigen::VectorXd right(n + k);
  const Eigen::VectorXd bounds = program.b + program.S * theta;
  system.topLeftCorner(n, n) = program.H;
  right.head(n) = -program.f - program.F * theta;
  for (Eigen::Index r = 0; r < k; ++r) {
    const int row = region.active[static_cast<std::size_t>(r)];
    system.row(n + r).head(n) = program.A.row(row);
    system.col(n + r).head(n) = program.A.row(row).transpose();
    right(n + r) = bounds(row);
  }
  const Eigen::VectorXd solution = system.fullPivLu().solve(right);
  const Eigen::VectorXd sizes = program.A.rowwise().lpNorm<Eigen::Infinity>();
  const Eigen::VectorXd excess = (program.A * solution.head(n) - bounds).cwiseQuotient(sizes);
  Eigen::VectorXd costs = Eigen::VectorXd::Zero(n);
  for (Eigen::Index r = 0; r < k; ++r)
    costs += std::max(0.0, -solution(n + r)) * system.col(n + r).head(n).cwiseAbs();
  return {excess.maxCoeff(), costs.maxCoeff() / program.H.lpNorm<Eigen::Infinity>()};
}

/// The half-spaces of a region in t of [-1, 1]: normal . t <= limit, normals of length 1.
struct ScaledRegion {
  Eigen::MatrixXd normals;
  Eigen::VectorXd limits;
};

ScaledRegion scaled(const CriticalRegion& region, const Eigen::VectorXd& centre,
                    const Eigen::VectorXd& half) {
  ScaledRegion result{region.G * half.asDiagonal(), region.g - region.G * centre};
  const Eigen::VectorXd lengths = result.normals.rowwise().norm();
  result.limits = result.limits.cwiseQuotient(lengths);
  result.normals = lengths.cwiseInverse().asDiagonal() * result.normals;
  return result;
}

/// Calls visit(t) for each corner of the region with its half-spaces moved outwards, in the box.
template <class Visit>
void visitCorners(const ScaledRegion& region, double outwards, const Visit& visit) {
  const Eigen::Index rows = region.normals.rows(), p = region.normals.cols();
  const Eigen::VectorXd limits = region.limits.array() + outwards;
  std::string chosen(static_cast<std::size_t>(rows), 0);
  std::fill(chosen.begin(), chosen.begin() + std::min(p, rows), 1);
  if (rows < p) return;
  do {
    Eigen::MatrixXd normals(p, p);
    Eigen::VectorXd at(p);
    for (Eigen::Index i = 0, k = 0; i < rows; ++i) {
      if (chosen[static_cast<std::size_t>(i)] == 0) continue;
      normals.row(k) = region.normals.row(i);
      at(k++) = limits(i);
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(normals);
    if (!lu.isInvertible()) continue;
    const Eigen::VectorXd t = lu.solve(at);
    const double excess = (region.normals * t - limits).maxCoeff();
    if (excess <= 1e-3 * outwards && t.lpNorm<Eigen::Infinity>() <= 1.0) visit(t);
  } while (std::prev_permutation(chosen.begin(), chosen.end()));
}

Changes statedOf(const ParametricProgram& program, const RegionMap& map, const std::string& bytes) {
  const CertifyReport report = certify(map, program, {});
  EXPECT_TRUE(report.passed());
  const checker::Map checked(bytes);
  const auto proof = checker::readMapCertificate(report.certificate, checked);
  proof->check();
  return statedBy(proof->conditions());
}

// Beyond corners several half-spaces are violated at once, and conditions that no half-space of the map is.
TEST(NearbyProgram, AnAnswerIsTheOptimumOfAProgramAsNearAsTheCheckerStates) {
  for (const ParametricProgram& program :
       {doubleIntegrator(4), randomProgram(4, 12, 2, 3), randomProgram(5, 14, 3, 4)}) {
    const Partition partition = explore(program);
    const MapInMemory memory(encode(program, partition));
    const Changes stated = statedOf(program, memory.map(), memory.bytes());
    const auto p = static_cast<Eigen::Index>(program.parameters.size());
    Eigen::VectorXd centre(p), half(p);
    for (Eigen::Index j = 0; j < p; ++j) {
      const Signal& range = program.parameters[static_cast<std::size_t>(j)];
      centre(j) = 0.5 * (range.lower + range.upper);
      half(j) = 0.5 * (range.upper - range.lower);
    }
    Changes found;
    for (const CriticalRegion& region : partition.regions) {
      visitCorners(scaled(region, centre, half), kReach * memory.map().tolerance(),
                   [&](const Eigen::VectorXd& t) {
                     found.include(changesAt(program, region, centre + half.cwiseProduct(t)));
                   });
    }
    EXPECT_LE(found.bound, stated.bound);
    EXPECT_LE(found.cost, stated.cost);
    EXPECT_GT(found.bound, 0.5 * stated.bound);
    EXPECT_GT(found.cost, 0.5 * stated.cost);
  }
}

// Such a row bounds parameters only.
TEST(NearbyProgram, ARowWithoutVariablesCounts) {
  ParametricProgram program = doubleIntegrator(4);
  const Eigen::Index m = program.A.rows();
  program.A.conservativeResize(m + 1, Eigen::NoChange);
  program.b.conservativeResize(m + 1);
  program.S.conservativeResize(m + 1, Eigen::NoChange);
  program.A.row(m).setZero();
  program.S.row(m).setOnes();
  program.b(m) = 0.5;
  const MapInMemory memory(encode(program, explore(program)));
  const Changes stated = statedOf(program, memory.map(), memory.bytes());
  EXPECT_GT(stated.bound, 0.0);
  EXPECT_LT(stated.bound, 1e-5);
}

// Two rows are sums of the others up to rounding. The proof is about the program without them.
TEST(NearbyProgram, NothingIsStatedOfProgramsWithDroppedRows) {
  ParametricProgram program = randomProgram(3, 5, 3, 4);
  program.H.setIdentity();
  program.f.setZero();
  program.F = -Eigen::MatrixXd::Identity(3, 3);
  program.A.resize(5, 3);
  program.A << Eigen::MatrixXd::Identity(3, 3), Eigen::MatrixXd::Ones(2, 3);
  program.S = Eigen::MatrixXd::Zero(5, 3);
  program.b.resize(5);
  program.b << 1.0, 1.0, 1.0, 3.0 - 8.7e-14, 3.0 + 5.3e-14;
  for (Signal& parameter : program.parameters) {
    parameter.lower = -3.0;
    parameter.upper = 3.0;
  }
  const MapInMemory memory(encode(program, explore(program)));
  const CertifyReport report = certify(memory.map(), program, {});
  ASSERT_NE(report.certificate.find("\ndropped "), std::string::npos);
  EXPECT_EQ(statedOf(program, memory.map(), memory.bytes()).bound, -1.0);
}

}  // namespace
}  // namespace polyfly
