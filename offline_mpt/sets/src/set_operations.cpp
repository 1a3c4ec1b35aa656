#include <algorithm>
#include <string>
#include <utility>

#include "cone.hpp"
#include "offline_mpt/exact_lp.hpp"
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

ExactSupport support(const ExactPolytope& set, const RationalVector& direction) {
  requireDimension(set, direction.size(), "support");
  ExactLp lp;
  lp.addColumns(set.dimension);
  for (int j = 0; j < set.dimension; ++j) {
    lp.setColumnBounds(j, ExactLp::Bound::kFree, 0, 0);
    lp.setObjective(j, direction[static_cast<std::size_t>(j)]);
  }
  lp.setSense(ExactLp::Sense::kMaximise);
  const auto add_row = [&](const ExactHalfSpace& row, ExactLp::Bound type) {
    const int i = lp.addRows(1);
    lp.setRowBounds(i, type, row.b, row.b);
    for (int j = 0; j < set.dimension; ++j) {
      const Rational& value = row.a[static_cast<std::size_t>(j)];
      if (value != 0) lp.setCoefficient(i, j, value);
    }
  };
  for (const ExactHalfSpace& row : set.rows) add_row(row, ExactLp::Bound::kUpper);
  for (const ExactHalfSpace& row : set.equalities) add_row(row, ExactLp::Bound::kFixed);
  ExactSupport result;
  const ExactLp::Status status = lp.solve();
  if (status == ExactLp::Status::kInfeasible) return result;
  result.status =
      status == ExactLp::Status::kOptimal ? ExactSupport::Status::kOptimal : ExactSupport::Status::kUnbounded;
  result.value = lp.objective();
  for (int j = 0; j < set.dimension; ++j) result.point.push_back(lp.primal(j));
  return result;
}

bool isEmpty(const ExactPolytope& set) {
  return support(set, RationalVector(static_cast<std::size_t>(set.dimension))).status ==
         ExactSupport::Status::kEmpty;
}

ExactPolytope intersect(const ExactPolytope& first, const ExactPolytope& second) {
  requireDimension(second, static_cast<std::size_t>(first.dimension), "intersection");
  ExactPolytope result = first;
  result.rows.insert(result.rows.end(), second.rows.begin(), second.rows.end());
  result.equalities.insert(result.equalities.end(), second.equalities.begin(), second.equalities.end());
  return result;
}

ExactPolytope translate(const ExactPolytope& set, const RationalVector& by) {
  requireDimension(set, by.size(), "translation");
  ExactPolytope result = set;
  for (ExactHalfSpace& row : result.rows) row.b += dot(row.a, by);
  for (ExactHalfSpace& row : result.equalities) row.b += dot(row.a, by);
  return result;
}

ExactPolytope affineImage(const ExactPolytope& set, const RationalMatrix& M, const RationalVector& m) {
  requireDimension(set, static_cast<std::size_t>(M.columns()), "affine image");
  Generators all = generators(set);
  for (RationalVector& vertex : all.vertices) vertex = affine(M, vertex, m);
  for (RationalVector& ray : all.rays) ray = affine(M, ray);
  for (RationalVector& line : all.lines) line = affine(M, line);
  return hull(M.rows(), all);
}

ExactPolytope preimage(const ExactPolytope& set, const RationalMatrix& M, const RationalVector& m) {
  requireDimension(set, static_cast<std::size_t>(M.rows()), "affine preimage");
  ExactPolytope result;
  result.dimension = M.columns();
  const auto pull = [&](const ExactHalfSpace& row) {
    return ExactHalfSpace{applyTransposed(M, row.a), m.empty() ? row.b : Rational(row.b - dot(row.a, m))};
  };
  for (const ExactHalfSpace& row : set.rows) result.rows.push_back(pull(row));
  for (const ExactHalfSpace& row : set.equalities) result.equalities.push_back(pull(row));
  return result;
}

ExactPolytope project(const ExactPolytope& set, const std::vector<int>& keep, ProjectionMethod method) {
  std::vector<char> kept(static_cast<std::size_t>(set.dimension), 0);
  for (const int j : keep) {
    if (j < 0 || j >= set.dimension || kept[static_cast<std::size_t>(j)] != 0)
      throw Error("polytope: projection: coordinates to keep must be within 0.." +
                  std::to_string(set.dimension - 1) + " and differ, got " + std::to_string(j));
    kept[static_cast<std::size_t>(j)] = 1;
  }
  if (method == ProjectionMethod::kGenerators) {
    RationalMatrix M(static_cast<int>(keep.size()), set.dimension);
    for (int i = 0; i < M.rows(); ++i) M(i, keep[static_cast<std::size_t>(i)]) = 1;
    return affineImage(set, M);
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

ExactPolytope minkowskiSum(const ExactPolytope& first, const ExactPolytope& second) {
  requireDimension(second, static_cast<std::size_t>(first.dimension), "Minkowski sum");
  const Generators one = generators(first), other = generators(second);
  Generators sum;
  for (const RationalVector& x : one.vertices) {
    for (const RationalVector& y : other.vertices) {
      RationalVector point = x;
      for (std::size_t j = 0; j < point.size(); ++j) point[j] += y[j];
      sum.vertices.push_back(std::move(point));
    }
  }
  for (const Generators* part : {&one, &other}) {
    sum.rays.insert(sum.rays.end(), part->rays.begin(), part->rays.end());
    sum.lines.insert(sum.lines.end(), part->lines.begin(), part->lines.end());
  }
  return hull(first.dimension, sum);
}

ExactPolytope pontryaginDifference(const ExactPolytope& first, const ExactPolytope& second) {
  requireDimension(second, static_cast<std::size_t>(first.dimension), "Pontryagin difference");
  const Generators other = generators(second);
  if (other.vertices.empty()) throw Error("polytope: Pontryagin difference: the second set is empty");
  ExactPolytope result = first;
  bool fits = true;
  const auto shrink = [&](ExactHalfSpace& row, bool equality) {
    Rational greatest = dot(row.a, other.vertices[0]);
    const Rational start = greatest;
    for (const RationalVector& vertex : other.vertices) {
      const Rational value = dot(row.a, vertex);
      if (equality && value != start) fits = false;
      if (value > greatest) greatest = value;
    }
    for (const RationalVector& ray : other.rays)
      fits = fits && (equality ? dot(row.a, ray) == 0 : dot(row.a, ray) <= 0);
    for (const RationalVector& line : other.lines) fits = fits && dot(row.a, line) == 0;
    row.b -= greatest;
  };
  for (ExactHalfSpace& row : result.rows) shrink(row, false);
  for (ExactHalfSpace& row : result.equalities) shrink(row, true);
  return fits ? minimal(result) : hull(first.dimension, std::vector<RationalVector>());
}

std::vector<ExactPolytope> subtract(const ExactPolytope& set, const ExactPolytope& cut) {
  requireDimension(cut, static_cast<std::size_t>(set.dimension), "difference");
  std::vector<ExactPolytope> parts;
  ExactPolytope rest = minimal(set);
  std::vector<ExactHalfSpace> rows = cut.rows;
  for (const ExactHalfSpace& row : cut.equalities) {
    rows.push_back(row);
    ExactHalfSpace other{row.a, Rational(-row.b)};
    for (Rational& value : other.a) value = -value;
    rows.push_back(std::move(other));
  }
  for (const ExactHalfSpace& row : rows) {
    ExactPolytope outside = rest;
    ExactHalfSpace other{row.a, Rational(-row.b)};
    for (Rational& value : other.a) value = -value;
    outside.rows.push_back(std::move(other));
    outside = minimal(outside);
    if (affineDimension(outside) == set.dimension) parts.push_back(std::move(outside));
    rest.rows.push_back(row);
    rest = minimal(rest);
  }
  return parts;
}

}  // namespace polyfly
