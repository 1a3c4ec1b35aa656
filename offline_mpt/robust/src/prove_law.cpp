// Proves the feasible set, and what holds after one step of the law.
#include <algorithm>
#include <set>
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

/// A vertex of regions with their law there, (theta, u~_0, tau).
struct LawPoint {
  RationalVector theta() const { return RationalVector(y.begin(), y.end() - 2); }
  const Rational& move() const { return y[y.size() - 2]; }
  const Rational& peak() const { return y.back(); }

  const RationalVector& y;
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
        errors_(problem.errorParameters()) {}

  RobustProof run() {
    proof_.invariance_asked = problem_.invariance != InvarianceRule::kNone;
    proof_.facets = set_.facets.size();
    proof_.vertices = set_.vertices.size();
    proof_.set_valid = proveFacets(program_, set_);
    proof_.set_feasible = !set_.vertices.empty() && proveVertices(program_, set_);
    proof_.regions = law_.regions.size();
    findDomain();
    proveSteps();
    return std::move(proof_);
  }

 private:
  /// The feasible parameters: the shadow of the set.
  void findDomain() {
    std::vector<RationalVector> points;
    for (const FeasibleSet::Vertex& vertex : set_.vertices)
      points.emplace_back(vertex.y.begin(), vertex.y.begin() + np_);
    domain_ = hull(np_, points);
    for (const ExactHalfSpace& row : domain_.rows) domain_rows_.push_back(coneRow(row));
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
    // Fractions of this size cost most of their time in common divisors. The sign of the product of whole numbers is that of
    // the slack.
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
    std::set<RationalVector> points;
    for (const RobustLaw::Region& region : law_.regions) {
      proof_.steps += region.vertices.size() << static_cast<unsigned>(problem_.channelCount());
      for (const RationalVector& vertex : region.vertices) {
        RationalVector y = vertex;
        y.push_back(moveAt(region, vertex));
        y.push_back(peakAt(region, vertex));
        points.insert(std::move(y));
      }
    }
    for (const RationalVector& y : points) proveStep({y});
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
