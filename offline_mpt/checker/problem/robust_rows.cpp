#include "problem/robust_rows.hpp"

#include <algorithm>
#include <map>

#include "core/text.hpp"
#include "problem/invariance.hpp"

namespace checker {
namespace {

using PlanRow = RobustCertificate::PlanRow;
using Sparse = RobustCertificate::Sparse;

Matrix multiplied(const Matrix& a, const Matrix& b) {
  Matrix result{a.rows, b.columns, {}};
  for (std::size_t i = 0; i < a.rows; ++i) {
    const Vector row(a.entries.begin() + static_cast<std::ptrdiff_t>(i * a.columns),
                     a.entries.begin() + static_cast<std::ptrdiff_t>((i + 1) * a.columns));
    const Vector image = timesMatrix(row, b);
    result.entries.insert(result.entries.end(), image.begin(), image.end());
  }
  return result;
}

/// Sorted, without zeros; equal places are added.
Sparse tidy(const Sparse& entries) {
  std::map<std::size_t, Fraction> sums;
  for (const auto& [place, value] : entries) sums[place] += value;
  Sparse result;
  for (const auto& [place, value] : sums)
    if (value != 0) result.emplace_back(place, value);
  return result;
}

std::string textOf(const Sparse& entries) {
  std::string text;
  for (const auto& [place, value] : entries) text += " " + std::to_string(place) + ":" + value.get_str(16);
  return text;
}

/// A bound without the terms that no plan changes, and a text of all else. The text is the same for rows that say the same:
/// terms in order, with the sign that makes their first number positive.
std::pair<Fraction, std::string> partsOf(const PlanRow& row) {
  Fraction bound = row.bound;
  std::vector<std::string> terms;
  for (const PlanRow::Term& term : row.terms) {
    Sparse z = tidy(term.z);
    if (z.empty()) {
      bound -= abs(term.constant);
      continue;
    }
    const bool is_turned = z.front().second < 0;
    for (auto& entry : z)
      if (is_turned) entry.second = -entry.second;
    const Fraction constant = is_turned ? Fraction(-term.constant) : term.constant;
    terms.push_back("|" + constant.get_str(16) + textOf(z));
  }
  std::sort(terms.begin(), terms.end());
  std::string key;
  for (const Fraction& value : row.y) key += " " + value.get_str(16);
  key += " z" + textOf(tidy(row.z));
  for (const std::string& term : terms) key += term;
  return {bound, key};
}

std::string keyOf(const PlanRow& row) {
  const auto [bound, rest] = partsOf(row);
  return bound.get_str(16) + rest;
}

/// a with a A = c, one of several where A is singular; throws Refused where there is none.
Vector solvedFromLeft(const Matrix& A, const Vector& c) {
  std::vector<Vector> rows;
  for (std::size_t i = 0; i < A.rows; ++i) {
    const auto begin = A.entries.begin() + static_cast<std::ptrdiff_t>(i * A.columns);
    rows.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(A.columns));
  }
  const std::optional<Vector> weights = weightsOf(rows, c);
  require(weights.has_value(), "a row of the certificate is none of the problem");
  return *weights;
}

/// The rows of a problem, by the closed form of the prediction:
///   e_k = A^k e_0 + sum_{j<k} A^(k-1-j) (B u~_j + drift) + sum_i (A^(k-1-i) G + sum_{i<j<k} A^(k-1-j) B L_ji) s_i
class ExpectedRows {
 public:
  ExpectedRows(const RobustCertificate& certificate, const RobustProblem& problem)
      : certificate_(certificate),
        problem_(problem),
        A_(certificate.models().at("A")),
        B_(certificate.models().at("B")),
        G_(certificate.models().at("G")),
        p_(problem.ranges.rows),
        last_stage_(problem.is_shifted ? problem.horizon : problem.horizon - 1),
        last_input_(last_stage_ - 1) {
    if (problem.feedback == RobustProblem::Feedback::kFixed) setFixedFeedback();
  }

  std::size_t predictions() const {
    const bool is_free = problem_.feedback == RobustProblem::Feedback::kFree;
    return last_input_ + (is_free ? G_.columns * last_input_ * (last_input_ + 1) / 2 : 0);
  }

  std::vector<PlanRow> run() {
    addParameters();
    for (std::size_t k = last_stage_ + 1 - problem_.horizon; k <= last_stage_; ++k) {
      addPeaks(k);
      addStates(k);
    }
    for (std::size_t k = 0; k <= last_input_; ++k) addInput(k);
    return rows_;
  }

  /// h . e + g . r <= b, of which the row is the worst case at the stage that must lie in the invariant set.
  ExactHalfSpace invariantRow(const PlanRow& row) const {
    const std::size_t stage = problem_.invariance == RobustProblem::Invariance::kFirstStep ? 1 : last_stage_;
    Vector h;
    for (const std::size_t error : problem_.errors) h.push_back(row.y[error]);
    for (std::size_t k = 0; k < stage; ++k) h = solvedFromLeft(A_, h);
    PlanRow expected = worstState(h, stage);
    ExactHalfSpace result{Vector(row.y.begin(), row.y.begin() + static_cast<std::ptrdiff_t>(p_)), 0};
    for (std::size_t i = 0; i < h.size(); ++i) result.a[problem_.errors[i]] = h[i];
    std::copy_n(row.y.begin(), p_, expected.y.begin());
    const auto [own_bound, own_rest] = partsOf(row);
    const auto [worst, rest] = partsOf(expected);
    require(own_rest == rest, "a row of the certificate is none of the problem");
    result.bound = own_bound - worst;
    return result;
  }

 private:
  PlanRow empty() const {
    PlanRow row;
    row.y.resize(p_ + 2);
    return row;
  }

  /// K (A + B K)^j G for each j.
  void setFixedFeedback() {
    const Matrix& gain = certificate_.models().at("feedback_gain");
    Matrix closed_loop = multiplied(B_, gain);
    for (std::size_t k = 0; k < closed_loop.entries.size(); ++k) closed_loop.entries[k] += A_.entries[k];
    Matrix reaction = G_;
    for (std::size_t j = 0; j < problem_.horizon; ++j) {
      fixed_.push_back(multiplied(gain, reaction));
      reaction = multiplied(closed_loop, reaction);
    }
  }

  /// The term has weight times L_ji of a channel.
  void addFeedback(const Fraction& weight, std::size_t j, std::size_t i, std::size_t channel,
                   PlanRow::Term& term) const {
    if (problem_.feedback == RobustProblem::Feedback::kFixed)
      term.constant += weight * fixed_[j - 1 - i].at(0, channel);
    if (problem_.feedback == RobustProblem::Feedback::kFree)
      term.z.emplace_back(last_input_ + (j * (j - 1) / 2 + i) * G_.columns + channel, weight);
  }

  /// Adds weight times u~_j.
  void addPlanned(const Fraction& weight, std::size_t j, PlanRow& row) const {
    if (j == 0)
      row.y[p_] += weight;
    else
      row.z.emplace_back(j - 1, weight);
  }

  /// The worst case of direction e_k.
  PlanRow worstState(const Vector& direction, std::size_t k) const {
    std::vector<Vector> powers = {direction};  // direction A^j
    for (std::size_t j = 0; j < k; ++j) powers.push_back(timesMatrix(powers.back(), A_));
    PlanRow row = empty();
    for (std::size_t i = 0; i < A_.rows; ++i) row.y[problem_.errors[i]] += powers[k][i];
    std::vector<Fraction> on_input;  // direction A^(k-1-j) B
    for (std::size_t j = 0; j < k; ++j) {
      on_input.push_back(timesMatrix(powers[k - 1 - j], B_)[0]);
      addPlanned(on_input.back(), j, row);
      row.bound -= timesMatrix(powers[k - 1 - j], certificate_.models().at("drift"))[0];
    }
    for (std::size_t i = 0; i < k; ++i) {
      const Vector direct = timesMatrix(powers[k - 1 - i], G_);
      for (std::size_t channel = 0; channel < G_.columns; ++channel) {
        PlanRow::Term term{direct[channel], {}};
        for (std::size_t j = i + 1; j < k; ++j) addFeedback(on_input[j], j, i, channel, term);
        row.terms.push_back(term);
      }
    }
    return row;
  }

  void addParameters() {
    for (std::size_t j = 0; j < p_; ++j) {
      for (const int sign : {1, -1}) {
        PlanRow row = empty();
        row.y[j] = sign;
        row.bound = sign > 0 ? problem_.ranges.at(j, 1) : Fraction(-problem_.ranges.at(j, 0));
        rows_.push_back(row);
      }
    }
    PlanRow floor = empty();
    floor.y[p_ + 1] = -1;
    floor.bound = -problem_.floor;
    rows_.push_back(floor);
  }

  void addPeaks(std::size_t k) {
    for (std::size_t i = 0; i < problem_.C.rows; ++i) {
      for (const int sign : {1, -1}) {
        Vector direction;
        for (std::size_t s = 0; s < A_.rows; ++s) direction.emplace_back(sign * problem_.C.at(i, s));
        PlanRow row = worstState(direction, k);
        row.y[p_ + 1] -= 1;
        rows_.push_back(row);
      }
    }
  }

  void addBound(PlanRow row, const Matrix& shift, std::size_t entry, int sign,
                const RobustProblem::Range& range) {
    for (std::size_t j = 0; j < p_; ++j) row.y[j] += sign * shift.at(j, entry);
    row.bound += sign > 0 ? range.second : Fraction(-range.first);
    rows_.push_back(row);
  }

  void addStates(std::size_t k) {
    for (const auto& [state, range] : problem_.state_ranges) {
      for (const int sign : {1, -1}) {
        Vector direction(A_.rows);
        direction[state] = sign;
        addBound(worstState(direction, k), problem_.state_shift, state, sign, range);
      }
    }
  }

  void addInput(std::size_t k) {
    for (const int sign : {1, -1}) {
      PlanRow row = empty();
      addPlanned(Fraction(sign), k, row);
      for (std::size_t i = 0; i < k; ++i) {
        for (std::size_t channel = 0; channel < G_.columns; ++channel) {
          PlanRow::Term term;
          addFeedback(Fraction(sign), k, i, channel, term);
          row.terms.push_back(term);
        }
      }
      addBound(row, problem_.input_shift, 0, sign, problem_.input_range);
    }
  }

  const RobustCertificate& certificate_;
  const RobustProblem& problem_;
  const Matrix &A_, &B_, &G_;
  const std::size_t p_, last_stage_, last_input_;
  std::vector<Matrix> fixed_;
  std::vector<PlanRow> rows_;
};

}  // namespace

RowMatch matchRows(const RobustCertificate& certificate, const RobustProblem& problem) {
  ExpectedRows expected(certificate, problem);
  require(certificate.predictions() == expected.predictions(),
          "the plan has another size than that of the problem");
  std::map<std::string, std::vector<const PlanRow*>> open;
  for (const PlanRow& row : certificate.rows()) open[keyOf(row)].push_back(&row);
  RowMatch match;
  for (const PlanRow& row : expected.run()) {
    const auto at = open.find(keyOf(row));
    require(at != open.end(),
            "row " + std::to_string(match.expected) + " of the problem is none of the certificate");
    at->second.pop_back();
    if (at->second.empty()) open.erase(at);
    ++match.expected;
  }
  const bool has_set = problem.invariance != RobustProblem::Invariance::kNone;
  require(has_set || open.empty(), "a row of the certificate is none of the problem");
  require(!has_set || !open.empty(), "rows of the invariant set are missing");
  if (!has_set) return match;
  std::vector<ExactHalfSpace> set;
  for (const auto& [key, rows] : open)
    for (const PlanRow* row : rows) set.push_back(expected.invariantRow(*row));
  match.invariant = set.size();
  confirmInvariant(set, certificate, problem);
  match.is_greatest = isGreatestInvariant(set, certificate, problem);
  return match;
}

}  // namespace checker
