// What is said to begin behind a degenerate facet, against the optimality conditions just behind it.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <set>
#include <vector>

#include "explore/region/compute_region.hpp"
#include "made_program.hpp"

namespace polyfly {
namespace {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// Just behind where the way from the centre to the point beyond crosses the facet.
LongVector behindCrossing(const NormalisedProgram& program, const Region& region, const Facet& facet) {
  constexpr long double kStep = 1e-7L;
  LongVector probe(program.p + 1), way(program.p);
  for (int j = 0; j < program.p; ++j) way(j) = facet.beyond[j] - region.centre[j];
  const long double fraction = crossingFraction(region, facet) + kStep / way.cwiseAbs().maxCoeff();
  for (int j = 0; j < program.p; ++j) probe(j) = region.centre[j] + fraction * way(j);
  probe(program.p) = 1.0L;
  return probe;
}

/// The Karush-Kuhn-Tucker conditions at t = `probe`, (t, 1), in the metric of H: the slacks are D (t, 1) + M M' lambda. Solved
/// for the active rows, none violated.
bool isOptimal(const NormalisedProgram& program, const ActiveSet& active, const LongVector& probe) {
  const auto k = static_cast<Eigen::Index>(active.size());
  const LongMatrix M = program.M.cast<long double>();
  const LongVector distance = program.D.cast<long double>() * probe;
  LongMatrix normals(k, program.n);
  LongVector right(k);
  for (Eigen::Index r = 0; r < k; ++r) {
    normals.row(r) = M.row(active[r]);
    right(r) = -distance(active[r]);
  }
  const LongVector multipliers = (normals * normals.transpose()).fullPivLu().solve(right);
  constexpr long double kRounding = 1e-14L;
  return multipliers.minCoeff() >= -kRounding &&
         (distance + M * (normals.transpose() * multipliers)).minCoeff() >= -kRounding;
}

struct Crossed {
  int exchanges = 0;
  int degenerate = 0;
};

/// Walks over all regions and looks behind each facet.
Crossed crossAll(const NormalisedProgram& program) {
  RegionWorkspace worker(program, ExploreOptions{});
  Crossed crossed;
  ActiveSet first;
  if (!findStart(program, Eigen::VectorXd::Zero(program.p), worker, first)) return crossed;
  std::set<ActiveSet> found{first};
  std::vector<ActiveSet> open{first};
  Region region;
  while (!open.empty()) {
    const ActiveSet active = open.back();
    open.pop_back();
    if (worker.builder.build(active, region) != BuildStatus::kRegion) continue;
    for (const Facet& facet : region.facets) {
      ActiveSetList sets;
      const Crossing crossing = worker.builder.neighbours(active, region, facet, sets);
      if (crossing == Crossing::kDegenerate) ++crossed.degenerate;
      if (crossing == Crossing::kExchange) {
        ++crossed.exchanges;
        const ActiveSet likeliest(sets[0].begin(), sets[0].end());
        EXPECT_TRUE(isOptimal(program, likeliest, behindCrossing(program, region, facet)));
      }
      for (std::size_t k = 0; k < sets.size(); ++k) {
        const ActiveSet set(sets[k].begin(), sets[k].end());
        if (found.insert(set).second) open.push_back(set);
      }
    }
  }
  return crossed;
}

TEST(Neighbours, TheLikeliestBeginsBehindTheCrossing) {
  Crossed all;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const ProgramSize size{2 + static_cast<int>(seed % 2), 10 + static_cast<int>(seed % 5),
                           2 + static_cast<int>(seed % 3)};
    const Crossed crossed = crossAll(normalise(madeProgram(seed, size)));
    all.exchanges += crossed.exchanges;
    all.degenerate += crossed.degenerate;
  }
  EXPECT_GT(all.exchanges, 1000);
  // Fewer facets are left in doubt than are decided.
  EXPECT_LT(all.degenerate, all.exchanges);
}

/// The first two rows are nearly the same, so that what begins behind them is nearly a tie.
TEST(Neighbours, NearTiesAreLeftInDoubtOrRight) {
  int exchanges = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    ParametricProgram program = madeProgram(seed, {2, 10, 2});
    const double distance = std::pow(10.0, -3.0 - static_cast<double>(seed % 6));
    program.A.row(1) = program.A.row(0) + distance * program.A.row(2);
    program.b(1) = program.b(0) + 0.3 * distance;
    program.S.row(1) = program.S.row(0);
    exchanges += crossAll(normalise(program)).exchanges;
  }
  EXPECT_GT(exchanges, 300);
}

TEST(ActiveSetList, RowsAreExchangedInOrder) {
  const ActiveSet active{2, 5, 7};
  ActiveSetList sets;
  const auto pushed = [&](int leaving, int entering) {
    sets.push({active.data(), active.size()}, leaving, entering);
    const RowSpan set = sets[sets.size() - 1];
    return ActiveSet(set.begin(), set.end());
  };
  constexpr int kNone = ActiveSetList::kNone;
  EXPECT_EQ(pushed(kNone, kNone), active);
  EXPECT_EQ(pushed(5, kNone), (ActiveSet{2, 7}));
  EXPECT_EQ(pushed(kNone, 0), (ActiveSet{0, 2, 5, 7}));
  EXPECT_EQ(pushed(kNone, 9), (ActiveSet{2, 5, 7, 9}));
  EXPECT_EQ(pushed(2, 6), (ActiveSet{5, 6, 7}));
  EXPECT_EQ(pushed(7, 3), (ActiveSet{2, 3, 5}));
  EXPECT_EQ(sets.size(), 6u);
  sets.clear();
  EXPECT_TRUE(sets.empty());
}

}  // namespace
}  // namespace polyfly
