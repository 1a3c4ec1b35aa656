// Statement 2 of robust maps: what holds after one step, for each vertex of the disturbances.
#include <algorithm>

#include "robust/robust_certificate.hpp"

namespace checker {

/// The boundaries that the facets of regions name bound the feasible parameters: see CERTIFICATE.md.
void RobustCertificate::checkLookups(const std::vector<ProvenRegion>& regions) const {
  ExtendedCertificate::checkLookups(regions);
  std::set<Row> planes;
  for (std::size_t index = 0; index < regions.size(); ++index) {
    const std::vector<Row>& listed = checkedRegion(index).listed;
    for (std::size_t k = 0; k < listed.size(); ++k) {
      if (regions[index].facets[k].is_boundary) planes.insert(listed[k]);
    }
  }
  const std::vector<Row> boundary(planes.begin(), planes.end());
  for (const Point& point : points_) checkStep(point, boundary);
}

void RobustCertificate::checkStep(const Point& point, const std::vector<Row>& boundary) const {
  const std::size_t p = map().p;
  const Fraction input = shifted(point, model("input_shift").entries, point.y[p]);
  require(input >= model("input_range").at(0, 0) && input <= model("input_range").at(0, 1),
          "the input is out of its range");
  for (std::size_t corner = 0; corner < std::size_t{1} << model("G").columns; ++corner) {
    const Vector next = successor(point, corner);
    checkBounds(point, next);
    noteFeasibility(next, boundary);
    ++steps_;
  }
}

/// Sum of shift times reference, and the value.
Fraction RobustCertificate::shifted(const Point& point, const Vector& shift, const Fraction& value) const {
  Fraction sum = value;
  for (std::size_t j = 0; j < map().p; ++j) sum += shift[j] * point.y[j];
  return sum;
}

/// theta after one step; bit c of `corner` is the sign of disturbance c.
Vector RobustCertificate::successor(const Point& point, std::size_t corner) const {
  const std::size_t nx = errors_.size();
  Vector next(point.y.begin(), point.y.begin() + map().p);
  for (std::size_t i = 0; i < nx; ++i) {
    Fraction value = model("drift").at(i, 0) + model("B").at(i, 0) * point.y[map().p];
    for (std::size_t s = 0; s < nx; ++s) value += model("A").at(i, s) * point.y[errors_[s]];
    for (std::size_t c = 0; c < model("G").columns; ++c)
      value += (corner >> c & 1u) != 0 ? model("G").at(i, c) : Fraction(-model("G").at(i, c));
    next[errors_[i]] = value;
  }
  return next;
}

void RobustCertificate::checkBounds(const Point& point, const Vector& next) const {
  const std::size_t nx = errors_.size();
  for (const auto& [state, range] : state_ranges_) {
    Vector shift;
    for (std::size_t j = 0; j < map().p; ++j) shift.push_back(model("state_shift").at(j, state));
    const Fraction x = shifted(point, shift, next[errors_[state]]);
    require(x >= range.first && x <= range.second, "after one step a state is out of its range");
  }
  for (std::size_t i = 0; i < model("C").rows; ++i) {
    Fraction output;
    for (std::size_t s = 0; s < nx; ++s) output += model("C").at(i, s) * next[errors_[s]];
    require(abs(output) <= point.y[map().p + 1], "after one step an output is greater than tau");
  }
}

void RobustCertificate::noteFeasibility(const Vector& next, const std::vector<Row>& boundary) const {
  bool is_lost = false, leaves_range = false;
  const Vector t = inBox(next);
  for (const Row& row : boundary) {
    if (valueAt(row, t) >= 0) continue;
    const std::size_t parameter = endedRange(row);
    if (parameter == map().p) is_lost = true;
    // References stay as they are, in their range.
    if (std::find(errors_.begin(), errors_.end(), parameter) != errors_.end()) leaves_range = true;
  }
  lost_ += is_lost ? 1 : 0;
  left_range_ += leaves_range ? 1 : 0;
}

/// The parameter of which a boundary only says where the range ends; p if there is none.
std::size_t RobustCertificate::endedRange(const Row& row) const {
  const std::size_t p = map().p;
  const auto is_used = [](const Integer& value) { return value != 0; };
  const auto first = std::find_if(row.begin(), row.end() - 1, is_used);
  if (first == row.end() - 1 || std::any_of(first + 1, row.end() - 1, is_used)) return p;
  const auto j = static_cast<std::size_t>(first - row.begin());
  const Fraction end = scaling_.centre[j] - scaling_.half[j] * Fraction(row.back()) / *first;
  const bool ends = end == model("range").at(j, 0) || end == model("range").at(j, 1) ||
                    end == Fraction(map().bounds[2 * j]) || end == Fraction(map().bounds[2 * j + 1]);
  return ends ? j : p;
}

}  // namespace checker
