#include "problem/robust_match.hpp"

#include <algorithm>

#include "problem/optimal_control.hpp"
#include "problem/robust_rows.hpp"

namespace checker {
namespace {

class ModelMatch {
 public:
  ModelMatch(const RobustCertificate& certificate, const RobustProblem& problem, const Fraction& tolerance)
      : models_(certificate.models()),
        problem_(problem),
        tolerance_(tolerance),
        unit_(mpz_class(1), mpz_class(1) << problem.bits) {}

  Fraction run() {
    equal("C", problem_.C);
    equal("range", problem_.ranges);
    equal("state_shift", problem_.state_shift);
    equal("input_shift", problem_.input_shift);
    equal("input_range", {1, 2, {problem_.input_range.first, problem_.input_range.second}});
    matchDynamics();
    matchGain("tie_gain", problem_.tie_gain);
    const bool is_fixed = problem_.feedback == RobustProblem::Feedback::kFixed;
    require((models_.count("feedback_gain") > 0) == is_fixed,
            "model feedback_gain is not that of the problem");
    if (is_fixed) matchGain("feedback_gain", problem_.feedback_gain);
    return greatest_;
  }

 private:
  void equal(const std::string& name, const Matrix& expected) const {
    const Matrix& actual = models_.at(name);
    require(actual.rows == expected.rows && actual.columns == expected.columns &&
                actual.entries == expected.entries,
            "model " + name + " is not that of the problem");
  }

  void near(const std::string& name, const Matrix& actual, const BallMatrix& expected) {
    require(actual.rows == expected.rows() && actual.columns == expected.columns(),
            "model " + name + ": has another size than the problem");
    for (std::size_t i = 0; i < actual.rows; ++i) {
      Fraction size, difference;
      for (std::size_t j = 0; j < actual.columns; ++j) {
        size = std::max(size, Fraction(abs(actual.at(i, j))));
        difference = std::max(difference, expected.at(i, j).distance(actual.at(i, j)));
      }
      require(difference <= unit_ + tolerance_ * size,
              "model " + name + ": row " + std::to_string(i) + " is not that of the problem");
      if (size > 0) greatest_ = std::max(greatest_, Fraction(difference / size));
    }
  }

  /// The effect of the disturbances themselves, from that of their half widths.
  Matrix effect() const {
    Matrix G = models_.at("G");
    require(G.columns == problem_.disturbances.size(), "model G: has another size than the problem");
    for (std::size_t i = 0; i < G.rows; ++i)
      for (std::size_t c = 0; c < G.columns; ++c)
        G.entries[i * G.columns + c] /=
            (problem_.disturbances[c].second - problem_.disturbances[c].first) / 2;
    return G;
  }

  void matchDynamics() {
    const Matrix G = effect();
    Matrix drift{G.rows, 1, Vector(G.rows)};
    for (std::size_t i = 0; i < G.rows; ++i)
      for (std::size_t c = 0; c < G.columns; ++c)
        drift.entries[i] +=
            G.at(i, c) * (problem_.disturbances[c].first + problem_.disturbances[c].second) / 2;
    equal("drift", drift);
    if (problem_.is_discrete) {
      equal("A", problem_.A);
      equal("B", problem_.B);
      require(G.entries == problem_.G.entries, "model G is not that of the problem");
      return;
    }
    TrackingProblem continuous;
    continuous.A = BallMatrix(problem_.A);
    continuous.B = BallMatrix(problem_.B);
    continuous.B_d = BallMatrix(problem_.G);
    continuous.sampling_time = problem_.sampling_time;
    const DiscreteSystem system = discretised(continuous);
    near("A", models_.at("A"), system.A);
    near("B", models_.at("B"), system.B);
    near("G", G, system.B_d);
  }

  void matchGain(const std::string& name, const RobustProblem::Gain& gain) {
    if (gain.value) return equal(name, *gain.value);
    const DiscreteSystem system{BallMatrix(models_.at("A")), BallMatrix(models_.at("B")), {}};
    const BallMatrix R = BallMatrix(*gain.R);
    const BallMatrix P = terminalWeight(system, BallMatrix(*gain.Q), R).P;
    const BallMatrix B_P = system.B.transposed() * P;
    const BallMatrix expected = solved(R + B_P * system.B, B_P * system.A);
    near(name, models_.at(name), BallMatrix(1, expected.columns()) - expected);
  }

  const Matrices& models_;
  const RobustProblem& problem_;
  const Fraction tolerance_, unit_;
  Fraction greatest_;
};

/// The map's box is the range, rounded to doubles.
void matchBox(const RobustCertificate& certificate, const RobustProblem& problem, const Fraction& tolerance) {
  const Matrix& box = certificate.program().at("box");
  for (std::size_t k = 0; k < box.entries.size(); ++k) {
    const Fraction& wanted = problem.ranges.entries[k];
    require(abs(box.entries[k] - wanted) <= tolerance * abs(wanted),
            "the range of parameter " + std::to_string(k / 2) + " is not that of the problem");
  }
}

}  // namespace

RobustMatch matchRobust(const RobustCertificate& certificate, const RobustProblem& problem,
                        const Fraction& tolerance) {
  RobustMatch match;
  match.difference = ModelMatch(certificate, problem, tolerance).run();
  require(certificate.errors() == problem.errors, "errors are not those of the problem");
  require(certificate.stateRanges() == problem.state_ranges, "state_range: not that of the problem");
  require(certificate.program().at("E").rows == (problem.has_peak ? 2u : 1u),
          "the outputs of the map are not those of the problem");
  matchBox(certificate, problem, tolerance);
  const RowMatch rows = matchRows(certificate, problem);
  match.rows = rows.expected;
  match.invariance_rows = rows.invariant;
  match.is_greatest = rows.is_greatest;
  return match;
}

}  // namespace checker
