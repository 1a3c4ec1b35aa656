#include "map_regions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "cone.hpp"
#include "polytope_sets/analyze_map.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

namespace {

/// A row of a plane, negated or not, moved outwards.
ExactHalfSpace halfSpaceOf(const double* plane, int p, double sign, const Rational& moved) {
  ExactHalfSpace row;
  for (int j = 0; j < p; ++j) row.a.emplace_back(sign * plane[j]);
  row.b = Rational(sign * plane[p]) + moved;
  return row;
}

/// value / by, rounded without exact division: for guesses.
double ratio(const Integer& value, const Integer& by) {
  long exponent = 0, other = 0;
  const double mantissa = mpz_get_d_2exp(&exponent, value.get_mpz_t());
  const double divisor = mpz_get_d_2exp(&other, by.get_mpz_t());
  return std::ldexp(mantissa / divisor, static_cast<int>(exponent - other));
}

}  // namespace

MapRegions::MapRegions(const RegionMap& map, double tolerance)
    : map_(map),
      tolerance_(tolerance),
      p_(static_cast<int>(map.parameters().size())),
      shapes_(map.regionCount()) {
  for (std::size_t i = 0; i < map.planeCount(); ++i) {
    for (const double sign : {1.0, -1.0}) {
      for (const double moved : {0.0, tolerance})
        insides_.push_back(coneRow(halfSpaceOf(map.plane(i), p_, sign, Rational(moved))));
    }
  }
}

const std::vector<Integer>& MapRegions::inside(std::int32_t row, bool moved) const {
  const std::size_t first = 4 * (static_cast<std::size_t>(std::abs(row)) - 1);
  return insides_[first + (row > 0 ? 0 : 2) + (moved ? 1 : 0)];
}

bool MapRegions::holds(std::uint32_t region, const std::vector<Integer>& point, bool moved) const {
  const RegionView view = map_.region(region);
  return std::all_of(view.rows, view.rows + view.row_count,
                     [&](std::int32_t row) { return dot(inside(row, moved), point) >= 0; });
}

ExactPolytope regionPolytope(const RegionMap& map, std::size_t region, const Rational& moved) {
  RationalVector lower, upper;
  for (const Signal& parameter : map.parameters()) {
    lower.emplace_back(parameter.lower);
    upper.emplace_back(parameter.upper);
  }
  ExactPolytope result = ExactPolytope::box(lower, upper);
  const RegionView view = map.region(region);
  for (std::uint32_t i = 0; i < view.row_count; ++i) {
    const double* const plane = map.plane(static_cast<std::size_t>(std::abs(view.rows[i])) - 1);
    result.rows.push_back(halfSpaceOf(plane, result.dimension, view.rows[i] > 0 ? 1.0 : -1.0, moved));
  }
  return result;
}

std::vector<std::vector<Integer>> MapRegions::vertices(std::size_t region) const {
  return raysOf(PolytopeCone(regionPolytope(map_, region)).cone);
}

void MapRegions::setShape(std::size_t region, const std::vector<std::vector<Integer>>& vertices) {
  std::vector<double> shape;
  for (const std::vector<Integer>& vertex : vertices) {
    for (std::size_t j = 1; j < vertex.size(); ++j) shape.push_back(ratio(vertex[j], vertex[0]));
  }
  shapes_[region] = std::move(shape);
}

}  // namespace polyfly
