// The explicit law against the online programs, and its own geometry.
#include "robust_mpc/robust_law.hpp"

#include <gtest/gtest.h>

#include <map>

#include "../../test/exact_volume.hpp"
#include "../../test/map_in_memory.hpp"
#include "../../test/random.hpp"
#include "made_robust.hpp"
#include "offline_mpt/encode.hpp"
#include "robust_mpc/online_lp.hpp"
#include "solved_robust.hpp"

namespace polyfly {
namespace {

struct Solved : SolvedRobust {
  using SolvedRobust::SolvedRobust;

  ExactPolytope domain() const {
    std::vector<RationalVector> points;
    for (const FeasibleSet::Vertex& vertex : set.vertices)
      points.emplace_back(vertex.y.begin(), vertex.y.begin() + problem.parameterCount());
    return hull(problem.parameterCount(), points);
  }
};

Rational at(const RationalVector& gain, const Rational& offset, const RationalVector& theta) {
  return dot(gain, theta) + offset;
}

std::vector<MadeRobust> variety() {
  std::vector<MadeRobust> made;
  for (const char* stack : {"paper", "shift"}) {
    MadeRobust one;
    one.stack = stack;
    one.horizon = 4;
    one.peak_in_map = true;
    made.push_back(one);
    one.floor = "0.03";
    made.push_back(one);
    one.floor = "0";
    one.torque = true;
    made.push_back(one);
    one.outputs = "[[1, 0.3, 0], [0, 0, 1.5]]";
    made.push_back(one);
    one = MadeRobust();
    one.stack = stack;
    one.states = 2;
    one.peak_in_map = true;
    made.push_back(one);
    one.states = 4;
    one.horizon = 3;
    made.push_back(one);
    one.states = 3;
    one.feedback = "zero";
    made.push_back(one);
    one.feedback = "free";
    one.bounded_position = true;
    one.invariance = "first_step";
    made.push_back(one);
  }
  MadeRobust referenced;
  referenced.references = true;
  referenced.horizon = 3;
  referenced.peak_in_map = true;
  made.push_back(referenced);
  return made;
}

TEST(RobustLaw, CoversTheFeasibleParametersWithoutOverlap) {
  for (const MadeRobust& made : variety()) {
    const Solved solved(made);
    ASSERT_TRUE(solved.set.proven);
    EXPECT_TRUE(proveFacets(solved.program, solved.set));
    Rational sum;
    for (const RobustLaw::Region& region : solved.law.regions) sum += volume(region.polytope);
    EXPECT_EQ(sum, volume(solved.domain())) << made.text();
  }
}

TEST(RobustLaw, IsContinuous) {
  for (const MadeRobust& made : variety()) {
    const Solved solved(made);
    std::map<RationalVector, std::pair<Rational, Rational>> seen;
    for (const RobustLaw::Region& region : solved.law.regions) {
      for (const RationalVector& vertex : region.vertices) {
        const std::pair value(at(region.input_gain, region.input_offset, vertex),
                              at(region.peak_gain, region.peak_offset, vertex));
        EXPECT_EQ(seen.emplace(vertex, value).first->second, value);
      }
    }
  }
}

TEST(RobustLaw, HalfSpacesAndVerticesDescribeTheSameRegions) {
  const Solved solved(variety().front());
  for (const RobustLaw::Region& region : solved.law.regions) {
    EXPECT_TRUE(equal(region.polytope, hull(solved.problem.parameterCount(), region.vertices)));
    EXPECT_EQ(minimal(region.polytope).rows.size(), region.polytope.rows.size());
  }
}

TEST(RobustLaw, EqualsTheExactProgramAtVertices) {
  MadeRobust made;
  made.horizon = 4;
  made.stack = "shift";
  const Solved solved(made);
  const OnlineLp online(solved.problem);
  int count = 0;
  for (const RobustLaw::Region& region : solved.law.regions) {
    const RationalVector& vertex = region.vertices[region.vertices.size() / 2];
    const OnlineLp::ExactAnswer answer = online.solveExactly(vertex);
    ASSERT_TRUE(answer.feasible);
    EXPECT_EQ(answer.peak, at(region.peak_gain, region.peak_offset, vertex));
    EXPECT_EQ(answer.input, at(region.input_gain, region.input_offset, vertex));
    if (++count == 20) break;
  }
}

// The map, as it is flown: tau and u_0 of the float program, and outside exactly where that is infeasible.
TEST(RobustLaw, MapEqualsTheOnlineProgram) {
  for (const MadeRobust& made : variety()) {
    const Solved solved(made);
    const RoundedLaw rounded = roundLaw(solved.problem, solved.law, ExploreStatus::kComplete);
    const MapInMemory memory(encode(rounded.program, rounded.partition));
    OnlineLp online(solved.problem);
    Random random(5);
    int inside = 0;
    for (int k = 0; k < 300; ++k) {
      Eigen::VectorXd theta(solved.problem.parameterCount());
      Eigen::VectorXd shift = theta;
      for (int j = 0; j < theta.size(); ++j) {
        const RobustProblem::Parameter& parameter = solved.problem.parameters[static_cast<std::size_t>(j)];
        theta[j] = (k % 4 == 0 ? 0.05 : 1.0) * random.uniform(parameter.signal.lower, parameter.signal.upper);
        shift[j] = parameter.state < 0 ? parameter.input_shift[0].get_d() : 0.0;
      }
      const OnlineLp::Answer answer = online.solve(theta);
      double output[2] = {0.0, 0.0};
      const Lookup found = memory.map().evaluate(theta.data(), output);
      ASSERT_EQ(found.status == LookupStatus::kInside, answer.feasible) << made.text() << theta.transpose();
      if (!answer.feasible) continue;
      ++inside;
      EXPECT_NEAR(output[0], answer.input + shift.dot(theta), 2e-8);
      if (made.peak_in_map) {
        EXPECT_NEAR(output[1], answer.peak, 1e-9);
      }
    }
    EXPECT_GT(inside, 100);
  }
}

TEST(RobustLaw, DoesNotDependOnThreads) {
  MadeRobust made;
  made.horizon = 5;
  const Solved one(made, 1), four(made, 4);
  ASSERT_EQ(one.law.regions.size(), four.law.regions.size());
  for (std::size_t k = 0; k < one.law.regions.size(); ++k) {
    EXPECT_EQ(one.law.regions[k].vertices, four.law.regions[k].vertices);
    EXPECT_EQ(one.law.regions[k].input_gain, four.law.regions[k].input_gain);
  }
}

// Two ways to the same end: the last stage in the invariant set, or the first; neither loses a feasible first
// move of the other here.
TEST(RobustLaw, TerminalAndFirstStepInvarianceAgree) {
  MadeRobust made;
  made.bounded_position = true;
  made.horizon = 5;
  made.invariance = "first_step";
  const Solved first(made);
  made.invariance = "terminal";
  const Solved terminal(made);
  made.invariance = "none";
  const Solved none(made);
  ASSERT_EQ(first.set.facets.size(), terminal.set.facets.size());
  for (std::size_t k = 0; k < first.set.facets.size(); ++k) {
    EXPECT_EQ(first.set.facets[k].half_space.a, terminal.set.facets[k].half_space.a);
    EXPECT_EQ(first.set.facets[k].half_space.b, terminal.set.facets[k].half_space.b);
  }
  EXPECT_GT(first.set.facets.size(), none.set.facets.size());
}

// Facets that the projection did not get right would be seen by this: a wrong weight, a wrong sign.
TEST(RobustLaw, ProofOfFacetsRefusesAWrongOne) {
  const Solved solved(variety().front());
  std::size_t tried = 0;
  for (std::size_t f = 0; f < solved.set.facets.size(); ++f) {
    if (solved.set.facets[f].parts.size() < 2) continue;
    FeasibleSet broken = solved.set;
    broken.facets[f].parts[0].weight *= Rational(1001, 1000);
    EXPECT_FALSE(proveFacets(solved.program, broken));
    broken = solved.set;
    broken.facets[f].half_space.b -= 1;
    EXPECT_FALSE(proveFacets(solved.program, broken));
    ++tried;
  }
  EXPECT_GT(tried, 3u);
}

}  // namespace
}  // namespace polyfly
