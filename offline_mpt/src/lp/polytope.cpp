#include "lp/polytope.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "lp/polytope_kernel.hpp"
#include "lp/rational_polytope.hpp"
#include "lp/tolerances.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {

PolytopeSolver::PolytopeSolver(int dimension) : dimension_(dimension) {
  if (dimension < 1 || dimension > kMaxDimension) {
    throw Error("polytope: dimension must be 1 to " + std::to_string(kMaxDimension) + ", got " +
                std::to_string(dimension));
  }
  plain_ = makeKernel(dimension);
  lifted_ = makeKernel(dimension + 1);
}

PolytopeSolver::~PolytopeSolver() = default;
PolytopeSolver::PolytopeSolver(PolytopeSolver&&) noexcept = default;
PolytopeSolver& PolytopeSolver::operator=(PolytopeSolver&&) noexcept = default;

// The ball of radius r around t lies inside when a_i . t + r <= b_i: one more variable, and any t is a start.
bool PolytopeSolver::chebyshev(const double* rows, int count, double* centre, double& radius, bool exactly) {
  const int n = dimension_;
  lifted_rows_.resize(static_cast<std::size_t>(count) * (n + 2));
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < count; ++i) {
    const double* row = rows + static_cast<std::ptrdiff_t>(i) * (n + 1);
    double* lifted = lifted_rows_.data() + static_cast<std::ptrdiff_t>(i) * (n + 2);
    double slack = row[n];
    for (int j = 0; j < n; ++j) {
      lifted[j] = row[j];
      slack -= row[j] * centre[j];
    }
    lifted[n] = 1.0;
    lifted[n + 1] = row[n];
    least = std::min(least, slack);
  }
  double start[kMaxDimension + 1];
  double direction[kMaxDimension + 1] = {};
  double best[kMaxDimension + 1];
  std::copy(centre, centre + n, start);
  start[n] = least - 0.5;
  direction[n] = 1.0;
  if ((exactly || !lifted_->maximise(lifted_rows_.data(), count, start, direction, best)) &&
      !maximiseRationally(n + 1, lifted_rows_.data(), count, start, direction, best)) {
    return false;
  }
  std::copy(best, best + n, centre);
  radius = exactly ? best[n] : radiusAbout(rows, count, centre);
  return true;
}

// Distance from the point to the nearest plane, negative beyond it.
double PolytopeSolver::radiusAbout(const double* rows, int count, const double* centre) const {
  const int n = dimension_;
  double radius = std::numeric_limits<double>::infinity();
  for (int i = 0; i < count; ++i) {
    const double* row = rows + static_cast<std::ptrdiff_t>(i) * (n + 1);
    double slack = row[n];
    for (int j = 0; j < n; ++j) slack -= row[j] * centre[j];
    radius = std::min(radius, slack);
  }
  return radius;
}

bool PolytopeSolver::chebyshevInBox(const double* rows, int count, double* centre, double& radius) {
  double ball[kMaxDimension + 1];
  switch (lifted_->ballInBox(rows, count, ball)) {
    case Kernel::Ball::kHopeless:
      radius = ball[dimension_];
      return true;
    case Kernel::Ball::kFound:
      radius = radiusAbout(rows, count, ball);
      if (std::abs(radius - ball[dimension_]) > tolerance::kSameRadius) break;
      std::copy_n(ball, dimension_, centre);
      return true;
    case Kernel::Ball::kFailed:
      break;
  }
  return chebyshev(rows, count, centre, radius);
}

bool PolytopeSolver::minimal(const double* rows, int count, const double* interior, double tolerance,
                             MinimalRows& result) {
  if (!plain_->minimal(rows, count, interior, tolerance, result) &&
      !minimalOneByOne(0, rows, count, interior, tolerance, result))
    return false;
  return !result.leaves_reach || restoreRows(rows, count, interior, tolerance, result);
}

// The point furthest beyond the row that begins at `place`, at most kMostBeyond, where all other rows hold.
bool PolytopeSolver::furthestBeyond(std::vector<double>& rows, std::size_t place, const double* interior,
                                    double* point, double& violation) {
  double* const row = rows.data() + place;
  const double bound = row[dimension_];
  row[dimension_] += tolerance::kMostBeyond;
  const bool is_found =
      furthest(rows.data(), static_cast<int>(rows.size()) / (dimension_ + 1), interior, row, point);
  row[dimension_] = bound;
  if (is_found) violation = -radiusAbout(row, 1, point);
  return is_found;
}

// What was left out first may rest on a row that was left out later, and reach further than that by the angle of others.
bool PolytopeSolver::restoreRows(const double* rows, int count, const double* interior, double tolerance,
                                 MinimalRows& result) {
  const int n = dimension_;
  const auto row_of = [&](int i) { return rows + static_cast<std::ptrdiff_t>(i) * (n + 1); };
  std::vector<int> restored;
  std::vector<double> needed;
  for (const int facet : result.facets) needed.insert(needed.end(), row_of(facet), row_of(facet) + n + 1);
  for (int i = 0; i < count; ++i) {
    if (std::find(result.facets.begin(), result.facets.end(), i) != result.facets.end()) continue;
    const double* const row = row_of(i);
    const std::size_t end = needed.size();
    needed.insert(needed.end(), row, row + n + 1);
    double beyond[kMaxDimension], violation = 0.0;
    if (!furthestBeyond(needed, end, interior, beyond, violation)) return false;
    if (violation <= tolerance) {
      needed.resize(end);
      continue;
    }
    const auto place = std::lower_bound(result.facets.begin(), result.facets.end(), i);
    const auto index = place - result.facets.begin();
    result.facets.insert(place, i);
    result.beyond.insert(result.beyond.begin() + index * n, beyond, beyond + n);
    restored.push_back(i);
  }
  return renewPoints(rows, restored, interior, tolerance, result);
}

// Points that were found without a row that is restored may violate it. Facets that have no other point are not needed.
bool PolytopeSolver::renewPoints(const double* rows, const std::vector<int>& restored, const double* interior,
                                 double tolerance, MinimalRows& result) {
  const int n = dimension_;
  const auto row_of = [&](int i) { return rows + static_cast<std::ptrdiff_t>(i) * (n + 1); };
  for (std::size_t k = 0; k < result.facets.size();) {
    const int facet = result.facets[k];
    double* const point = result.beyond.data() + k * static_cast<std::size_t>(n);
    const bool is_right = std::all_of(restored.begin(), restored.end(), [&](int i) {
      return i == facet || -radiusAbout(row_of(i), 1, point) <= tolerance;
    });
    if (!is_right) {
      std::vector<double> facets;
      for (const int one : result.facets) facets.insert(facets.end(), row_of(one), row_of(one) + n + 1);
      double violation = 0.0;
      if (!furthestBeyond(facets, k * (static_cast<std::size_t>(n) + 1), interior, point, violation))
        return false;
      if (violation <= tolerance) {
        const auto first = result.beyond.begin() + static_cast<std::ptrdiff_t>(k) * n;
        result.beyond.erase(first, first + n);
        result.facets.erase(result.facets.begin() + static_cast<std::ptrdiff_t>(k));
        continue;
      }
    }
    ++k;
  }
  return true;
}

bool PolytopeSolver::minimalBeside(int kept, const double* rows, int count, const double* interior,
                                   double tolerance, MinimalRows& result, const LooseRows& loose) {
  if (plain_->minimalBeside(kept, rows, count, interior, tolerance, result, loose)) return true;
  result.excess = std::numeric_limits<double>::infinity();
  return minimalOneByOne(kept, rows, count, interior, tolerance, result);
}

// Each row starts anew, so that most of them need no rational numbers.
bool PolytopeSolver::minimalOneByOne(int kept, const double* rows, int count, const double* interior,
                                     double tolerance, MinimalRows& result) {
  const auto maximise = [this](const double* left, int left_count, const double* start,
                               const double* direction,
                               double* point) { return furthest(left, left_count, start, direction, point); };
  return polyfly::minimalOneByOne(kept, dimension_, rows, count, interior, tolerance, maximise, result);
}

bool PolytopeSolver::support(const double* rows, int count, const double* interior, const double* direction,
                             double* point) {
  return plain_->maximise(rows, count, interior, direction, point) ||
         maximiseRationally(dimension_, rows, count, interior, direction, point);
}

bool PolytopeSolver::furthest(const double* rows, int count, const double* interior, const double* direction,
                              double* point) {
  return furthestInDoubles(rows, count, interior, direction, point) ||
         maximiseRationally(dimension_, rows, count, interior, direction, point);
}

bool PolytopeSolver::furthestInDoubles(const double* rows, int count, const double* interior,
                                       const double* direction, double* point) {
  return plain_->climb(rows, count, interior, direction, point);
}

unsigned long long PolytopeSolver::pivots() const { return plain_->pivots() + lifted_->pivots(); }

}  // namespace polyfly
