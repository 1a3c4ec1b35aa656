// Cells of a search tree: parts of regions, the rows that leaves test, depths and corners.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "offline_mpt/search_tree.hpp"
#include "program/normalised_program.hpp"
#include "region_maps/format.hpp"
#include "tree/cell_solver.hpp"
#include "tree/member_solver.hpp"
#include "tree/tolerances.hpp"

namespace polyfly {
namespace {

/// A regular polygon of many sides, and planes 0: x <= 0, 1 and 2: cut off its uppermost and lowest points on
/// x = 0, which are no corners.
TreeRegions polygonWithCuts() {
  constexpr int kSides = 60;
  constexpr double kTurn = 2.0 * M_PI / kSides;
  // Height at which x = 0 meets a side.
  const double top = 0.9 / std::cos(0.25 * kTurn);
  TreeRegions regions;
  regions.p = 2;
  regions.planes = {1.0, 0.0, 0.0, 0.6, 0.8, 0.8 * top - 1e-3, 0.6, -0.8, 0.8 * top - 1e-3};
  regions.rows.emplace_back();
  for (int k = 0; k < kSides; ++k) {
    const double angle = (k + 0.25) * kTurn;
    regions.planes.insert(regions.planes.end(), {std::cos(angle), std::sin(angle), 0.9});
    regions.rows[0].push_back(k + 4);
  }
  regions.centres = {0.0, 0.0};
  return regions;
}

// The part on one side once kept an inner point on the other, and then seemed to reach where it does not: the tree got
// leaves without interior, and parameters in them, by rounding, no answer.
TEST(SearchTree, PartsOfRegionsKeepAPointInside) {
  const TreeRegions regions = polygonWithCuts();
  MemberSolver solver(regions, 1e-9);
  CellMember whole = solver.whole(0);
  ASSERT_EQ(solver.sides(whole, 0), kBelow | kAbove);
  const CellMember left = solver.half(whole, 0, kBelow);
  for (const std::size_t plane : {std::size_t{1}, std::size_t{2}}) {
    CellMember member = left;
    ASSERT_EQ(solver.sides(member, plane), kBelow | kAbove);
    ASSERT_EQ(solver.sides(member, 3 - plane), kBelow | kAbove);
    const CellMember below = solver.half(member, plane, kBelow);
    const CellMember above = solver.half(member, plane, kAbove);
    const auto distance = [&](std::size_t of, const CellMember& part) {
      const double* row = regions.planes.data() + 3 * of;
      return row[0] * part.inner[0] + row[1] * part.inner[1] - row[2];
    };
    EXPECT_LT(distance(plane, below), 0.0);
    EXPECT_GT(distance(plane, above), 0.0);
    EXPECT_LT(distance(0, above), 0.0);
    for (std::size_t k = 3; k < regions.planes.size() / 3; ++k) EXPECT_LT(distance(k, above), 0.0);
    EXPECT_LT(above.rows.size(), 8u);  // the sides about its tip
    EXPECT_EQ(above.walls.size(), 2u);
  }
}

// The plane of a node and x <= 1 meet just below y = 0.3: together they imply y <= 0.3. Look-ups accept x <= 1 + 2^-26, and
// then y may be greater by `steep` times as much.
TEST(SearchTree, RowsThatTheWiderBoxOfLookupsLetsExceedAreTested) {
  constexpr double kMeet = 0.3 - 1e-10;
  for (const double steep : {0.5, 2.0, 3.0, 3.6, 5.0, 6.0, 20.0}) {
    SCOPED_TRACE(steep);
    const double length = std::hypot(1.0, steep);
    TreeRegions regions;
    regions.p = 2;
    regions.planes = {-steep / length,
                      1.0 / length,
                      (kMeet - steep) / length,
                      0.0,
                      1.0,
                      0.3,
                      1.0,
                      0.0,
                      1.0,
                      0.0,
                      1.0,
                      -0.5,
                      1.0,
                      0.0,
                      0.0};
    regions.rows = {{2, 3, -4, -5}};
    regions.centres = {0.5, 0.0};
    MemberSolver solver(regions, 1e-12);
    const bool is_tested = isTested(solver.testsAt(0, {1}), 0);
    const double reach = kMeet + steep * std::ldexp(1.0, -26) - 0.3;
    EXPECT_EQ(is_tested, reach > tolerance::kUntestedReach * format::kMaxTolerance);
  }
}

// A depth is one dimension more than the parameters.
TEST(SearchTree, DepthsOfCellsAreFoundForAsManyParametersAsAreExplored) {
  const auto p = static_cast<std::size_t>(kMostParameters);
  TreeRegions regions;
  regions.p = kMostParameters;
  regions.planes.assign(p + 1, 0.0);
  regions.planes.front() = 1.0;
  regions.planes.back() = -0.5;
  regions.rows.resize(1);
  regions.centres.assign(p, 0.0);
  const Cell box{{MemberSolver(regions, 1e-9).whole(0)}, {}};
  CellSolver solver(regions);
  EXPECT_NEAR(solver.depthOf(box, 0, kBelow), 0.25, 1e-12);
  EXPECT_NEAR(solver.depthOf(box, 0, kAbove), 0.75, 1e-12);
}

/// A cell within three planes a . t + slope t_2 <= width, whose a have angles of 120 degrees: it has a corner at
/// t_2 = width / slope.
TreeRegions needle(double slope, double width) {
  TreeRegions regions;
  regions.p = 3;
  for (int k = 0; k < 3; ++k) {
    const double angle = 2.0 * M_PI * k / 3.0;
    const double length = std::sqrt(1.0 + slope * slope);
    regions.planes.insert(regions.planes.end(), {std::cos(angle) / length, std::sin(angle) / length,
                                                 slope / length, width / length});
  }
  return regions;
}

// Where all planes move outwards by d, the corner moves by d / slope along the axis.
TEST(SearchTree, CornersThatRoundingMovesFarAreRecognised) {
  for (const double slope : {1e-1, 1e-2, 1e-3, 2e-4, 1e-5, 1e-6}) {
    const TreeRegions regions = needle(slope, 0.1 * slope);
    CellMember member;
    member.inner = {0.0, 0.0, -0.5};
    CellSolver solver(regions);
    EXPECT_EQ(solver.hasSharpCorner({{member}, {1, 2}}, 2, kBelow), slope < 1e-4) << slope;
  }
}

// Its corners lie at right angles, on the sides of the box.
TEST(SearchTree, AThinCellAloneHasNoSharpCorner) {
  for (const double thickness : {1e-2, 1e-6, 1e-9}) {
    TreeRegions regions;
    regions.p = 2;
    regions.planes = {1.0, 0.0, thickness, 1.0, 0.0, -thickness};
    CellMember member;
    member.inner = {0.0, 0.0};
    CellSolver solver(regions);
    EXPECT_FALSE(solver.hasSharpCorner({{member}, {1}}, 1, kAbove)) << thickness;
  }
}

}  // namespace
}  // namespace polyfly
