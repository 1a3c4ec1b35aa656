// Proves a law without the steps that made it: only its regions, the facets and the rows of the program.
#include <algorithm>
#include <map>
#include <utility>

#include "integer_program.hpp"
#include "rational_parts.hpp"
#include "robust_mpc/prove_map.hpp"

namespace polyfly {
namespace {

Rational moveAt(const RobustLaw::Region& region, const RationalVector& theta) {
  return dot(region.input_gain, theta) + region.input_offset;
}
Rational peakAt(const RobustLaw::Region& region, const RationalVector& theta) {
  return dot(region.peak_gain, theta) + region.peak_offset;
}

// Fractions of this size cost most of their time in common divisors. So a point is taken as whole numbers in the
// proportions of (1, coordinates), and a half-space as a row of them: the sign of the product is that of the slack.
std::vector<Integer> homogeneous(const RationalVector& point) {
  RationalVector values{Rational(1)};
  values.insert(values.end(), point.begin(), point.end());
  return wholeNumbers(values);
}

std::vector<std::vector<Integer>> coneRows(const std::vector<ExactHalfSpace>& half_spaces) {
  std::vector<std::vector<Integer>> rows;
  for (const ExactHalfSpace& half_space : half_spaces) rows.push_back(coneRow(half_space));
  return rows;
}

bool isWithin(const std::vector<std::vector<Integer>>& rows, const std::vector<Integer>& point) {
  return std::all_of(rows.begin(), rows.end(), [&](const auto& row) { return dot(row, point) >= 0; });
}

/// A vertex of regions with their law there, (theta, u~_0, tau), once for all regions that share it.
struct LawPoint {
  explicit LawPoint(const RationalVector& values) : y(values) {}
  RationalVector theta() const { return RationalVector(y.begin(), y.end() - 2); }
  const Rational& move() const { return y[y.size() - 2]; }
  const Rational& peak() const { return y.back(); }

  RationalVector y;
  /// It meets all facets.
  bool feasible = true;
  /// No other feasible move with this theta and tau is nearer to K e.
  bool preferred = false;
};

class LawProof {
 public:
  LawProof(const RobustProblem& problem, const RobustProgram& program, const FeasibleSet& set,
           const RobustLaw& law)
      : problem_(problem),
        program_(program),
        set_(set),
        law_(law),
        np_(problem.parameterCount()),
        errors_(problem.errorParameters()),
        preferred_(at(np_)) {
    for (int s = 0; s < problem.stateCount(); ++s) preferred_[at(errors_[at(s)])] = problem.tie_gain(0, s);
  }

  RobustProof run() {
    proof_.invariance_asked = problem_.invariance != InvarianceRule::kNone;
    proof_.facets = set_.facets.size();
    proof_.vertices = set_.vertices.size();
    proof_.set_valid = proveFacets(program_, set_);
    proof_.set_feasible = !set_.vertices.empty() && proveVertices(program_, set_);
    collectPoints();
    proof_.regions = law_.regions.size();
    proof_.preferred = true;
    for (std::size_t r = 0; r < law_.regions.size(); ++r) {
      if (isOptimal(r)) ++proof_.optimal_regions;
      for (const std::size_t k : points_of_[r]) proof_.preferred = proof_.preferred && points_[k].preferred;
    }
    proveCoverage();
    proveSteps();
    return std::move(proof_);
  }

 private:
  const Rational& inputSlope(int facet) const { return set_.facets[at(facet)].half_space.a[at(np_)]; }
  const Rational& peakSlope(int facet) const { return set_.facets[at(facet)].half_space.a[at(np_) + 1]; }

  void collectPoints() {
    std::map<RationalVector, std::size_t> known;
    for (const RobustLaw::Region& region : law_.regions) {
      std::vector<std::size_t>& places = points_of_.emplace_back();
      for (const RationalVector& vertex : region.vertices) {
        RationalVector y = vertex;
        y.push_back(moveAt(region, vertex));
        y.push_back(peakAt(region, vertex));
        const auto [place, is_new] = known.emplace(std::move(y), points_.size());
        if (is_new) points_.emplace_back(place->first);
        places.push_back(place->second);
      }
    }
    std::vector<std::vector<Integer>> facets;
    for (const FeasibleSet::Facet& facet : set_.facets) facets.push_back(coneRow(facet.half_space));
    for (LawPoint& point : points_) judge(point, facets);
  }

  /// The feasible moves for theta and tau are an interval. So one of them is the nearest to K e if it is K e, or if a
  /// facet without slack ends the interval on that side.
  void judge(LawPoint& point, const std::vector<std::vector<Integer>>& facets) const {
    const std::vector<Integer> whole = homogeneous(point.y);
    const int side = sgn(Rational(dot(preferred_, point.theta()) - point.move()));
    bool is_nearest = side == 0;
    for (std::size_t f = 0; f < facets.size(); ++f) {
      const int slack = sgn(dot(facets[f], whole));
      point.feasible = point.feasible && slack >= 0;
      is_nearest = is_nearest || (slack == 0 && sgn(inputSlope(static_cast<int>(f))) == side);
    }
    point.preferred = point.feasible && is_nearest;
  }

  /// (theta, u, tau) is feasible at every vertex, so everywhere in the region; and the active facets,
  /// weighted so that the move cancels, say that tau cannot be less: as affine functions, not at points.
  bool isOptimal(std::size_t index) const {
    const RobustLaw::Region& region = law_.regions[index];
    for (const std::size_t k : points_of_[index]) {
      if (!points_[k].feasible) return false;
    }
    RationalVector weights;
    if (region.active.size() == 2 && inputSlope(region.active[0]) != 0 && inputSlope(region.active[1]) != 0) {
      if (sgn(inputSlope(region.active[0])) == sgn(inputSlope(region.active[1]))) return false;
      weights = {abs(inputSlope(region.active[1])), abs(inputSlope(region.active[0]))};
    } else {  // one that does not limit the move bounds tau by itself
      for (const int facet : region.active)
        weights.emplace_back(inputSlope(facet) == 0 && peakSlope(facet) < 0 ? 1 : 0);
    }
    RationalVector sum(at(np_) + 1);  // theta and bound of the combination; tau's coefficient apart
    Rational peak;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const ExactHalfSpace& row = set_.facets[at(region.active[k])].half_space;
      for (std::size_t j = 0; j < at(np_); ++j) sum[j] += weights[k] * row.a[j];
      sum.back() += weights[k] * row.b;
      peak += weights[k] * peakSlope(region.active[k]);
    }
    if (peak >= 0) return false;
    for (std::size_t j = 0; j < at(np_); ++j) {
      if (sum[j] / -peak != region.peak_gain[j]) return false;
    }
    return sum.back() / peak == region.peak_offset;
  }

  void proveCoverage() {
    std::vector<RationalVector> points;
    for (const FeasibleSet::Vertex& vertex : set_.vertices)
      points.emplace_back(vertex.y.begin(), vertex.y.begin() + np_);
    domain_ = hull(np_, points);
    if (!domain_.equalities.empty()) return;
    domain_rows_ = coneRows(domain_.rows);
    Rational sum;
    for (const RobustLaw::Region& region : law_.regions) {
      const Rational part = volume(region.polytope);
      const std::vector<std::vector<Integer>> rows = coneRows(region.polytope.rows);
      // half-spaces and vertices are the same region: vertices lie within, and their hull has the volume
      for (const RationalVector& vertex : region.vertices) {
        const std::vector<Integer> whole = homogeneous(vertex);
        if (!isWithin(rows, whole) || !isWithin(domain_rows_, whole)) return;
      }
      sum += part;
    }
    proof_.volume = volume(domain_);
    proof_.covered = sum == proof_.volume;
  }

  /// A facet of the domain that only says where the map ends. Where the box ends at a bound of the state,
  /// checkBounds watches that.
  bool isOfExploration(const ExactHalfSpace& row) const {
    int entry = -1;
    for (int j = 0; j < np_; ++j) {
      if (row.a[at(j)] == 0) continue;
      if (entry >= 0) return false;
      entry = j;
    }
    const int state = problem_.parameters[at(entry)].state;
    if (state < 0) return false;
    const RobustProblem::Range& range = problem_.parameters[at(entry)].range;
    const Rational end = row.b / row.a[at(entry)];
    return end == range.lower || end == range.upper;
  }

  RationalVector successor(const RationalVector& theta, const Rational& move,
                           const RationalVector& disturbance) const {
    RationalVector next = theta;
    for (int i = 0; i < problem_.stateCount(); ++i) {
      Rational value = problem_.drift[at(i)] + problem_.B(i, 0) * move;
      for (int s = 0; s < problem_.stateCount(); ++s) value += problem_.A(i, s) * theta[at(errors_[at(s)])];
      for (int c = 0; c < problem_.channelCount(); ++c) value += problem_.G(i, c) * disturbance[at(c)];
      next[at(errors_[at(i)])] = value;
    }
    return next;
  }

  void note(std::optional<RobustWitness>& slot, const RationalVector& theta,
            const RationalVector& disturbance, const std::string& rule, const Rational& excess) const {
    if (excess > 0 && (!slot || excess > slot->excess))
      slot = RobustWitness{theta, disturbance, rule, excess};
  }

  void checkRange(const RobustProblem::Range& range, const Rational& value, const std::string& name,
                  const RationalVector& theta, const RationalVector& disturbance) {
    note(proof_.broken_bound, theta, disturbance, name + " above its range", value - range.upper);
    note(proof_.broken_bound, theta, disturbance, name + " below its range", range.lower - value);
  }

  Rational shifted(const RationalVector& theta, RationalVector RobustProblem::Parameter::*shifts, int entry,
                   const Rational& value) const {
    Rational sum = value;
    for (int j = 0; j < np_; ++j) {
      const RobustProblem::Parameter& parameter = problem_.parameters[at(j)];
      if (parameter.state < 0) sum += (parameter.*shifts)[at(entry)] * theta[at(j)];
    }
    return sum;
  }

  void checkBounds(const RationalVector& theta, const Rational& peak, const RationalVector& disturbance,
                   const RationalVector& next) {
    for (int i = 0; i < problem_.stateCount(); ++i) {
      const auto& range = problem_.state_ranges[at(i)];
      if (!range) continue;
      const Rational x = shifted(theta, &RobustProblem::Parameter::state_shift, i, next[at(errors_[at(i)])]);
      checkRange(*range, x, problem_.states[at(i)].name, theta, disturbance);
    }
    for (int o = 0; o < problem_.outputCount(); ++o) {
      Rational output;
      for (int i = 0; i < problem_.stateCount(); ++i) output += problem_.C(o, i) * next[at(errors_[at(i)])];
      note(proof_.broken_bound, theta, disturbance, "output " + std::to_string(o + 1) + " above tau",
           abs(output) - peak);
    }
  }

  void checkFeasible(const RationalVector& theta, const RationalVector& disturbance,
                     const RationalVector& next) {
    const std::vector<Integer> whole = homogeneous(next);
    for (std::size_t k = 0; k < domain_rows_.size(); ++k) {
      if (dot(domain_rows_[k], whole) >= 0) continue;
      const ExactHalfSpace& row = domain_.rows[k];
      const Rational excess = dot(row.a, next) - row.b;
      if (!isOfExploration(row)) {
        note(proof_.lost, theta, disturbance, "no plan meets all bounds from the successor", excess);
        continue;
      }
      for (int j = 0; j < np_; ++j) {
        const RobustProblem::Range& range = problem_.parameters[at(j)].range;
        const Rational half = (range.upper - range.lower) / 2;
        if (row.a[at(j)] != 0) noteExit(j, nearestDouble(excess / abs(row.a[at(j)]) / half));
      }
    }
  }

  void noteExit(int parameter, double excess) {
    const auto known = std::find_if(proof_.box_exits.begin(), proof_.box_exits.end(),
                                    [&](const auto& exit) { return exit.parameter == parameter; });
    if (known != proof_.box_exits.end()) {
      known->excess = std::max(known->excess, excess);
      return;
    }
    const bool bounded =
        std::any_of(program_.rows.begin(), program_.rows.end(), [&](const RobustProgram::Row& row) {
          return row.y[at(parameter)] != 0 &&
                 (row.kind == RobustProgram::Kind::kState || row.kind == RobustProgram::Kind::kInput ||
                  row.kind == RobustProgram::Kind::kInvariance);
        });
    proof_.box_exits.push_back({parameter, excess, !bounded});
  }

  void proveSteps() {
    for (const LawPoint& point : points_) proveStep(point);
    for (const std::vector<std::size_t>& places : points_of_)
      proof_.steps += places.size() << static_cast<unsigned>(problem_.channelCount());
  }

  void proveStep(const LawPoint& point) {
    const int nw = problem_.channelCount();
    const RationalVector theta = point.theta();
    checkRange(problem_.input_ranges[0],
               shifted(theta, &RobustProblem::Parameter::input_shift, 0, point.move()),
               problem_.inputs[0].name, theta, RationalVector(at(nw)));
    for (unsigned corner = 0; corner < (1U << static_cast<unsigned>(nw)); ++corner) {
      RationalVector disturbance;
      for (int c = 0; c < nw; ++c)
        disturbance.emplace_back((corner >> static_cast<unsigned>(c)) & 1U ? 1 : -1);
      const RationalVector next = successor(theta, point.move(), disturbance);
      checkBounds(theta, point.peak(), disturbance, next);
      checkFeasible(theta, disturbance, next);
    }
  }

  const RobustProblem& problem_;
  const RobustProgram& program_;
  const FeasibleSet& set_;
  const RobustLaw& law_;
  int np_;
  std::vector<int> errors_;
  RationalVector preferred_;
  std::vector<LawPoint> points_;
  /// Places in points_ of the vertices of each region.
  std::vector<std::vector<std::size_t>> points_of_;
  ExactPolytope domain_;
  std::vector<std::vector<Integer>> domain_rows_;
  RobustProof proof_;
};

}  // namespace

RobustProof proveLaw(const RobustProblem& problem, const RobustProgram& program, const FeasibleSet& set,
                     const RobustLaw& law) {
  return LawProof(problem, program, set, law).run();
}

}  // namespace polyfly
