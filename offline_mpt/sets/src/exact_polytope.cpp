#include "polytope_sets/exact_polytope.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "cone.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {

void requireDimension(const ExactPolytope& set, std::size_t dimension, const char* what) {
  if (static_cast<std::size_t>(set.dimension) == dimension) return;
  throw Error(std::string("polytope: ") + what + ": needs " + std::to_string(dimension) +
              " dimensions, got " + std::to_string(set.dimension));
}

std::vector<Integer> coneRow(const ExactHalfSpace& row) {
  RationalVector values{row.b};
  for (const Rational& a : row.a) values.emplace_back(-a);
  return wholeNumbers(values);
}

std::vector<Integer> homogeneous(const RationalVector& point) {
  RationalVector values{Rational(1)};
  values.insert(values.end(), point.begin(), point.end());
  return wholeNumbers(values);
}

RationalVector pointOf(const std::vector<Integer>& ray) {
  RationalVector result;
  for (std::size_t j = 1; j < ray.size(); ++j) {
    result.emplace_back(ray[j], ray[0] == 0 ? Integer(1) : ray[0]);
    result.back().canonicalize();
  }
  return result;
}

std::vector<std::vector<Integer>> raysOf(const DoubleDescription& cone) {
  std::vector<std::vector<Integer>> result;
  for (const DoubleDescription::Ray& ray : cone.rays()) result.push_back(ray.value);
  return result;
}

namespace {

ExactHalfSpace halfSpace(const std::vector<Integer>& cone_row) {
  ExactHalfSpace row;
  row.b = cone_row[0];
  for (std::size_t j = 1; j < cone_row.size(); ++j) row.a.emplace_back(-cone_row[j]);
  return row;
}

ExactHalfSpace emptyRow(int dimension) {
  return {RationalVector(static_cast<std::size_t>(dimension)), Rational(-1)};
}

std::vector<Integer> generatorRow(const Rational& head, const RationalVector& entries, int dimension) {
  if (entries.size() != static_cast<std::size_t>(dimension)) {
    throw Error("polytope: generator: needs " + std::to_string(dimension) + " entries, got " +
                std::to_string(entries.size()));
  }
  RationalVector values{head};
  values.insert(values.end(), entries.begin(), entries.end());
  return wholeNumbers(values);
}

}  // namespace

PolytopeCone::PolytopeCone(const ExactPolytope& set) : cone(set.dimension + 1) {
  std::vector<Integer> infinity(static_cast<std::size_t>(set.dimension) + 1);
  infinity[0] = 1;
  cone.add(infinity);
  for (const ExactHalfSpace& row : set.equalities) cone.add(coneRow(row), true);
  // Rows in lexicographic order keep the number of rays on the way small (Fukuda and Prodon).
  std::vector<std::pair<std::vector<Integer>, std::size_t>> order;
  for (std::size_t i = 0; i < set.rows.size(); ++i) order.emplace_back(coneRow(set.rows[i]), i);
  std::sort(order.begin(), order.end());
  place.resize(set.rows.size());
  for (const auto& [row, index] : order) place[index] = cone.add(row);
}

bool PolytopeCone::isEmpty() const {
  return std::none_of(cone.rays().begin(), cone.rays().end(),
                      [](const DoubleDescription::Ray& ray) { return ray.value[0] > 0; });
}

ExactPolytope ExactPolytope::box(const RationalVector& lower, const RationalVector& upper) {
  ExactPolytope result;
  result.dimension = static_cast<int>(lower.size());
  for (std::size_t j = 0; j < lower.size(); ++j) {
    ExactHalfSpace row{RationalVector(lower.size()), upper[j]};
    row.a[j] = 1;
    result.rows.push_back(row);
    row.a[j] = -1;
    row.b = -lower[j];
    result.rows.push_back(std::move(row));
  }
  return result;
}

Generators generators(const ExactPolytope& set) {
  const PolytopeCone polytope(set);
  Generators result;
  if (polytope.isEmpty()) return result;
  for (const DoubleDescription::Ray& ray : polytope.cone.rays())
    (ray.value[0] > 0 ? result.vertices : result.rays).push_back(pointOf(ray.value));
  for (const std::vector<Integer>& line : polytope.cone.lines()) result.lines.push_back(pointOf(line));
  std::sort(result.vertices.begin(), result.vertices.end());
  std::sort(result.rays.begin(), result.rays.end());
  return result;
}

std::vector<RationalVector> vertices(const ExactPolytope& set) {
  Generators all = generators(set);
  if (!all.rays.empty() || !all.lines.empty()) throw Error("polytope: is unbounded");
  return std::move(all.vertices);
}

ExactPolytope hull(int dimension, const Generators& all) {
  ExactPolytope result;
  result.dimension = dimension;
  if (all.vertices.empty()) {
    result.rows.push_back(emptyRow(dimension));
    return result;
  }
  std::vector<std::vector<Integer>> points;
  for (const RationalVector& point : all.vertices) points.push_back(generatorRow(1, point, dimension));
  for (const RationalVector& ray : all.rays) points.push_back(generatorRow(0, ray, dimension));
  std::sort(points.begin(), points.end());
  DoubleDescription cone(dimension + 1);
  for (const RationalVector& line : all.lines) cone.add(generatorRow(0, line, dimension), true);
  for (const std::vector<Integer>& point : points) cone.add(point);
  for (const std::vector<Integer>& line : cone.lines()) result.equalities.push_back(halfSpace(line));
  for (const DoubleDescription::Ray& ray : cone.rays()) {
    const bool bounds =
        std::any_of(ray.value.begin() + 1, ray.value.end(), [](const Integer& value) { return value != 0; });
    if (bounds) result.rows.push_back(halfSpace(ray.value));
  }
  std::sort(result.rows.begin(), result.rows.end(), [](const ExactHalfSpace& x, const ExactHalfSpace& y) {
    return x.a != y.a ? x.a < y.a : x.b < y.b;
  });
  return result;
}

ExactPolytope hull(int dimension, const std::vector<RationalVector>& points) {
  Generators all;
  all.vertices = points;
  return hull(dimension, all);
}

// A row's face is the set of generators on it. It is a facet when no other row's face holds it; all of the
// set when the row is an equality.
ExactPolytope minimal(const ExactPolytope& set) {
  const PolytopeCone polytope(set);
  ExactPolytope result;
  result.dimension = set.dimension;
  if (polytope.isEmpty()) {
    result.rows.push_back(emptyRow(set.dimension));
    return result;
  }
  const auto& rays = polytope.cone.rays();
  std::vector<TightSet> faces(set.rows.size());
  TightSet all, infinity;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    all.set(k);
    if (rays[k].value[0] == 0) infinity.set(k);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (rays[k].tight.test(polytope.place[i])) faces[i].set(k);
    }
  }
  // Tells whether an equality follows from those before it.
  DoubleDescription flat(set.dimension + 1);
  const auto add_equality = [&](const ExactHalfSpace& row) {
    const std::vector<Integer> values = coneRow(row);
    const bool depends = std::all_of(flat.lines().begin(), flat.lines().end(),
                                     [&](const auto& line) { return dot(values, line) == 0; });
    if (depends) return;
    flat.add(values, true);
    result.equalities.push_back(halfSpace(values));
  };
  for (const ExactHalfSpace& row : set.equalities) add_equality(row);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces[i] == all) add_equality(set.rows[i]);
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces[i] == all || infinity.contains(faces[i])) continue;
    bool needed = true;
    for (std::size_t j = 0; j < faces.size() && needed; ++j) {
      if (j == i || faces[j] == all || !faces[j].contains(faces[i])) continue;
      needed = i < j && faces[i].contains(faces[j]);
    }
    if (needed) result.rows.push_back(halfSpace(coneRow(set.rows[i])));
  }
  return result;
}

bool isBounded(const ExactPolytope& set) {
  const Generators all = generators(set);
  return all.rays.empty() && all.lines.empty();
}

int affineDimension(const ExactPolytope& set) {
  const ExactPolytope smallest = minimal(set);
  if (smallest.rows.size() == 1 && smallest.rows[0].b < 0 &&
      std::all_of(smallest.rows[0].a.begin(), smallest.rows[0].a.end(),
                  [](const Rational& value) { return value == 0; })) {
    return -1;
  }
  return set.dimension - static_cast<int>(smallest.equalities.size());
}

bool contains(const ExactPolytope& set, const RationalVector& point) {
  requireDimension(set, point.size(), "membership");
  return std::all_of(set.rows.begin(), set.rows.end(),
                     [&](const ExactHalfSpace& row) { return dot(row.a, point) <= row.b; }) &&
         std::all_of(set.equalities.begin(), set.equalities.end(),
                     [&](const ExactHalfSpace& row) { return dot(row.a, point) == row.b; });
}

bool contains(const ExactPolytope& outer, const ExactPolytope& inner) {
  requireDimension(outer, static_cast<std::size_t>(inner.dimension), "containment");
  const Generators all = generators(inner);
  if (all.vertices.empty()) return true;
  const auto within = [&](const ExactHalfSpace& row, bool equality) {
    const auto rises = [&](const RationalVector& ray) {
      const int sign = sgn(dot(row.a, ray));
      return equality ? sign != 0 : sign > 0;
    };
    return std::none_of(all.rays.begin(), all.rays.end(), rises) &&
           std::all_of(all.lines.begin(), all.lines.end(),
                       [&](const RationalVector& line) { return dot(row.a, line) == 0; });
  };
  return std::all_of(all.vertices.begin(), all.vertices.end(),
                     [&](const RationalVector& vertex) { return contains(outer, vertex); }) &&
         std::all_of(outer.rows.begin(), outer.rows.end(),
                     [&](const ExactHalfSpace& row) { return within(row, false); }) &&
         std::all_of(outer.equalities.begin(), outer.equalities.end(),
                     [&](const ExactHalfSpace& row) { return within(row, true); });
}

bool equal(const ExactPolytope& first, const ExactPolytope& second) {
  return contains(first, second) && contains(second, first);
}

}  // namespace polyfly
