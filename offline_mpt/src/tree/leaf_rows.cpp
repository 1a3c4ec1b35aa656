// Which rows of its candidates a leaf tests.
#include <algorithm>
#include <utility>

#include "region_maps/format.hpp"
#include "tree/member_solver.hpp"
#include "tree/tolerances.hpp"

namespace polyfly {

// Where two rows to test meet at a sharp angle, a row that only touches their edge may be violated by a multiple of the
// tolerance. Mostly the splits on the way have shown that no row is, see CellMember::excess. Otherwise one look at all of
// them may show it.
void MemberSolver::addRowsForTolerance(CellMember& member, const std::vector<std::int32_t>& path) {
  if (member.excess <= tolerance::kUntestedReach) return;
  const std::vector<std::int32_t>& all = regions_.rows[member.region];
  rows_.clear();
  for (const std::int32_t row : member.walls) gatherRow(row, roundingOf(row));
  for (const std::int32_t row : member.rows) gatherRow(row, format::kMaxTolerance);
  questioned_.clear();
  std::size_t next = 0;  // of member.rows, which are in the order of `all`
  for (const std::int32_t row : all) {
    if (next < member.rows.size() && member.rows[next] == row) {
      ++next;
    } else if (!boundsBox(row) && std::find(path.begin(), path.end(), row) == path.end()) {
      questioned_.push_back(row);
    }
  }
  if (questioned_.empty()) return;
  for (const std::int32_t row : questioned_)
    gatherRow(row, tolerance::kUntestedReach * format::kMaxTolerance);
  const int kept = static_cast<int>(member.bounds());
  const int count = kept + static_cast<int>(questioned_.size());
  if (solver_.minimalBeside(kept, rows_.data(), count, member.inner.data(), tolerance::kImpliedRow,
                            minimal_)) {
    std::vector<std::int32_t> left;
    for (const int facet : minimal_.facets)
      left.push_back(questioned_[static_cast<std::size_t>(facet - kept)]);
    questioned_ = std::move(left);
  }
  if (!questioned_.empty()) addRows(member, path);
}

// Adds those of the questioned rows that all bounds of the cell do not hold within the tolerance either.
void MemberSolver::addRows(CellMember& member, const std::vector<std::int32_t>& path) {
  const std::size_t p = parameters();
  const std::vector<std::int32_t>& all = regions_.rows[member.region];
  rows_.clear();
  for (const std::int32_t row : path) gatherRow(row, tolerance::kMissedPlane);
  for (const std::int32_t row : all) {
    if (boundsBox(row)) gatherRow(row, tolerance::kMissedBox);
  }
  for (const std::int32_t row : member.rows) gatherRow(row, format::kMaxTolerance);
  std::vector<std::int32_t> tested;
  std::size_t next = 0;
  for (const std::int32_t row : all) {
    if (next < member.rows.size() && member.rows[next] == row) {
      tested.push_back(row);
      ++next;
    } else if (std::find(questioned_.begin(), questioned_.end(), row) != questioned_.end()) {
      const double* const a = plane(planeOf(row));
      const double factor = row > 0 ? 1.0 : -1.0;
      for (std::size_t j = 0; j < p; ++j) direction_[j] = factor * a[j];
      const int count = static_cast<int>(rows_.size() / (p + 1));
      // In doubt the row is tested.
      if (solver_.furthestInDoubles(rows_.data(), count, member.inner.data(), direction_.data(),
                                    point_.data()) &&
          factor * kernels_.distance(a, point_.data(), p) <=
              tolerance::kUntestedReach * format::kMaxTolerance)
        continue;
      tested.push_back(row);
      gatherRow(row, format::kMaxTolerance);
    }
  }
  member.rows = std::move(tested);
}

std::uint32_t MemberSolver::testsOf(const CellMember& member) const {
  constexpr std::size_t kLastBit = 31;
  const std::vector<std::int32_t>& all = regions_.rows[member.region];
  std::uint32_t tests = 0;
  std::size_t next = 0;
  for (std::size_t i = 0; i < all.size() && next < member.rows.size(); ++i) {
    if (all[i] != member.rows[next]) continue;
    tests |= std::uint32_t{1} << std::min(i, kLastBit);
    ++next;
  }
  return tests;
}

std::uint32_t MemberSolver::testsAt(std::uint32_t region, const std::vector<std::int32_t>& path) {
  CellMember member = whole(region);
  for (const std::int32_t row : path) {
    const std::size_t plane = planeOf(row);
    const unsigned side = row > 0 ? kBelow : kAbove;
    const unsigned reached = sides(member, plane);
    if ((reached & side) == 0) {
      member.rows = regions_.rows[region];
      return testsOf(member);
    }
    if (reached == side)
      enter(member, plane, side);
    else
      member = half(member, plane, side);
  }
  addRowsForTolerance(member, path);
  return testsOf(member);
}

}  // namespace polyfly
