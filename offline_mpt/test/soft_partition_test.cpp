// Maps of soft, blocked and change-limited problems: proven, confirmed by the checker, and right at random parameters.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "mpc_core/mpc_problem.hpp"
#include "mutation.hpp"
#include "polyfly_base/read_text.hpp"
#include "project_root.hpp"
#include "random.hpp"
#include "soft_problems.hpp"
#include "verify/strict_qp.hpp"

namespace polyfly {
namespace {

constexpr double kTolerance = 1e-6;
constexpr double kPrecision = 1e-10;
constexpr int kSamples = 100;

/// The map's first input against a direct solution.
void expectRightAtRandomParameters(const RegionMap& map, const ParametricProgram& program, unsigned seed) {
  StrictQp oracle(program, Convexity::kAsGiven);
  Random random(seed);
  for (int k = 0; k < kSamples; ++k) {
    Eigen::VectorXd theta(program.parameterCount());
    for (Eigen::Index j = 0; j < theta.size(); ++j) {
      const Signal& signal = program.parameters[static_cast<std::size_t>(j)];
      theta(j) = random.uniform(signal.lower, signal.upper);
    }
    const StrictAnswer truth = oracle.solve(theta, kPrecision);
    const Lookup found = map.locate(theta.data());
    if (truth.verdict == StrictAnswer::Verdict::kInfeasible) {
      EXPECT_NE(found.status, LookupStatus::kInside) << theta.transpose();
    } else if (truth.verdict == StrictAnswer::Verdict::kOptimal) {
      ASSERT_EQ(found.status, LookupStatus::kInside) << theta.transpose();
      const double* const law = map.law(found.law);
      double u = law[theta.size()];
      for (Eigen::Index j = 0; j < theta.size(); ++j) u += law[j] * theta(j);
      EXPECT_NEAR(u, truth.u(0), kTolerance) << theta.transpose();
    }
  }
}

struct Kind {
  const char* name;
  ProblemTraits traits;
};

class MadeProblems : public ::testing::TestWithParam<Kind> {};

TEST_P(MadeProblems, AreProvenAndConfirmed) {
  constexpr unsigned kSeeds = 3;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const std::string text = madeProblem(GetParam().traits, seed);
    SCOPED_TRACE(text);
    const ParametricProgram program = condense(parseProblem(text, "made.yaml"));
    proven(program);
    expectRightAtRandomParameters(MapInMemory(solved(program)).map(), program, seed);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, MadeProblems,
                         ::testing::Values(Kind{"soft", {true, false, false}},
                                           Kind{"blocked", {false, true, false}},
                                           Kind{"change", {false, false, true}},
                                           Kind{"softAndBlocked", {true, true, false}}),
                         [](const auto& instance) { return std::string(instance.param.name); });

// Planes of one facet that differed by 2e-10 between its two regions left a wedge, at a side of the box, that no leaf
// answered within the tolerance.
TEST(SoftSpeedLimit, AWedgeBetweenTwoPlanesOfOneFacetIsAnswered) {
  const std::string text = replaced(readText(problemFile("lateral_speed_limit.yaml")),
                                    "linear: 400, quadratic: 40", "linear: 40, quadratic: 4");
  const ParametricProgram program = condense(parseProblem(text, "speed_limit.yaml"));
  const MapInMemory memory(solved(program));
  const CertifyReport report = certify(memory.map(), program);
  EXPECT_TRUE(report.passed()) << certifyText(report);
  EXPECT_LT(report.plane_error, 1e-10);
  Eigen::VectorXd theta(6);
  theta << 2.9999999699256663, -2.8615583572850238, 2.1125312089762431, 0.20151771881451802,
      -0.43633229562586562, -0.098679958087492317;
  EXPECT_EQ(memory.map().locate(theta.data()).status, LookupStatus::kInside);
}

}  // namespace
}  // namespace polyfly
