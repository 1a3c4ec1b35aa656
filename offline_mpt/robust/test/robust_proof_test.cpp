// What the exact proof says of right maps, and that it refuses wrong ones.
#include <gtest/gtest.h>

#include <algorithm>

#include "../../test/map_in_memory.hpp"
#include "../../test/random.hpp"
#include "holds.hpp"
#include "made_robust.hpp"
#include "offline_mpt/encode.hpp"
#include "polyfly_base/error.hpp"
#include "robust_mpc/prove_map.hpp"
#include "solved_robust.hpp"

namespace polyfly {
namespace {

struct Solved : SolvedRobust {
  using SolvedRobust::SolvedRobust;

  RobustProof proof() const { return proveLaw(problem, program, set, law); }
  MapContent content() const {
    const RoundedLaw rounded = roundLaw(problem, law, ExploreStatus::kComplete);
    return encode(rounded.program, rounded.partition);
  }
};

// Four steps are enough for this axis, three are not.
TEST(RobustProof, ShowsWhereFeasibilityIsLost) {
  MadeRobust made;
  made.horizon = 3;
  const Solved three(made);
  const RobustProof proof = three.proof();
  EXPECT_TRUE(proof.lawHolds());
  ASSERT_TRUE(proof.lost.has_value());
  // from the state that is shown the program is infeasible one step later: by the vertices of the set itself
  const RobustWitness& lost = *proof.lost;
  RationalVector move_and_peak;
  for (const RobustLaw::Region& region : three.law.regions) {
    if (contains(region.polytope, lost.theta))
      move_and_peak = {dot(region.input_gain, lost.theta) + region.input_offset};
  }
  ASSERT_EQ(move_and_peak.size(), 1u);
  RationalVector next(3);
  for (int i = 0; i < 3; ++i) {
    next[static_cast<std::size_t>(i)] = three.problem.drift[static_cast<std::size_t>(i)] +
                                        three.problem.B(i, 0) * move_and_peak[0] +
                                        three.problem.G(i, 0) * lost.disturbance[0];
    for (int j = 0; j < 3; ++j)
      next[static_cast<std::size_t>(i)] += three.problem.A(i, j) * lost.theta[static_cast<std::size_t>(j)];
  }
  ExactPolytope slice;  // (u, tau) with which the successor is feasible; the box does not count
  slice.dimension = 2;
  for (const FeasibleSet::Facet& facet : three.set.facets) {
    if (facet.of_box) continue;
    Rational rest = facet.half_space.b;
    for (std::size_t j = 0; j < 3; ++j) rest -= facet.half_space.a[j] * next[j];
    slice.rows.push_back({{facet.half_space.a[3], facet.half_space.a[4]}, rest});
  }
  EXPECT_LT(affineDimension(slice), 0);
  made.horizon = 4;
  EXPECT_TRUE(Solved(made).proof().recursivelyFeasible());
  made.bounded_position = true;
  EXPECT_FALSE(Solved(made).proof().recursivelyFeasible());
  made.invariance = "first_step";
  EXPECT_TRUE(Solved(made).proof().recursivelyFeasible());
}

TEST(RobustProof, RefusesWrongLaws) {
  const Solved right(smallRobust());
  const auto refuses = [&](const RobustLaw& law) {
    Solved wrong = right;
    wrong.law = law;
    return !proveRobustMap(MapInMemory(wrong.content()).map(), right.problem).passed();
  };
  ASSERT_FALSE(refuses(right.law));
  for (std::size_t r = 0; r < right.law.regions.size(); r += 5) {
    RobustLaw law = right.law;
    law.regions[r].input_offset += Rational(1, 10000000);
    EXPECT_TRUE(refuses(law)) << r;
    law = right.law;
    law.regions.erase(law.regions.begin() + static_cast<std::ptrdiff_t>(r));
    EXPECT_TRUE(refuses(law)) << r;
  }
}

// With another gain of the tie-break the same moves are optimal, but others are nearer to K e.
TEST(RobustProof, RefusesMovesThatAreNotPreferred) {
  const Solved right(smallRobust());
  for (const int sign : {-1, 1}) {
    Solved wrong = right;
    wrong.problem.tie_gain(0, 0) += sign * Rational(1, 1000000);
    wrong.law = explicitLaw(wrong.problem, wrong.set);
    EXPECT_FALSE(proveRobustMap(MapInMemory(wrong.content()).map(), right.problem).passed());
  }
}

TEST(RobustProof, RefusesASetThatIsTooLargeOrTooSmall) {
  const Solved right(smallRobust());
  Solved large = right;
  // a vertex moved outwards, as where a facet is missing: its plan does not follow
  for (FeasibleSet::Vertex& vertex : large.set.vertices) {
    vertex.y.back() -= Rational(1, 1000000);
    EXPECT_FALSE(proveVertices(large.program, large.set));
    vertex.y.back() += Rational(1, 1000000);
  }
  ProjectOptions quick;
  quick.exact = false;
  large.set = projectFeasibleSet(large.program, quick);
  EXPECT_FALSE(large.proof().lawHolds());
  Solved tight = right;
  for (FeasibleSet::Facet& facet : tight.set.facets) {
    if (!facet.of_box) facet.half_space.b -= Rational(1, 1000);
  }
  EXPECT_FALSE(tight.proof().set_valid);
}

// With bounds narrower than those that the law was made for, one step breaks them: the enumeration sees it.
TEST(RobustProof, SeesBrokenBounds) {
  Solved solved(smallRobust());
  solved.problem.state_ranges[1]->upper = Rational(14, 10);
  const RobustProof proof = solved.proof();
  ASSERT_TRUE(proof.broken_bound.has_value());
  EXPECT_TRUE(holds(proof.broken_bound->rule, "v above its range"));
  EXPECT_FALSE(proof.lawHolds());
  Solved windy(smallRobust());
  windy.problem.G(1, 0) *= 3;
  EXPECT_FALSE(windy.proof().lawHolds());
}

// A position without bounds may leave its box and be cut to it; an error of a bounded state must not, and
// does where a reference adds to it and the box is but the bound's.
TEST(RobustProof, TellsWhichErrorsLeaveTheirBox) {
  const RobustProof alone = Solved(smallRobust()).proof();
  ASSERT_EQ(alone.box_exits.size(), 1u);
  EXPECT_EQ(alone.box_exits[0].parameter, 0);
  EXPECT_TRUE(alone.box_exits[0].clips_safely);
  // 0.08 s at 1.5 m/s, and what the tilt adds, of 1.5 m
  EXPECT_GT(alone.box_exits[0].excess, 0.05);
  EXPECT_LT(alone.box_exits[0].excess, 0.09);
  MadeRobust moving = smallRobust();
  moving.horizon = 2;
  moving.references = true;
  const RobustProof proof = Solved(moving).proof();
  EXPECT_TRUE(std::any_of(proof.box_exits.begin(), proof.box_exits.end(),
                          [](const auto& exit) { return exit.parameter == 1 && !exit.clips_safely; }));
}

TEST(RobustProof, RefusesChangedMaps) {
  const Solved solved(smallRobust());
  const MapContent content = solved.content();
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    MapContent changed = content;
    const std::size_t numbers = k % 2 == 0 ? changed.laws.size() : changed.planes.size();
    const auto entry = static_cast<std::size_t>(random.below(static_cast<int>(numbers)));
    if (k % 2 == 0) {
      changed.laws[entry] += 1e-6;
    } else {
      changePlane(changed, entry, 1e-6);
    }
    EXPECT_FALSE(proveRobustMap(MapInMemory(changed).map(), solved.problem).passed()) << k;
  }
  // Of another box, planes do not have the length 1, which the reader refuses, or the problem has another box.
  MapContent shorter = content;
  shorter.parameters[0].upper = 1.0;
  EXPECT_THROW(proveRobustMap(MapInMemory(shorter).map(), solved.problem), Error);
  MapContent reduced = content;
  reduced.reduced_from = 1;
  EXPECT_THROW(proveRobustMap(MapInMemory(reduced).map(), solved.problem), Error);
}

TEST(RobustProof, SamplesAgreeAndSeeAWrongLaw) {
  const Solved solved(smallRobust());
  MapContent content = solved.content();
  {
    const MapInMemory memory(content);
    const RobustSampling report = sampleRobustMap(memory.map(), solved.problem, 500, 1, 1e-7);
    EXPECT_TRUE(report.passed());
    EXPECT_GT(report.inside, 300u);
    EXPECT_LT(report.peak_error, 1e-9);
  }
  for (int changed = 0; changed < 3; ++changed) {
    MapContent other = content;
    if (changed == 0) other.inputs[0].upper += 0.5;
    if (changed == 1) std::swap(other.parameters[0].name, other.parameters[1].name);
    if (changed == 2) other.period += 0.25;
    const MapInMemory memory(other);
    EXPECT_THROW(sampleRobustMap(memory.map(), solved.problem, 1, 1, 1e-7), Error) << changed;
    EXPECT_THROW(proveRobustMap(memory.map(), solved.problem), Error) << changed;
  }
  for (std::size_t k = 3; k < content.laws.size(); k += 8) content.laws[k] += 1e-4;
  const MapInMemory memory(content);
  EXPECT_FALSE(sampleRobustMap(memory.map(), solved.problem, 500, 1, 1e-7).passed());
}

}  // namespace
}  // namespace polyfly
