// The bound of a loop's excess against its definition, computed by the vertices of all sets: no linear program, and no code
// of the bound. The loop is that of the cart of soft_problems.hpp, whose numbers are written here again.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/explore.hpp"
#include "offline_mpt/loop_excess.hpp"
#include "soft_problems.hpp"

namespace polyfly {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr double kHalfPosition = 10.0;  // [m]
constexpr double kHalfSpeed = 4.0;      // [m/s]
constexpr double kUpperSpeed = 2.5, kLowerSpeed = -2.0;
constexpr double kLevels = 1024.0;  // as loop_excess.hpp says
// Vertices are solutions of three equations whose determinant is greater than this.
constexpr double kIndependent = 1e-7;
constexpr double kRounding = 1e-9;

/// a . s + c as (a, c), over s = (e_p, e_v, w), each in [-1, 1].
using Affine = Vector4d;
using Affines = std::vector<Affine>;

const Affine kPosition(kHalfPosition, 0.0, 0.0, 0.0);
const Affine kSpeed(0.0, kHalfSpeed, 0.0, 0.0);
const Affine kWind(0.0, 0.0, 0.25, 0.05);
const Affine kOne(0.0, 0.0, 0.0, 1.0);

double valueAt(const Affine& function, const Vector3d& s) { return function.head<3>().dot(s) + function(3); }

double greatestOf(const Affines& functions, const std::vector<Vector3d>& points) {
  double greatest = -std::numeric_limits<double>::infinity();
  for (const Affine& function : functions)
    for (const Vector3d& point : points) greatest = std::max(greatest, valueAt(function, point));
  return greatest;
}

/// Vertices of {s in the box: sides(s) <= 0}; none where it has no interior.
std::vector<Vector3d> verticesOf(const Affines& sides) {
  Affines rows;
  for (int j = 0; j < 3; ++j) {
    for (const double sign : {1.0, -1.0}) {
      Affine face = sign * Affine::Unit(j);
      face(3) = -1.0;
      rows.push_back(face);
    }
  }
  for (const Affine& side : sides) {
    const double length = side.head<3>().norm();
    if (length > 1e-12)
      rows.push_back(side / length);
    else if (side(3) > kRounding)
      return {};
  }
  const auto holds = [&rows](const Vector3d& point, double room) {
    return std::all_of(rows.begin(), rows.end(),
                       [&](const Affine& row) { return valueAt(row, point) <= room; });
  };
  std::vector<Vector3d> vertices;
  Vector3d middle = Vector3d::Zero();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Vector3d edge = rows[i].head<3>().cross(rows[j].head<3>());
      for (std::size_t k = 0; k < j; ++k) {
        const double volume = edge.dot(rows[k].head<3>());
        if (std::abs(volume) < kIndependent) continue;
        const Vector3d point = -(rows[k](3) * edge + rows[i](3) * rows[j].head<3>().cross(rows[k].head<3>()) +
                                 rows[j](3) * rows[k].head<3>().cross(rows[i].head<3>())) /
                               volume;
        if (!holds(point, kRounding)) continue;
        vertices.push_back(point);
        middle += point;
      }
    }
  }
  if (vertices.empty() || !holds(middle / static_cast<double>(vertices.size()), -kRounding)) return {};
  return vertices;
}

struct Measure {
  Affines functions;
  double greatest = 0.0;
  double level = 0.0;
};

struct Piece {
  Affines sides;
  std::array<Affine, 2> successor;  // (e_p, e_v) after the step, scaled
  Affines excess;
  std::array<Measure, 2> measures;  // the excess before the step, and that of the prediction
  std::vector<Vector3d> vertices;
  bool reached = false;
};

Affines excessOf(const Affine& speed) { return {speed - kUpperSpeed * kOne, kLowerSpeed * kOne - speed}; }

/// The slacks that are not at their floor, from the equations of the active set.
Affines slacksOf(const ParametricProgram& program, const CriticalRegion& region) {
  const Eigen::Index n = program.H.rows(), m = static_cast<Eigen::Index>(region.active.size());
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(n + m, n + m), right(n + m, 3);
  equations.topLeftCorner(n, n) = program.H;
  right.topRows(n) << -program.F, -program.f;
  for (Eigen::Index i = 0; i < m; ++i) {
    const int row = region.active[static_cast<std::size_t>(i)];
    equations.block(n + i, 0, 1, n) = program.A.row(row);
    equations.block(0, n + i, n, 1) = program.A.row(row).transpose();
    right.row(n + i) << program.S.row(row), program.b(row);
  }
  const Eigen::MatrixXd solution = Eigen::FullPivLU<Eigen::MatrixXd>(equations).solve(right);
  Affines slacks;
  for (const SlackVariable& slack : program.slacks) {
    if (std::count(region.active.begin(), region.active.end(), slack.floor) > 0) continue;
    const Eigen::RowVectorXd law = solution.row(slack.variable);
    slacks.push_back(law(0) * kPosition + law(1) * kSpeed + law(2) * kOne);
  }
  return slacks;
}

Piece pieceOf(const ParametricProgram& program, const CriticalRegion& region) {
  Piece piece;
  for (Eigen::Index i = 0; i < region.G.rows(); ++i)
    piece.sides.push_back(region.G(i, 0) * kPosition + region.G(i, 1) * kSpeed - region.g(i) * kOne);
  const Affine force = region.K(0, 0) * kPosition + region.K(0, 1) * kSpeed + region.k(0) * kOne + kWind;
  const Affine speed = kSpeed + 0.5 * force;
  piece.successor = {(kPosition + 0.5 * kSpeed + 0.125 * force) / kHalfPosition, speed / kHalfSpeed};
  piece.excess = excessOf(speed);
  piece.measures[0].functions = excessOf(kSpeed);
  piece.measures[1].functions = slacksOf(program, region);
  piece.vertices = verticesOf(piece.sides);
  for (Measure& measure : piece.measures)
    measure.greatest = std::max(0.0, greatestOf(measure.functions, piece.vertices));
  return piece;
}

Affines reachedOf(const Piece& piece) {
  Affines sides = piece.sides;
  for (const Measure& measure : piece.measures)
    for (const Affine& function : measure.functions) sides.push_back(function - measure.level * kOne);
  return sides;
}

/// Functions of the parameters after the step, before it.
Affines beforeStep(const Affines& functions, const Piece& from) {
  Affines result;
  for (const Affine& function : functions)
    result.push_back(function(0) * from.successor[0] + function(1) * from.successor[1] + function(3) * kOne);
  return result;
}

bool areApart(const Piece& from, const std::vector<Vector3d>& reached, const Piece& to) {
  for (int j = 0; j < 2; ++j) {
    const Affine entry = Affine::Unit(j);
    const Affine& next = from.successor[static_cast<std::size_t>(j)];
    if (greatestOf({next}, reached) < -greatestOf({-entry}, to.vertices)) return true;
    if (-greatestOf({-next}, reached) > greatestOf({entry}, to.vertices)) return true;
  }
  return false;
}

/// Raises the levels of `to` by what comes from a part of `from`; true where something changed.
bool reach(const Affines& part, const Piece& from, const std::array<double, 2>& steps, Piece* to) {
  Affines sides = part;
  const Affines within = beforeStep(to->sides, from);
  sides.insert(sides.end(), within.begin(), within.end());
  const std::vector<Vector3d> vertices = verticesOf(sides);
  if (vertices.empty()) return false;
  bool changed = !to->reached;
  to->reached = true;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    Measure& measure = to->measures[k];
    const double value = greatestOf(beforeStep(measure.functions, from), vertices);
    if (!(value > measure.level) || measure.level >= measure.greatest) continue;
    measure.level = std::min(measure.greatest, steps[k] * std::ceil(value / steps[k]));
    changed = true;
  }
  return changed;
}

/// The excess that loop_excess.hpp defines.
double excessByVertices(const MpcProblem& problem, const Partition& partition) {
  const ParametricProgram program = condense(problem);
  std::vector<Piece> pieces;
  for (const CriticalRegion& region : partition.regions) pieces.push_back(pieceOf(program, region));
  std::array<double, 2> steps{};
  for (const Piece& piece : pieces)
    for (std::size_t k = 0; k < steps.size(); ++k)
      steps[k] = std::max(steps[k], piece.measures[k].greatest / kLevels);
  for (Piece& piece : pieces) piece.reached = !verticesOf(reachedOf(piece)).empty();
  for (bool grows = true; grows;) {
    grows = false;
    for (Piece& from : pieces) {
      if (!from.reached) continue;
      const Affines part = reachedOf(from);
      const std::vector<Vector3d> vertices = verticesOf(part);
      if (vertices.empty()) continue;
      for (Piece& to : pieces)
        if (!to.vertices.empty() && !areApart(from, vertices, to))
          grows = reach(part, from, steps, &to) || grows;
    }
  }
  double excess = 0.0;
  for (const Piece& piece : pieces)
    if (piece.reached) excess = std::max(excess, greatestOf(piece.excess, verticesOf(reachedOf(piece))));
  return excess;
}

TEST(LoopExcessByVertices, IsWhatLinearProgramsFind) {
  int exceeded = 0;
  for (const char* slack : {"horizon", "stage"}) {
    for (const double weight : {2.0, 30.0}) {
      const std::string text = cartProblem(softSpeed(weight, slack), {2, true});
      const MpcProblem problem = parseProblem(text, "cart.yaml");
      const Partition partition = explore(condense(problem));
      ASSERT_EQ(partition.status, ExploreStatus::kComplete);
      const std::vector<LoopExcess> found = loopExcess(problem, partition);
      ASSERT_EQ(found.size(), 1u);
      const double excess = excessByVertices(problem, partition);
      EXPECT_NEAR(found[0].excess, excess, 1e-7) << slack << ' ' << weight;
      exceeded += excess > 0.01 ? 1 : 0;
    }
  }
  EXPECT_GE(exceeded, 2);
}

}  // namespace
}  // namespace polyfly
