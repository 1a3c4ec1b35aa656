// The set that `invariance` names is robustly invariant within the bounds, and the greatest such set.
#include "problem/invariance.hpp"

#include <algorithm>

namespace checker {
namespace {

// Of the recursion that shows the set to be the greatest one, and of the half-spaces that one step leaves.
constexpr int kMostSetSteps = 40;
constexpr std::size_t kMostSetRows = 400;

/// x = (theta, u~): the errors move, the references stay.
class Invariance {
 public:
  Invariance(const RobustCertificate& certificate, const RobustProblem& problem)
      : models_(certificate.models()), problem_(problem), p_(problem.ranges.rows) {}

  void confirm(const std::vector<ExactHalfSpace>& set) const {
    const Polyhedron polyhedron(set);
    for (const ExactHalfSpace& bound : stateBounds())
      require(polyhedron.isWithin(bound), "a bound of a state does not hold in all of the invariant set");
    for (const ExactHalfSpace& row : led(set))
      require(polyhedron.isWithin(row), "the set that the problem calls invariant is not");
  }

  /// A half-space that holds in each invariant set gives further ones: some input must lead into it.
  bool isGreatest(const std::vector<ExactHalfSpace>& set) const {
    std::vector<ExactHalfSpace> known = stateBounds();
    for (std::size_t j = 0; j < p_; ++j) {
      const bool is_error = std::count(problem_.errors.begin(), problem_.errors.end(), j) > 0;
      for (const int sign : {1, -1})
        if (!is_error) known.push_back(side(j, sign, {problem_.ranges.at(j, 0), problem_.ranges.at(j, 1)}));
    }
    for (int step = 0; step < kMostSetSteps; ++step) {
      const Polyhedron polyhedron(known);
      const auto is_known = [&](const ExactHalfSpace& row) { return polyhedron.isWithin(row); };
      if (std::all_of(set.begin(), set.end(), is_known)) return true;
      for (ExactHalfSpace& row : led(polyhedron.rows()))
        if (!is_known(row)) known.push_back(std::move(row));
      if (known.size() > kMostSetRows) return false;
      known = withoutImplied(std::move(known));
    }
    return false;
  }

 private:
  ExactHalfSpace side(std::size_t entry, int sign, const RobustProblem::Range& range) const {
    ExactHalfSpace result{Vector(p_), sign > 0 ? range.second : Fraction(-range.first)};
    result.a[entry] = sign;
    return result;
  }

  /// Ranges of x, which is the error and what the references add.
  std::vector<ExactHalfSpace> stateBounds() const {
    std::vector<ExactHalfSpace> result;
    for (const auto& [state, range] : problem_.state_ranges) {
      for (const int sign : {1, -1}) {
        result.push_back(side(problem_.errors[state], sign, range));
        for (std::size_t j = 0; j < p_; ++j) result.back().a[j] += sign * problem_.state_shift.at(j, state);
      }
    }
    return result;
  }

  /// What theta must meet so that some input in its range leads into the set, whatever the disturbance.
  std::vector<ExactHalfSpace> led(const std::vector<ExactHalfSpace>& set) const {
    std::vector<ExactHalfSpace> rows;
    for (const ExactHalfSpace& row : set) rows.push_back(oneStepBefore(row));
    for (const int sign : {1, -1}) {
      ExactHalfSpace input{Vector(p_ + 1),
                           sign > 0 ? problem_.input_range.second : Fraction(-problem_.input_range.first)};
      for (std::size_t j = 0; j < p_; ++j) input.a[j] = sign * problem_.input_shift.at(j, 0);
      input.a[p_] = sign;
      rows.push_back(std::move(input));
    }
    std::vector<ExactHalfSpace> result = withoutEntry(rows, p_);
    for (ExactHalfSpace& row : result) row.a.pop_back();
    return result;
  }

  ExactHalfSpace oneStepBefore(const ExactHalfSpace& row) const {
    Vector on_errors;
    for (const std::size_t error : problem_.errors) on_errors.push_back(row.a[error]);
    ExactHalfSpace result = row;
    const Vector before = timesMatrix(on_errors, models_.at("A"));
    for (std::size_t i = 0; i < before.size(); ++i) result.a[problem_.errors[i]] = before[i];
    result.a.push_back(timesMatrix(on_errors, models_.at("B"))[0]);
    result.bound -= timesMatrix(on_errors, models_.at("drift"))[0];
    for (const Fraction& effect : timesMatrix(on_errors, models_.at("G"))) result.bound -= abs(effect);
    return result;
  }

  const Matrices& models_;
  const RobustProblem& problem_;
  const std::size_t p_;
};

}  // namespace

void confirmInvariant(const std::vector<ExactHalfSpace>& set, const RobustCertificate& certificate,
                      const RobustProblem& problem) {
  Invariance(certificate, problem).confirm(set);
}

bool isGreatestInvariant(const std::vector<ExactHalfSpace>& set, const RobustCertificate& certificate,
                         const RobustProblem& problem) {
  return Invariance(certificate, problem).isGreatest(set);
}

}  // namespace checker
