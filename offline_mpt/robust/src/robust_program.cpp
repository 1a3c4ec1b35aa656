#include "robust_mpc/robust_program.hpp"

#include <algorithm>
#include <utility>

#include "polyfly_base/error.hpp"
#include "rational_parts.hpp"

namespace polyfly {
namespace {

/// Coefficients of y, z and 1, in this order, of each entry.
using Affine = RationalMatrix;

/// The worst case of a signal: its nominal part and its reaction to each disturbance so far.
struct Signals {
  Affine nominal;
  // By step and channel of the disturbance.
  std::vector<Affine> disturbance;
};

/// Predicts e_k and u~_k of Eq. 17 and 18 as affine functions of y and z.
class Prediction {
 public:
  explicit Prediction(const RobustProblem& problem)
      : problem_(problem),
        last_input_(problem.stack == Stack::kPaper ? problem.horizon - 2 : problem.horizon - 1),
        law_size_(problem.parameterCount() + 2),
        prediction_count_(last_input_) {
    if (problem.feedback == FeedbackPrediction::kFree)
      prediction_count_ += problem.channelCount() * last_input_ * (last_input_ + 1) / 2;
    roll();
  }

  int lastInput() const { return last_input_; }
  int predictionCount() const { return prediction_count_; }
  const Signals& state(int k) const { return states_[at(k)]; }
  const Signals& input(int k) const { return inputs_[at(k)]; }
  int width() const { return law_size_ + prediction_count_ + 1; }

 private:
  Affine zero(int entries) const { return Affine::Zero(entries, width()); }

  /// Entry L_{ki} of channel c; fixed: K (A + B K)^(k-1-i) G.
  Affine feedback(int k, int i, int channel) const {
    Affine result = zero(1);
    switch (problem_.feedback) {
      case FeedbackPrediction::kZero:
        break;
      case FeedbackPrediction::kFree:
        result(law_size_ + last_input_ + (k * (k - 1) / 2 + i) * problem_.channelCount() + channel) = 1;
        break;
      case FeedbackPrediction::kFixed:
        result(width() - 1) = fixed_[at(k - 1 - i)](0, channel);
        break;
    }
    return result;
  }

  // K (A + B K)^j G for j = 0 ..
  void prepareFixed() {
    RationalMatrix reaction = problem_.G;
    for (int j = 0; j < problem_.horizon; ++j) {
      fixed_.push_back(problem_.feedback_gain * reaction);
      reaction = RationalMatrix(problem_.A * reaction + problem_.B * fixed_.back());
    }
  }

  Signals initialState() const {
    Signals first{zero(problem_.stateCount()), {}};
    const std::vector<int> errors = problem_.errorParameters();
    for (int i = 0; i < problem_.stateCount(); ++i) first.nominal(i, errors[at(i)]) = 1;
    return first;
  }

  Signals inputAt(int k) const {
    Signals input{zero(1), {}};
    input.nominal(k == 0 ? problem_.parameterCount() : law_size_ + k - 1) = 1;
    for (int i = 0; i < k; ++i) {
      for (int c = 0; c < problem_.channelCount(); ++c) input.disturbance.push_back(feedback(k, i, c));
    }
    return input;
  }

  void roll() {
    if (problem_.feedback == FeedbackPrediction::kFixed) prepareFixed();
    states_.push_back(initialState());
    for (int k = 0; k <= last_input_; ++k) {
      inputs_.push_back(inputAt(k));
      const Signals &x = states_.back(), &u = inputs_.back();
      Signals next;
      next.nominal = problem_.A * x.nominal + problem_.B * u.nominal;
      for (int r = 0; r < problem_.stateCount(); ++r) next.nominal(r, width() - 1) += problem_.drift[at(r)];
      for (std::size_t d = 0; d < x.disturbance.size(); ++d)
        next.disturbance.emplace_back(problem_.A * x.disturbance[d] + problem_.B * u.disturbance[d]);
      for (int c = 0; c < problem_.channelCount(); ++c) {
        next.disturbance.push_back(zero(problem_.stateCount()));
        next.disturbance.back().col(width() - 1) = problem_.G.col(c);
      }
      states_.push_back(std::move(next));
    }
  }

  const RobustProblem& problem_;
  int last_input_;
  int law_size_;
  int prediction_count_;
  std::vector<RationalMatrix> fixed_;
  std::vector<Signals> states_;
  std::vector<Signals> inputs_;
};

class Builder {
 public:
  explicit Builder(const RobustProblem& problem) : problem_(problem), prediction_(problem) {
    program_.parameter_count = problem.parameterCount();
    program_.prediction_count = prediction_.predictionCount();
  }

  RobustProgram build() {
    addBox();
    addFloor();
    const int first = problem_.stack == Stack::kPaper ? 0 : 1;
    const int last = problem_.stack == Stack::kPaper ? problem_.horizon - 1 : problem_.horizon;
    for (int k = first; k <= last; ++k) {
      addPeaks(prediction_.state(k));
      addStateBounds(prediction_.state(k));
    }
    for (int k = 0; k <= prediction_.lastInput(); ++k) addInputBounds(prediction_.input(k));
    if (problem_.invariance == InvarianceRule::kFirstStep) addInvariance(prediction_.state(1));
    if (problem_.invariance == InvarianceRule::kTerminal) addInvariance(prediction_.state(last));
    return std::move(program_);
  }

 private:
  using Kind = RobustProgram::Kind;

  RationalVector along(const RationalVector& direction, const Affine& entries) const {
    return direction.empty() ? RationalVector(at(prediction_.width())) : applyTransposed(entries, direction);
  }

  /// direction . entries + extra . y <= bound for all disturbances.
  void add(Kind kind, const RationalVector& direction, const Signals& signals, const RationalVector& extra,
           const Rational& bound) {
    const std::ptrdiff_t split = program_.lawSize();
    const RationalVector sum = along(direction, signals.nominal);
    RobustProgram::Row row;
    row.kind = kind;
    row.bound = bound - sum.back();
    row.y.assign(sum.begin(), sum.begin() + split);
    row.z.assign(sum.begin() + split, sum.end() - 1);
    for (std::size_t j = 0; j < extra.size(); ++j) row.y[j] += extra[j];
    for (const Affine& reaction : signals.disturbance) {
      const RationalVector term = along(direction, reaction);
      RationalVector z(term.begin() + split, term.end() - 1);
      if (std::all_of(z.begin(), z.end(), [](const Rational& value) { return value == 0; })) {
        row.bound -= abs(term.back());
      } else {
        row.terms.push_back({term.back(), std::move(z)});
      }
    }
    program_.rows.push_back(std::move(row));
  }

  void addBox() {
    for (int j = 0; j < problem_.parameterCount(); ++j) {
      const RobustProblem::Range& range = problem_.parameters[at(j)].range;
      for (const int sign : {1, -1}) {
        RationalVector y(at(program_.lawSize()));
        y[at(j)] = sign;
        add(Kind::kBox, {}, {}, y, sign > 0 ? range.upper : Rational(-range.lower));
      }
    }
  }

  void addFloor() {
    RationalVector y(at(program_.lawSize()));
    y[at(program_.peakEntry())] = -1;
    add(Kind::kFloor, {}, {}, y, -problem_.floor);
  }

  void addPeaks(const Signals& state) {
    for (int i = 0; i < problem_.outputCount(); ++i) {
      for (const int sign : {1, -1}) {
        RationalVector direction, y(at(program_.lawSize()));
        for (int s = 0; s < problem_.stateCount(); ++s) direction.emplace_back(sign * problem_.C(i, s));
        y[at(program_.peakEntry())] = -1;
        add(Kind::kPeak, direction, state, y, Rational(0));
      }
    }
  }

  // What the references add to entry `i` of x or u, as coefficients of y.
  RationalVector shift(RationalVector RobustProblem::Parameter::*shifts, int i, int sign) const {
    RationalVector y(at(program_.lawSize()));
    for (int j = 0; j < problem_.parameterCount(); ++j) {
      const RobustProblem::Parameter& parameter = problem_.parameters[at(j)];
      if (parameter.state < 0) y[at(j)] = sign * (parameter.*shifts)[at(i)];
    }
    return y;
  }

  void addRange(Kind kind, const Signals& signals, int entry, const RobustProblem::Range& range,
                RationalVector RobustProblem::Parameter::*shifts) {
    for (const int sign : {1, -1}) {
      RationalVector direction(at(signals.nominal.rows()));
      direction[at(entry)] = sign;
      add(kind, direction, signals, shift(shifts, entry, sign),
          sign > 0 ? range.upper : Rational(-range.lower));
    }
  }

  void addStateBounds(const Signals& state) {
    for (int i = 0; i < problem_.stateCount(); ++i) {
      if (problem_.state_ranges[at(i)])
        addRange(Kind::kState, state, i, *problem_.state_ranges[at(i)],
                 &RobustProblem::Parameter::state_shift);
    }
  }

  void addInputBounds(const Signals& input) {
    for (int i = 0; i < problem_.inputCount(); ++i)
      addRange(Kind::kInput, input, i, problem_.input_ranges[at(i)], &RobustProblem::Parameter::input_shift);
  }

  void addInvariance(const Signals& state) {
    const std::vector<int> errors = problem_.errorParameters();
    for (const ExactHalfSpace& half_space : invariantParameters(problem_).rows) {
      RationalVector direction, y(at(program_.lawSize()));
      for (const int error : errors) direction.push_back(half_space.a[at(error)]);
      for (int j = 0; j < problem_.parameterCount(); ++j) {
        if (problem_.parameters[at(j)].state < 0) y[at(j)] = half_space.a[at(j)];
      }
      add(Kind::kInvariance, direction, state, y, half_space.b);
    }
  }

  const RobustProblem& problem_;
  Prediction prediction_;
  RobustProgram program_;
};

}  // namespace

bool RobustProgram::Row::hasPredictions() const {
  return !terms.empty() || std::any_of(z.begin(), z.end(), [](const Rational& value) { return value != 0; });
}

RobustProgram buildRobustProgram(const RobustProblem& problem) {
  if (problem.inputCount() != 1) throw Error(problem.source + ": model.inputs: must have exactly one entry");
  return Builder(problem).build();
}

Rational rowExcess(const RobustProgram::Row& row, const RationalVector& y, const RationalVector& z) {
  Rational sum = dot(row.y, y) + dot(row.z, z) - row.bound;
  for (const RobustProgram::Term& term : row.terms) sum += abs(term.constant + dot(term.z, z));
  return sum;
}

}  // namespace polyfly
