#include <algorithm>
#include <string>
#include <utility>

#include "cone.hpp"
#include "polyfly_base/error.hpp"
#include "polytope_sets/exact_polytope.hpp"

namespace polyfly {
namespace {

// What is left of the rows when coordinate `column` may be anything. An equality that holds it is solved for
// it; else each upper bound on it meets each lower one.
ExactPolytope eliminate(const ExactPolytope& set, int column) {
  const auto at = static_cast<std::size_t>(column);
  ExactPolytope result;
  result.dimension = set.dimension - 1;
  const auto drop = [&](ExactHalfSpace row) {
    row.a.erase(row.a.begin() + column);
    return row;
  };
  const auto combine = [&](const ExactHalfSpace& x, const Rational& weight, const ExactHalfSpace& y,
                           const Rational& other) {
    ExactHalfSpace row{RationalVector(x.a.size()), x.b * weight + y.b * other};
    for (std::size_t j = 0; j < x.a.size(); ++j) row.a[j] = x.a[j] * weight + y.a[j] * other;
    return drop(std::move(row));
  };
  const auto pivot = std::find_if(set.equalities.begin(), set.equalities.end(),
                                  [&](const ExactHalfSpace& row) { return row.a[at] != 0; });
  for (auto row = set.equalities.begin(); row != set.equalities.end(); ++row) {
    if (row == pivot) continue;
    result.equalities.push_back(pivot == set.equalities.end()
                                    ? drop(*row)
                                    : combine(*row, 1, *pivot, Rational(-row->a[at] / pivot->a[at])));
  }
  for (const ExactHalfSpace& row : set.rows) {
    if (row.a[at] == 0) {
      result.rows.push_back(drop(row));
    } else if (pivot != set.equalities.end()) {
      result.rows.push_back(combine(row, 1, *pivot, Rational(-row.a[at] / pivot->a[at])));
    } else if (row.a[at] > 0) {
      for (const ExactHalfSpace& lower : set.rows) {
        if (lower.a[at] < 0) result.rows.push_back(combine(row, Rational(-lower.a[at]), lower, row.a[at]));
      }
    }
  }
  return result;
}

ExactPolytope reorder(const ExactPolytope& set, const std::vector<std::size_t>& places) {
  ExactPolytope result = set;
  const auto move = [&](std::vector<ExactHalfSpace>& to, const std::vector<ExactHalfSpace>& from) {
    for (std::size_t i = 0; i < to.size(); ++i) {
      for (std::size_t j = 0; j < places.size(); ++j) to[i].a[j] = from[i].a[places[j]];
    }
  };
  move(result.rows, set.rows);
  move(result.equalities, set.equalities);
  return result;
}

}  // namespace

ExactPolytope intersect(const ExactPolytope& first, const ExactPolytope& second) {
  requireDimension(second, static_cast<std::size_t>(first.dimension), "intersection");
  ExactPolytope result = first;
  result.rows.insert(result.rows.end(), second.rows.begin(), second.rows.end());
  result.equalities.insert(result.equalities.end(), second.equalities.begin(), second.equalities.end());
  return result;
}

ExactPolytope preimage(const ExactPolytope& set, const RationalMatrix& M, const RationalVector& m) {
  requireDimension(set, static_cast<std::size_t>(M.rows()), "affine preimage");
  ExactPolytope result;
  result.dimension = static_cast<int>(M.cols());
  const auto pull = [&](const ExactHalfSpace& row) {
    return ExactHalfSpace{applyTransposed(M, row.a), m.empty() ? row.b : Rational(row.b - dot(row.a, m))};
  };
  for (const ExactHalfSpace& row : set.rows) result.rows.push_back(pull(row));
  for (const ExactHalfSpace& row : set.equalities) result.equalities.push_back(pull(row));
  return result;
}

ExactPolytope project(const ExactPolytope& set, const std::vector<int>& keep) {
  std::vector<char> kept(static_cast<std::size_t>(set.dimension), 0);
  for (const int j : keep) {
    if (j < 0 || j >= set.dimension || kept[static_cast<std::size_t>(j)] != 0)
      throw Error("polytope: projection: coordinates to keep must be within 0.." +
                  std::to_string(set.dimension - 1) + " and differ, got " + std::to_string(j));
    kept[static_cast<std::size_t>(j)] = 1;
  }
  ExactPolytope result = minimal(set);
  for (int j = set.dimension - 1; j >= 0; --j) {
    if (kept[static_cast<std::size_t>(j)] == 0) result = minimal(eliminate(result, j));
  }
  // Place of each kept coordinate among the kept ones in ascending order.
  std::vector<std::size_t> places;
  for (const int j : keep)
    places.push_back(static_cast<std::size_t>(
        std::count_if(keep.begin(), keep.end(), [j](int other) { return other < j; })));
  return reorder(result, places);
}

}  // namespace polyfly
