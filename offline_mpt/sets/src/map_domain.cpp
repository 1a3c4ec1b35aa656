#include "map_domain.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"
#include "tolerances.hpp"
#include "vertex_tests.hpp"

namespace polyfly {
namespace {

/// A half-space sign * (a . theta - c) <= 0 in t, where planes are unit vectors.
struct ScaledRow {
  std::vector<double> unit;  // p + 1 numbers
  ExactHalfSpace exact;
};

class DomainGuess {
 public:
  explicit DomainGuess(const MapRegions& regions) : regions_(regions), p_(regions.parameters()) {
    for (const Signal& parameter : regions.map().parameters()) {
      centre_.push_back(0.5 * (parameter.lower + parameter.upper));
      half_.push_back(0.5 * (parameter.upper - parameter.lower));
    }
    addBox();
  }

  void addPlane(std::size_t index, double sign) {
    const double* plane = regions_.map().plane(index);
    ScaledRow row;
    double constant = plane[p_];
    for (int j = 0; j < p_; ++j) {
      row.unit.push_back(sign * plane[j] * half_[static_cast<std::size_t>(j)]);
      constant -= plane[j] * centre_[static_cast<std::size_t>(j)];
      row.exact.a.emplace_back(sign * plane[j]);
    }
    row.unit.push_back(sign * constant);
    row.exact.b = Rational(sign * plane[p_]);
    const auto same = [&](const ScaledRow& other) {
      for (std::size_t j = 0; j < row.unit.size(); ++j) {
        if (std::abs(row.unit[j] - other.unit[j]) > tolerance::kSameDomainSide) return false;
      }
      return true;
    };
    // A side of the box may be there in several roundings: exactly parallel, so that only the innermost
    // counts.
    const bool side = std::count(row.unit.begin(), row.unit.end() - 1, 0.0) == p_ - 1;
    if ((!side && std::any_of(rows_.begin(), rows_.end(), same)) || !holdsAll(plane, sign)) return;
    rows_.push_back(std::move(row));
  }

  std::vector<ExactHalfSpace> needed() const {
    ExactPolytope set;
    set.dimension = p_;
    for (const ScaledRow& row : rows_) set.rows.push_back(row.exact);
    // With a tolerance as wide as the domain, all half-spaces are outer ones, and nothing is within all of them.
    if (affineDimension(set) < 0)
      throw Error("tolerance: is so wide that nothing remains of the map's domain");
    return scaledRows(set, regions_.map());
  }

 private:
  void addBox() {
    const auto size = static_cast<std::size_t>(p_);
    for (std::size_t j = 0; j < size; ++j) {
      const Signal& parameter = regions_.map().parameters()[j];
      for (const double sign : {1.0, -1.0}) {
        ScaledRow row;
        row.unit.assign(size + 1, 0.0);
        row.unit[j] = sign;
        row.unit[size] = 1.0;
        row.exact.a.resize(size);
        row.exact.a[j] = Rational(half_[j] > 0.0 ? sign / half_[j] : sign);
        row.exact.b = row.exact.a[j] * Rational(sign > 0.0 ? parameter.upper : parameter.lower);
        rows_.push_back(std::move(row));
      }
    }
  }

  bool holdsAll(const double* plane, double sign) const {
    const double limit = std::max(regions_.tolerance(), tolerance::kVertexRounding);
    for (std::size_t r = 0; r < regions_.count(); ++r) {
      const std::vector<double>& shape = regions_.shape(r);
      for (std::size_t k = 0; k < shape.size(); k += static_cast<std::size_t>(p_)) {
        double value = -plane[p_];
        for (int j = 0; j < p_; ++j) value += plane[j] * shape[k + static_cast<std::size_t>(j)];
        if (sign * value > limit) return false;
      }
    }
    return true;
  }

  const MapRegions& regions_;
  int p_;
  std::vector<double> centre_;
  std::vector<double> half_;
  std::vector<ScaledRow> rows_;
};

}  // namespace

std::vector<ExactHalfSpace> domainRows(const MapRegions& regions) {
  DomainGuess guess(regions);
  std::vector<std::int32_t> used;
  for (std::size_t r = 0; r < regions.count(); ++r) {
    const RegionView view = regions.map().region(r);
    used.insert(used.end(), view.rows, view.rows + view.row_count);
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (const std::int32_t number : used)
    guess.addPlane(static_cast<std::size_t>(std::abs(number)) - 1, number > 0 ? 1.0 : -1.0);
  return guess.needed();
}

}  // namespace polyfly
