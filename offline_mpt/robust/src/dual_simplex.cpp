#include "dual_simplex.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "rational_parts.hpp"
#include "tolerances.hpp"

namespace polyfly {
namespace {

constexpr std::uint64_t kRebuild = 400;  // pivots after which the dictionary is computed anew
constexpr int kPatience = 2000;          // pivots before the slow rule that cannot cycle

}  // namespace

DualSimplex::DualSimplex(int variables, int parameters)
    : n_(variables), h_(parameters), width_(variables + parameters), eta_(at(parameters)) {
  startCold();
}

void DualSimplex::startCold() {
  table_.clear();
  basic_.clear();
  nonbasic_.resize(at(n_));
  std::iota(nonbasic_.begin(), nonbasic_.end(), 0);
  place_.assign(at(n_), kNone);
  cost_.assign(at(width_), 0.0);
  cost_[at(n_ - 1)] = 1.0;
  since_rebuild_ = 0;
  for (int i = 0; i < rowCount(); ++i) appendDictionaryRow(n_ + i, &a_[at(i * n_)], &e_[at(i * h_)]);
}

void DualSimplex::addRow(int tag, const double* a, const double* e) {
  const int index = rowCount();
  tags_.push_back(tag);
  a_.insert(a_.end(), a, a + n_);
  e_.insert(e_.end(), e, e + h_);
  appendDictionaryRow(n_ + index, a, e);
}

void DualSimplex::appendDictionaryRow(int variable, const double* a, const double* e) {
  const int r = static_cast<int>(basic_.size());
  table_.resize(table_.size() + at(width_), 0.0);
  basic_.push_back(variable);
  double* fresh = row(r);
  std::copy(e, e + h_, fresh + n_);
  for (int j = 0; j < n_; ++j) {
    if (nonbasic_[at(j)] < n_) fresh[j] -= a[nonbasic_[at(j)]];
  }
  for (int x = 0; x < n_; ++x) {
    if (place_[at(x)] == kNone || a[x] == 0.0) continue;
    const double* source = row(place_[at(x)]);
    for (int j = 0; j < width_; ++j) fresh[j] -= a[x] * source[j];
  }
}

void DualSimplex::setParameters(const double* eta) { std::copy(eta, eta + h_, eta_.begin()); }

double DualSimplex::constant(int r) const {
  const double* source = row(r) + n_;
  double sum = 0.0;
  for (int j = 0; j < h_; ++j) sum += source[j] * eta_[at(j)];
  return sum;
}

double DualSimplex::value(int variable) const {
  return place_[at(variable)] == kNone ? 0.0 : constant(place_[at(variable)]);
}

int DualSimplex::leavingRow(bool by_index) const {
  int best = kNone;
  double worst = -tolerance::kFeasibleSlack;
  for (int r = 0; r < static_cast<int>(basic_.size()); ++r) {
    if (isFree(basic_[at(r)])) continue;
    const double value = constant(r);
    if (by_index) {
      if (value < -tolerance::kFeasibleSlack && (best == kNone || basic_[at(r)] < basic_[at(best)])) best = r;
    } else if (value < worst) {
      worst = value;
      best = r;
    }
  }
  return best;
}

int DualSimplex::enteringColumn(int leaving, bool by_index) const {
  const double* entries = row(leaving);
  int best = kNone;
  double largest = tolerance::kLeastPivot;
  for (int j = 0; j < n_; ++j) {  // a free one costs nothing
    if (!isFree(nonbasic_[at(j)])) continue;
    if (std::abs(entries[j]) > largest) {
      largest = std::abs(entries[j]);
      best = j;
    }
  }
  if (best != kNone) return best;
  double bound = std::numeric_limits<double>::infinity();
  for (int j = 0; j < n_; ++j) {
    if (entries[j] > tolerance::kLeastPivot)
      bound = std::min(bound, (cost_[at(j)] + (by_index ? 0.0 : tolerance::kSameCost)) / entries[j]);
  }
  for (int j = 0; j < n_; ++j) {
    if (entries[j] <= tolerance::kLeastPivot || cost_[at(j)] / entries[j] > bound) continue;
    const bool better =
        by_index ? best == kNone || nonbasic_[at(j)] < nonbasic_[at(best)] : entries[j] > largest;
    if (!better) continue;
    largest = entries[j];
    best = j;
  }
  return best;
}

void DualSimplex::pivot(int leaving, int entering) {
  double* source = row(leaving);
  const double inverse = 1.0 / source[entering];
  // entering = (leaving - the rest) / pivot
  for (int j = 0; j < width_; ++j) source[j] *= -inverse;
  source[entering] = inverse;
  const auto substitute = [&](double* target) {
    const double factor = target[entering];
    if (factor == 0.0) return;
    target[entering] = 0.0;
    for (int j = 0; j < width_; ++j) target[j] += factor * source[j];
  };
  for (int r = 0; r < static_cast<int>(basic_.size()); ++r) {
    if (r != leaving) substitute(row(r));
  }
  substitute(cost_.data());
  const int out = basic_[at(leaving)], in = nonbasic_[at(entering)];
  if (out < n_) place_[at(out)] = kNone;
  if (in < n_) place_[at(in)] = leaving;
  basic_[at(leaving)] = in;
  nonbasic_[at(entering)] = out;
  ++pivots_;
  ++since_rebuild_;
}

// The same basis from the given rows; a cold start where that is too inaccurate.
void DualSimplex::rebuild(const std::vector<int>& nonbasic_rows) {
  startCold();
  std::vector<int> waiting = nonbasic_rows;
  while (!waiting.empty()) {
    int best = kNone, column = kNone;
    double largest = tolerance::kLeastPivot;
    for (std::size_t k = 0; k < waiting.size(); ++k) {
      const double* entries = row(waiting[k]);
      for (int j = 0; j < n_; ++j) {
        if (nonbasic_[at(j)] >= n_ || std::abs(entries[j]) <= largest) continue;
        largest = std::abs(entries[j]);
        best = static_cast<int>(k);
        column = j;
      }
    }
    if (best == kNone) return startCold();
    // the dictionary's order is that of the rows until now, so the row's number is its place
    pivot(waiting[at(best)], column);
    waiting.erase(waiting.begin() + best);
  }
  for (int j = 0; j < n_; ++j) cost_[at(j)] = std::max(cost_[at(j)], 0.0);
  since_rebuild_ = 0;
}

DualSimplex::Status DualSimplex::iterate() {
  for (int count = 0; count < 2 * kPatience; ++count) {
    if (since_rebuild_ > kRebuild) {
      std::vector<int> rows;
      for (const int variable : nonbasic_) {
        if (variable >= n_) rows.push_back(variable - n_);
      }
      std::sort(rows.begin(), rows.end());
      rebuild(rows);
    }
    const bool by_index = count > kPatience;
    const int leaving = leavingRow(by_index);
    if (leaving == kNone) return Status::kOptimal;
    const int entering = enteringColumn(leaving, by_index);
    if (entering == kNone) return Status::kInfeasible;
    pivot(leaving, entering);
    for (int j = 0; j < n_; ++j) cost_[at(j)] = std::max(cost_[at(j)], 0.0);  // rounding below zero
  }
  return Status::kLimit;
}

DualSimplex::Status DualSimplex::solve() {
  Status status = iterate();
  if (status != Status::kOptimal && since_rebuild_ > 0) {
    startCold();
    status = iterate();
  }
  return status;
}

std::vector<DualSimplex::TightRow> DualSimplex::tight() const {
  std::vector<TightRow> result;
  for (int j = 0; j < n_; ++j) {
    const int variable = nonbasic_[at(j)];
    if (variable >= n_) result.push_back({tags_[at(variable - n_)], cost_[at(j)]});
  }
  std::sort(result.begin(), result.end(), [](const TightRow& a, const TightRow& b) { return a.tag < b.tag; });
  return result;
}

bool DualSimplex::dropSlackest(int count) {
  if (rowCount() <= count) return false;
  std::vector<double> slack(at(rowCount()), 0.0);
  std::vector<char> is_nonbasic(at(rowCount()), 1);
  for (std::size_t r = 0; r < basic_.size(); ++r) {
    if (basic_[r] < n_) continue;
    slack[at(basic_[r] - n_)] = constant(static_cast<int>(r));
    is_nonbasic[at(basic_[r] - n_)] = 0;
  }
  std::vector<int> order(at(rowCount()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return is_nonbasic[at(a)] != is_nonbasic[at(b)] ? is_nonbasic[at(a)] > is_nonbasic[at(b)]
                                                    : slack[at(a)] < slack[at(b)];
  });
  order.resize(at(count));
  std::sort(order.begin(), order.end());
  std::vector<int> tags, rows;
  std::vector<double> a, e;
  for (const int i : order) {
    if (is_nonbasic[at(i)] != 0) rows.push_back(static_cast<int>(tags.size()));
    tags.push_back(tags_[at(i)]);
    a.insert(a.end(), a_.begin() + i * n_, a_.begin() + (i + 1) * n_);
    e.insert(e.end(), e_.begin() + i * h_, e_.begin() + (i + 1) * h_);
  }
  tags_ = std::move(tags);
  a_ = std::move(a);
  e_ = std::move(e);
  rebuild(rows);
  return true;
}

}  // namespace polyfly
