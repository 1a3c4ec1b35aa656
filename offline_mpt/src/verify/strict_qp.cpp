#include "verify/strict_qp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "verify/tolerances.hpp"

namespace polyfly {
namespace {

using Vector = std::vector<DoubleDouble>;

// Steps for each row after which StrictQp gives up.
constexpr int kStepsPerRow = 20;

DoubleDouble dot(const DoubleDouble* a, const DoubleDouble* b, std::size_t count) {
  DoubleDouble sum;
  for (std::size_t i = 0; i < count; ++i) sum += a[i] * b[i];
  return sum;
}

DoubleDouble dot(const Vector& a, const Vector& b) { return dot(a.data(), b.data(), a.size()); }

/// constant + row . x, with 32 digits.
template <class Row, class Column>
DoubleDouble affine(double constant, const Row& row, const Column& x) {
  DoubleDouble sum(constant);
  for (Eigen::Index j = 0; j < row.size(); ++j) {
    if (row[j] != 0.0) sum += exactProduct(row[j], x[j]);
  }
  return sum;
}

/// M = R R' for symmetric M, in place. False where a pivot is not positive beyond rounding.
bool factorise(Vector& M, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    const double whole = M[i * n + i].high;
    for (std::size_t j = 0; j <= i; ++j) {
      const DoubleDouble rest = M[i * n + j] - dot(&M[i * n], &M[j * n], j);
      if (i != j) {
        M[i * n + j] = rest / M[j * n + j];
      } else if (rest.high > tolerance::kRankOfSquares * whole) {
        M[i * n + i] = sqrt(rest);
      } else {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

StrictQp::StrictQp(const ParametricProgram& program, Convexity convexity)
    : program_(&program),
      n_(program.variableCount()),
      convexity_(convexity),
      equality_(static_cast<std::size_t>(program.rowCount()), 0),
      rows_(static_cast<std::size_t>(program.rowCount())),
      squared_(rows_.size(), 0.0),
      output_length_(program.inputCount()) {
  const auto n = static_cast<std::size_t>(n_);
  for (const int index : program.equalities) equality_[static_cast<std::size_t>(index)] = 1;
  L_ = hessian();
  definite_ = factorise(L_, n);
  if (!definite_ && !program.equalities.empty() && !program.H.isZero(0.0)) {
    L_ = hessian();
    addEqualities(L_);
    definite_ = factorise(L_, n);
  }
  if (!definite_) return;
  for (int k = 0; k < program.inputCount(); ++k) {
    Vector e(n);
    for (int j = 0; j < n_; ++j) e[static_cast<std::size_t>(j)] = program.E(k, j);
    solveLower(e);
    output_length_[k] = std::sqrt(dot(e, e).high);
  }
}

StrictQp::Vector StrictQp::hessian() const {
  const bool has_cost = convexity_ != Convexity::kFeasibility;
  const double most = n_ > 0 ? program_->H.diagonal().maxCoeff() : 0.0;
  const double added = convexity_ == Convexity::kAsGiven ? 0.0
                       : has_cost && most > 0.0          ? tolerance::kRegularisedHessian * most
                                                         : 1.0;
  const double share = has_cost && added == 1.0 ? tolerance::kRegularisedHessian : 1.0;
  Vector H;
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j < n_; ++j) {
      H.emplace_back(has_cost ? program_->H(i, j) : 0.0);
      if (i == j) H.back() += DoubleDouble(added * share);
    }
  }
  return H;
}

// Squares of equalities in the cost change no optimum. H then need be definite only where they hold.
void StrictQp::addEqualities(Vector& H) {
  const double most = program_->H.diagonal().maxCoeff();
  for (const int index : program_->equalities) {
    const auto a = program_->A.row(index);
    const double squared = a.squaredNorm();
    equality_weights_.push_back(squared > 0.0 ? most / squared : 0.0);
    for (int i = 0; i < n_; ++i) {
      for (int j = 0; j < n_; ++j)
        H[static_cast<std::size_t>(i * n_ + j)] += equality_weights_.back() * exactProduct(a[i], a[j]);
    }
  }
}

void StrictQp::solveLower(Vector& x) const {
  const auto n = static_cast<std::size_t>(n_);
  for (std::size_t i = 0; i < n; ++i) x[i] = (x[i] - dot(&L_[i * n], x.data(), i)) / L_[i * n + i];
}

void StrictQp::solveUpper(Vector& x) const {
  const auto n = static_cast<std::size_t>(n_);
  for (std::size_t i = n; i-- > 0;) {
    x[i] = x[i] / L_[i * n + i];
    for (std::size_t j = 0; j < i; ++j) x[j] -= L_[i * n + j] * x[i];
  }
}

const StrictQp::Vector& StrictQp::row(int index) {
  Vector& row = rows_[static_cast<std::size_t>(index)];
  if (row.empty() && n_ > 0) {
    for (Eigen::Index j = 0; j < program_->A.cols(); ++j) row.emplace_back(program_->A(index, j));
    solveLower(row);
    squared_[static_cast<std::size_t>(index)] = dot(row, row).high;
  }
  return row;
}

void StrictQp::setParameter(const Eigen::VectorXd& theta) {
  bounds_.resize(rows_.size());
  for (int i = 0; i < program_->rowCount(); ++i)
    bounds_[static_cast<std::size_t>(i)] = affine(program_->b[i], program_->S.row(i), theta);
  gradient_.assign(static_cast<std::size_t>(n_), {});
  for (int i = 0; i < n_ && convexity_ != Convexity::kFeasibility; ++i)
    gradient_[static_cast<std::size_t>(i)] = affine(program_->f[i], program_->F.row(i), theta);
  for (std::size_t e = 0; e < equality_weights_.size(); ++e) {
    const int index = program_->equalities[e];
    const DoubleDouble weighted = equality_weights_[e] * bounds_[static_cast<std::size_t>(index)];
    for (int i = 0; i < n_; ++i)
      gradient_[static_cast<std::size_t>(i)] -= DoubleDouble(program_->A(index, i)) * weighted;
  }
  solveLower(gradient_);
}

// Adds a row to the tight ones and to the factor. False where it depends on them.
bool StrictQp::append(int index) {
  const Vector& added = row(index);
  Vector line;
  for (std::size_t i = 0; i < tight_.size(); ++i) {
    const DoubleDouble product = dot(added, rows_[static_cast<std::size_t>(tight_[i])]);
    line.push_back((product - dot(factor_[i].data(), line.data(), i)) / factor_[i][i]);
  }
  const DoubleDouble rest = dot(added, added) - dot(line, line);
  if (!(rest.high > tolerance::kRankOfSquares * squared_[static_cast<std::size_t>(index)])) return false;
  line.push_back(sqrt(rest));
  factor_.push_back(std::move(line));
  tight_.push_back(index);
  return true;
}

void StrictQp::remove(std::size_t place) {
  std::vector<int> after(tight_.begin() + static_cast<std::ptrdiff_t>(place) + 1, tight_.end());
  tight_.resize(place);
  factor_.resize(place);
  multipliers_.erase(multipliers_.begin() + static_cast<std::ptrdiff_t>(place));
  for (const int index : after) append(index);
  ++changes_;
}

StrictQp::Vector StrictQp::solveTight(Vector x) const {
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] = (x[i] - dot(factor_[i].data(), x.data(), i)) / factor_[i][i];
  for (std::size_t i = x.size(); i-- > 0;) {
    x[i] = x[i] / factor_[i][i];
    for (std::size_t j = 0; j < i; ++j) x[j] -= factor_[i][j] * x[i];
  }
  return x;
}

void StrictQp::findMultipliers() {
  Vector right;
  for (const int index : tight_)
    right.push_back(
        -(bounds_[static_cast<std::size_t>(index)] + dot(rows_[static_cast<std::size_t>(index)], gradient_)));
  multipliers_ = solveTight(std::move(right));
}

// The tight rows of the guess, without those that depend on others or push the wrong way.
void StrictQp::begin(const std::vector<int>& guess) {
  tight_.clear();
  factor_.clear();
  changes_ = 0;
  for (const int index : program_->equalities) append(index);
  for (const int index : guess) {
    if (!isEquality(index)) append(index);
  }
  for (;;) {
    findMultipliers();
    std::size_t worst = tight_.size();
    for (std::size_t i = 0; i < tight_.size(); ++i) {
      if (isEquality(tight_[i]) || multipliers_[i].high >= 0.0) continue;
      if (worst == tight_.size() || multipliers_[i].high < multipliers_[worst].high) worst = i;
    }
    if (worst == tight_.size()) return;
    remove(worst);
  }
}

void StrictQp::findMinimiser() {
  z_ = gradient_;
  for (std::size_t k = 0; k < tight_.size(); ++k) {
    const Vector& a = rows_[static_cast<std::size_t>(tight_[k])];
    for (std::size_t i = 0; i < z_.size(); ++i) z_[i] += multipliers_[k] * a[i];
  }
  for (DoubleDouble& entry : z_) entry = -entry;
  solveUpper(z_);
}

// In the metric of H, in which a unit moves an output by at most its length.
int StrictQp::mostViolated(double reach) {
  int worst = -1;
  double greatest = 0.0;
  for (int i = 0; i < program_->rowCount(); ++i) {
    DoubleDouble excess = -bounds_[static_cast<std::size_t>(i)];
    double terms = std::abs(excess.high);
    for (int j = 0; j < n_; ++j) {
      const DoubleDouble term = program_->A(i, j) * z_[static_cast<std::size_t>(j)];
      excess += term;
      terms += std::abs(term.high);
    }
    const double size = isEquality(i) ? std::abs(excess.high) : excess.high;
    if (!(size > tolerance::kRoundedExcess * terms)) continue;
    row(i);
    const double distance = size / std::sqrt(squared_[static_cast<std::size_t>(i)]);
    if (distance > std::max(reach, greatest)) {
      greatest = distance;
      worst = i;
    }
  }
  return worst;
}

// Raises the multiplier of a violated row until it is tight; rows that would push the wrong way leave. False where the row
// contradicts the tight ones: no z meets all.
bool StrictQp::meet(int index) {
  const Vector added = row(index);
  const DoubleDouble whole = dot(added, added);
  const double squared = whole.high;
  DoubleDouble own;                     // its multiplier
  if (isEquality(index)) return false;  // it depends on the other ones
  for (;;) {
    ++changes_;
    Vector products;
    for (const int other : tight_) products.push_back(dot(added, rows_[static_cast<std::size_t>(other)]));
    const Vector shares = solveTight(products);  // multipliers fall by these
    const DoubleDouble curvature = whole - dot(products, shares);
    DoubleDouble excess = -bounds_[static_cast<std::size_t>(index)] - dot(added, gradient_) - own * whole;
    for (std::size_t i = 0; i < tight_.size(); ++i) excess -= multipliers_[i] * products[i];
    const bool depends = !(curvature.high > tolerance::kRankOfSquares * squared);
    DoubleDouble step = depends ? DoubleDouble(std::numeric_limits<double>::infinity()) : excess / curvature;
    std::size_t leaving = tight_.size();
    for (std::size_t i = 0; i < tight_.size(); ++i) {
      const double length = std::sqrt(squared_[static_cast<std::size_t>(tight_[i])] / squared);
      if (isEquality(tight_[i]) || !(shares[i].high * length > tolerance::kNoShare)) continue;
      const DoubleDouble least = multipliers_[i] / shares[i];
      if (least.high < step.high) {
        step = least;
        leaving = i;
      }
    }
    if (leaving == tight_.size() && depends) return false;
    for (std::size_t i = 0; i < tight_.size(); ++i) multipliers_[i] -= step * shares[i];
    own += step;
    if (leaving == tight_.size()) {
      if (!append(index)) return false;
      multipliers_.push_back(own);
      return true;
    }
    remove(leaving);
  }
}

Eigen::VectorXd StrictQp::output(const Eigen::VectorXd& theta) const {
  Eigen::VectorXd u(program_->inputCount());
  for (int k = 0; k < program_->inputCount(); ++k) {
    DoubleDouble sum = affine(program_->c[k], program_->C.row(k), theta);
    for (int j = 0; j < n_; ++j) sum += DoubleDouble(program_->E(k, j)) * z_[static_cast<std::size_t>(j)];
    u[k] = sum.high;
  }
  return u;
}

StrictAnswer StrictQp::solve(const Eigen::VectorXd& theta, const std::vector<int>& guess,
                             const Eigen::VectorXd& precision) {
  StrictAnswer answer;
  for (Eigen::Index i = 0; i < program_->A_theta.rows(); ++i) {
    if (affine(-program_->b_theta[i], program_->A_theta.row(i), theta).high > 0.0) {
      answer.verdict = StrictAnswer::Verdict::kInfeasible;
      return answer;
    }
  }
  double reach = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < precision.size(); ++k) {
    if (output_length_[k] > 0.0) reach = std::min(reach, precision[k] / output_length_[k]);
  }
  if (std::isinf(reach)) reach = 0.0;  // no z moves an output
  setParameter(theta);
  begin(guess);
  const int most = kStepsPerRow * (program_->rowCount() + 1);
  while (changes_ <= most) {
    findMinimiser();
    const int violated = mostViolated(reach);
    if (violated < 0) {
      answer.verdict = StrictAnswer::Verdict::kOptimal;
      answer.u = output(theta);
      for (std::size_t i = 0; i < tight_.size(); ++i) {
        if (isEquality(tight_[i]) || multipliers_[i].high > 0.0) answer.pushing.push_back(tight_[i]);
      }
      break;
    }
    if (!meet(violated)) {
      answer.verdict = StrictAnswer::Verdict::kInfeasible;
      break;
    }
  }
  answer.changes = changes_;
  return answer;
}

}  // namespace polyfly
