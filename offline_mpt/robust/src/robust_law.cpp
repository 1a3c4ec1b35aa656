#include "robust_mpc/robust_law.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "polytope_sets/double_description.hpp"
#include "rational_parts.hpp"

namespace polyfly {
namespace {

/// A vertex of a face, with the facets that hold it; the last index stands for the plane u~_0 = K e.
struct Corner {
  RationalVector y;
  TightSet facets;
  RationalVector prediction;

  bool operator<(const Corner& other) const { return y < other.y; }
};

/// Where `share` of the way from one point to another is passed; empty where one of them is.
RationalVector between(const RationalVector& from, const RationalVector& to, const Rational& share) {
  if (from.size() != to.size()) return {};
  RationalVector result;
  for (std::size_t k = 0; k < from.size(); ++k) result.push_back(from[k] + share * (to[k] - from[k]));
  return result;
}

/// What u~_0 and tau are on a face.
struct FaceLaw {
  RationalVector input_gain;
  Rational input_offset;
  RationalVector peak_gain;
  Rational peak_offset;
};

class Enumeration {
 public:
  Enumeration(const RobustProblem& problem, const FeasibleSet& set)
      : set_(set),
        np_(problem.parameterCount()),
        plane_(set.facets.size()),
        preferred_(at(np_)),
        corners_on_(set.facets.size()) {
    const std::vector<int> errors = problem.errorParameters();
    for (int s = 0; s < problem.stateCount(); ++s) preferred_[at(errors[at(s)])] = problem.tie_gain(0, s);
    for (const FeasibleSet::Vertex& vertex : set.vertices) {
      Corner corner{vertex.y, {}, vertex.prediction};
      for (const int facet : vertex.facets) {
        corner.facets.set(at(facet));
        corners_on_[at(facet)].push_back(corners_.size());
      }
      corners_.push_back(std::move(corner));
    }
  }

  RobustLaw run() {
    for (std::size_t i = 0; i < set_.facets.size(); ++i) {
      if (inputSlope(i) == 0) {
        if (peakSlope(i) < 0) addFlatFacet(i);
        continue;
      }
      for (std::size_t j = i + 1; j < set_.facets.size(); ++j) addUniqueMove(i, j);
    }
    std::sort(law_.regions.begin(), law_.regions.end(),
              [](const RobustLaw::Region& a, const RobustLaw::Region& b) { return a.active < b.active; });
    return std::move(law_);
  }

 private:
  const Rational& inputSlope(std::size_t facet) const { return set_.facets[facet].half_space.a[at(np_)]; }
  const Rational& peakSlope(std::size_t facet) const { return set_.facets[facet].half_space.a[at(np_) + 1]; }

  /// Two facets whose normals, weighed so that u~_0 cancels, leave a bound on tau from below: the optimum is
  /// where both hold with equality.
  void addUniqueMove(std::size_t i, std::size_t j) {
    if (sgn(inputSlope(i)) * sgn(inputSlope(j)) >= 0) return;
    if (abs(inputSlope(j)) * peakSlope(i) + abs(inputSlope(i)) * peakSlope(j) >= 0) return;
    std::vector<Corner> corners;
    for (const std::size_t c : corners_on_[i]) {
      if (corners_[c].facets.test(j)) corners.push_back(corners_[c]);
    }
    addRegion(RobustLaw::Move::kUnique, {static_cast<int>(i), static_cast<int>(j)}, corners,
              [&] { return lawOfPair(i, j); });
  }

  /// A facet on which u~_0 does not matter for tau: the moves above it are all optimal; K e cuts it in two.
  void addFlatFacet(std::size_t i) {
    std::vector<Corner> above, below, on;
    splitFacet(i, above, below, on);
    addRegion(RobustLaw::Move::kPreferred, {static_cast<int>(i)}, on, [&] { return lawPreferred(i); });
    for (std::size_t j = 0; j < set_.facets.size(); ++j) {
      if (inputSlope(j) == 0) continue;
      std::vector<Corner> corners;
      for (const Corner& corner : inputSlope(j) > 0 ? below : above) {
        if (corner.facets.test(j)) corners.push_back(corner);
      }
      addRegion(RobustLaw::Move::kLimited, {static_cast<int>(i), static_cast<int>(j)}, corners,
                [&] { return lawOfPair(i, j); });
    }
  }

  Rational fromPreferred(const RationalVector& y) const {
    Rational value = y[at(np_)];
    for (std::size_t k = 0; k < at(np_); ++k) value -= preferred_[k] * y[k];
    return value;
  }

  /// Corners of the parts of facet i with u~_0 >= K e, <= K e, = K e: its own, and where its edges cross.
  void splitFacet(std::size_t i, std::vector<Corner>& above, std::vector<Corner>& below,
                  std::vector<Corner>& on) const {
    const std::vector<std::size_t>& mine = corners_on_[i];
    RationalVector side;
    for (const std::size_t c : mine) {
      side.push_back(fromPreferred(corners_[c].y));
      Corner corner = corners_[c];
      if (side.back() == 0) corner.facets.set(plane_);
      if (side.back() >= 0) above.push_back(corner);
      if (side.back() <= 0) below.push_back(corner);
      if (side.back() == 0) on.push_back(corner);
    }
    for (std::size_t k = 0; k < mine.size(); ++k) {
      for (std::size_t l = 0; l < mine.size(); ++l) {
        if (side[k] <= 0 || side[l] >= 0 || !anEdge(mine, k, l)) continue;
        const Corner &from = corners_[mine[k]], &to = corners_[mine[l]];
        const Rational share = side[k] / (side[k] - side[l]);
        Corner crossing{between(from.y, to.y, share), from.facets & to.facets,
                        between(from.prediction, to.prediction, share)};
        crossing.facets.set(plane_);
        above.push_back(crossing);
        below.push_back(crossing);
        on.push_back(std::move(crossing));
      }
    }
  }

  bool anEdge(const std::vector<std::size_t>& mine, std::size_t k, std::size_t l) const {
    const TightSet common = corners_[mine[k]].facets & corners_[mine[l]].facets;
    if (common.count() < at(np_) + 1) return false;
    for (std::size_t m = 0; m < mine.size(); ++m) {
      if (m != k && m != l && corners_[mine[m]].facets.contains(common)) return false;
    }
    return true;
  }

  // tau of facet i, u~_0 = K e.
  FaceLaw lawPreferred(std::size_t i) const {
    const ExactHalfSpace& row = set_.facets[i].half_space;
    FaceLaw law{preferred_, 0, RationalVector(at(np_)), row.b / peakSlope(i)};
    for (std::size_t k = 0; k < at(np_); ++k) law.peak_gain[k] = -row.a[k] / peakSlope(i);
    return law;
  }

  // Where both facets hold with equality (Cramer).
  FaceLaw lawOfPair(std::size_t i, std::size_t j) const {
    const ExactHalfSpace &first = set_.facets[i].half_space, &second = set_.facets[j].half_space;
    const Rational determinant = inputSlope(i) * peakSlope(j) - inputSlope(j) * peakSlope(i);
    FaceLaw law{RationalVector(at(np_)), (first.b * peakSlope(j) - second.b * peakSlope(i)) / determinant,
                RationalVector(at(np_)), (inputSlope(i) * second.b - inputSlope(j) * first.b) / determinant};
    for (std::size_t k = 0; k < at(np_); ++k) {
      law.input_gain[k] = -(first.a[k] * peakSlope(j) - second.a[k] * peakSlope(i)) / determinant;
      law.peak_gain[k] = -(inputSlope(i) * second.a[k] - inputSlope(j) * first.a[k]) / determinant;
    }
    return law;
  }

  RationalVector parametersOf(const Corner& corner) const {
    return RationalVector(corner.y.begin(), corner.y.begin() + np_);
  }

  /// Whether no direction is left that is orthogonal to all (1, theta).
  bool hasFullDimension(const std::vector<Corner>& corners) const {
    DoubleDescription left(np_ + 1);
    return std::any_of(corners.begin(), corners.end(), [&](const Corner& corner) {
      left.add(homogeneous(parametersOf(corner)), true);
      return left.lines().empty();
    });
  }

  template <typename LawOf>
  void addRegion(RobustLaw::Move move, std::vector<int> active, const std::vector<Corner>& corners,
                 const LawOf& law_of) {
    if (!hasFullDimension(corners)) return;
    FaceLaw law = law_of();
    RobustLaw::Region region;
    region.move = move;
    region.active = std::move(active);
    addHalfSpaces(region, law, corners);
    std::vector<Corner> sorted = corners;
    std::sort(sorted.begin(), sorted.end());
    for (Corner& corner : sorted) {
      region.vertices.push_back(parametersOf(corner));
      region.predictions.push_back(std::move(corner.prediction));
    }
    region.input_gain = std::move(law.input_gain);
    region.input_offset = std::move(law.input_offset);
    region.peak_gain = std::move(law.peak_gain);
    region.peak_offset = std::move(law.peak_offset);
    law_.regions.push_back(std::move(region));
  }

  /// A region's facets are its greatest intersections with other facets (or the plane).
  void addHalfSpaces(RobustLaw::Region& region, const FaceLaw& law,
                     const std::vector<Corner>& corners) const {
    std::vector<std::pair<std::size_t, TightSet>> faces;  // facet, corners on it
    for (std::size_t f = 0; f <= plane_; ++f) {
      TightSet on;
      for (std::size_t c = 0; c < corners.size(); ++c) {
        if (corners[c].facets.test(f)) on.set(c);
      }
      const std::size_t count = on.count();
      if (count >= at(np_) && count < corners.size()) faces.emplace_back(f, std::move(on));
    }
    region.polytope.dimension = np_;
    for (std::size_t k = 0; k < faces.size(); ++k) {
      bool greatest = true;
      for (std::size_t l = 0; l < faces.size() && greatest; ++l) {
        if (l == k || !faces[l].second.contains(faces[k].second)) continue;
        greatest = faces[k].second.contains(faces[l].second) && k < l;
      }
      if (greatest) region.polytope.rows.push_back(halfSpace(faces[k].first, law, corners));
    }
  }

  ExactHalfSpace halfSpace(std::size_t facet, const FaceLaw& law, const std::vector<Corner>& corners) const {
    RationalVector row(at(np_) + 1);
    if (facet == plane_) {
      // on the side of the plane where the corners are
      const bool above = std::any_of(corners.begin(), corners.end(),
                                     [&](const Corner& corner) { return fromPreferred(corner.y) > 0; });
      const int sign = above ? -1 : 1;
      for (std::size_t k = 0; k < at(np_); ++k) row[k] = sign * (law.input_gain[k] - preferred_[k]);
      row.back() = -sign * law.input_offset;
    } else {
      const ExactHalfSpace& from = set_.facets[facet].half_space;
      for (std::size_t k = 0; k < at(np_); ++k)
        row[k] = from.a[k] + inputSlope(facet) * law.input_gain[k] + peakSlope(facet) * law.peak_gain[k];
      row.back() = from.b - inputSlope(facet) * law.input_offset - peakSlope(facet) * law.peak_offset;
    }
    const std::vector<Integer> whole = wholeNumbers(row);
    return {RationalVector(whole.begin(), whole.end() - 1), Rational(whole.back())};
  }

  const FeasibleSet& set_;
  int np_;
  std::size_t plane_;
  RationalVector preferred_;  // K e as a function of theta
  std::vector<Corner> corners_;
  std::vector<std::vector<std::size_t>> corners_on_;
  RobustLaw law_;
};

}  // namespace

RobustLaw explicitLaw(const RobustProblem& problem, const FeasibleSet& set) {
  return Enumeration(problem, set).run();
}

}  // namespace polyfly
