#include "map_regions.hpp"

#include <cmath>
#include <utility>

#include "cone.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

double ratio(const Integer& value, const Integer& by) {
  long exponent = 0, other = 0;
  const double mantissa = mpz_get_d_2exp(&exponent, value.get_mpz_t());
  const double divisor = mpz_get_d_2exp(&other, by.get_mpz_t());
  return std::ldexp(mantissa / divisor, static_cast<int>(exponent - other));
}

MapRegions::MapRegions(const RegionMap& map, double tolerance)
    : map_(map),
      tolerance_(tolerance),
      p_(static_cast<int>(map.parameters().size())),
      shapes_(map.regionCount()) {}

ExactHalfSpace MapRegions::row(std::size_t region, std::uint32_t row) const {
  const std::int32_t number = map_.region(region).rows[row];
  const double* plane = map_.plane(static_cast<std::size_t>(std::abs(number)) - 1);
  const double sign = number > 0 ? 1.0 : -1.0;
  ExactHalfSpace result;
  for (int j = 0; j < p_; ++j) result.a.emplace_back(sign * plane[j]);
  result.b = Rational(sign * plane[p_]);
  return result;
}

ExactPolytope MapRegions::polytope(std::size_t region) const {
  RationalVector lower, upper;
  for (const Signal& parameter : map_.parameters()) {
    lower.emplace_back(parameter.lower);
    upper.emplace_back(parameter.upper);
  }
  ExactPolytope result = ExactPolytope::box(lower, upper);
  for (std::uint32_t i = 0; i < map_.region(region).row_count; ++i) result.rows.push_back(row(region, i));
  return result;
}

std::vector<std::vector<Integer>> MapRegions::vertices(std::size_t region, bool& flat) const {
  const PolytopeCone polytope_cone(polytope(region));
  std::vector<std::vector<Integer>> result;
  TightSet common;
  for (const DoubleDescription::Ray& ray : polytope_cone.cone.rays()) {
    common = result.empty() ? ray.tight : common & ray.tight;
    result.push_back(ray.value);
  }
  flat = common.count() > 0;  // a row that is tight at all vertices
  return result;
}

void MapRegions::setShape(std::size_t region, const std::vector<std::vector<Integer>>& vertices) {
  std::vector<double> shape;
  for (const std::vector<Integer>& vertex : vertices) {
    for (std::size_t j = 1; j < vertex.size(); ++j) shape.push_back(ratio(vertex[j], vertex[0]));
  }
  shapes_[region] = std::move(shape);
}

std::vector<std::uint32_t> MapRegions::shaped() const {
  std::vector<std::uint32_t> result;
  for (std::uint32_t r = 0; r < shapes_.size(); ++r) {
    if (!shapes_[r].empty()) result.push_back(r);
  }
  return result;
}

}  // namespace polyfly
