#include "tree/cell_solver.hpp"

#include <algorithm>
#include <limits>

#include "tree/plane_sides.hpp"
#include "tree/tolerances.hpp"

namespace polyfly {

CellSolver::CellSolver(const TreeRegions& regions) : regions_(regions), corners_(regions.p) {
  if (regions.p < PolytopeSolver::kMaxDimension) deeper_solver_.emplace(regions.p + 1);
}

void CellSolver::gatherRow(std::int32_t row) {
  const double* const a = regions_.planes.data() + planeOf(row) * (parameters() + 1);
  for (std::size_t j = 0; j <= parameters(); ++j) rows_.push_back(row > 0 ? a[j] : -a[j]);
}

void CellSolver::gatherRows(const Cell& cell, std::size_t plane, unsigned side) {
  rows_.clear();
  for (const std::int32_t row : cell.path) gatherRow(row);
  const auto beyond = static_cast<std::int32_t>(plane) + 1;
  gatherRow(side == kBelow ? beyond : -beyond);
}

double CellSolver::leastSlack(const std::vector<double>& point) const {
  const std::size_t p = parameters();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < rows_.size(); k += p + 1) {
    double slack = rows_[k + p];
    for (std::size_t j = 0; j < p; ++j) slack -= rows_[k + j] * point[j];
    least = std::min(least, slack);
  }
  return least;
}

double CellSolver::depthOf(const Cell& cell, std::size_t plane, unsigned side) {
  gatherRows(cell, plane, side);
  return depth(cell.members.front().inner);
}

// The greatest depth t in the rows a^T theta + t <= b of the cell, the plane and the box.
double CellSolver::depth(std::vector<double> start) {
  if (!deeper_solver_) return -std::numeric_limits<double>::infinity();
  const std::size_t p = parameters();
  std::vector<double> rows = rows_;
  for (std::size_t side_of_box = 0; side_of_box < 2 * p; ++side_of_box) {
    rows.resize(rows.size() + p + 1, 0.0);
    rows[rows.size() - 1 - p + side_of_box / 2] = side_of_box % 2 == 0 ? 1.0 : -1.0;
    rows.back() = 1.0;
  }
  std::vector<double> deeper, direction(p + 1, 0.0), point(p + 1);
  start.push_back(std::numeric_limits<double>::infinity());
  for (auto row = rows.begin(); row != rows.end(); row += static_cast<std::ptrdiff_t>(p) + 1) {
    double slack = row[static_cast<std::ptrdiff_t>(p)];
    for (std::size_t j = 0; j < p; ++j) slack -= row[static_cast<std::ptrdiff_t>(j)] * start[j];
    start.back() = std::min(start.back(), slack);
    deeper.insert(deeper.end(), row, row + static_cast<std::ptrdiff_t>(p));
    deeper.insert(deeper.end(), {1.0, row[static_cast<std::ptrdiff_t>(p)]});
  }
  direction.back() = 1.0;
  const int count = static_cast<int>(deeper.size() / (p + 2));
  if (!deeper_solver_->furthest(deeper.data(), count, start.data(), direction.data(), point.data()))
    return -std::numeric_limits<double>::infinity();
  return point.back();
}

// Where all planes move outwards by d, the cell grows along an axis by d times the sum of their multipliers. A point at
// which a ball of radius r fits in shows that it is at most 2 d / r: the box is 2 wide, and towards the ball's centre a
// share of d / r of the way is enough.
bool CellSolver::hasSharpCorner(const Cell& cell, std::size_t plane, unsigned side) {
  gatherRows(cell, plane, side);
  constexpr double kDeepEnough = 2.0 / tolerance::kMostCornerShift;
  for (const CellMember& member : cell.members) {
    if (leastSlack(member.inner) >= kDeepEnough) return false;
  }
  if (depth(cell.members.front().inner) >= kDeepEnough) return false;
  const auto width = static_cast<std::ptrdiff_t>(parameters() + 1);
  corners_.clear();
  for (auto row = rows_.begin(); row != rows_.end(); row += width)
    corners_.add(std::vector<double>(row, row + width));
  std::vector<double> axis(parameters(), 0.0);
  for (double& entry : axis) {
    for (const double sign : {1.0, -1.0}) {
      entry = sign;
      if (corners_.maximise(axis) != FloatLp::Status::kOptimal) return true;
      double shift = 0.0;
      for (const auto& [row, weight] : corners_.weights()) shift += row < corners_.count() ? weight : 0.0;
      if (!(shift <= tolerance::kMostCornerShift)) return true;
    }
    entry = 0.0;
  }
  return false;
}

}  // namespace polyfly
