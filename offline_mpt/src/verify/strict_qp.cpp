#include "verify/strict_qp.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "verify/tolerances.hpp"

namespace polyfly {
namespace {

// Steps for each row after which StrictQp gives up.
constexpr int kStepsPerRow = 20;

/// constant + rows x, with 32 digits.
template <class Vector, class Matrix, class Column>
auto affine(const Vector& constant, const Matrix& rows, const Column& x) {
  return constant.template cast<DoubleDouble>() +
         rows.template cast<DoubleDouble>() * x.template cast<DoubleDouble>();
}

}  // namespace

StrictQp::StrictQp(const ParametricProgram& program, Convexity convexity)
    : program_(&program), convexity_(convexity), equality_(static_cast<std::size_t>(program.rowCount()), 0) {
  for (const int index : program.equalities) equality_[static_cast<std::size_t>(index)] = 1;
  WideMatrix H = hessian();
  factorise(H);
  if (!definite_ && !program.equalities.empty() && !program.H.isZero(0.0)) {
    addEqualities(H);
    factorise(H);
  }
  if (!definite_) return;
  const auto L = L_.triangularView<Eigen::Lower>();
  rows_ = L.solve(wide(program.A.transpose()));
  squared_ = rows_.colwise().squaredNorm().transpose();
  output_length_ = rounded(L.solve(wide(program.E.transpose()))).colwise().norm().transpose();
  factor_.resize(rows_.rows(), rows_.rows());
}

WideMatrix StrictQp::hessian() const {
  const bool has_cost = convexity_ != Convexity::kFeasibility;
  const Eigen::MatrixXd& H = program_->H;
  const double most = H.size() > 0 ? H.diagonal().maxCoeff() : 0.0;
  const double added = convexity_ == Convexity::kAsGiven ? 0.0
                       : has_cost && most > 0.0          ? tolerance::kRegularisedHessian * most
                                                         : 1.0;
  const double share = has_cost && added == 1.0 ? tolerance::kRegularisedHessian : 1.0;
  WideMatrix result = wide(has_cost ? H : Eigen::MatrixXd::Zero(H.rows(), H.cols()));
  for (Eigen::Index i = 0; i < H.rows(); ++i) result(i, i) += DoubleDouble(added * share);
  return result;
}

// Squares of equalities in the cost change no optimum. H then need be definite only where they hold.
void StrictQp::addEqualities(WideMatrix& H) {
  const double most = program_->H.diagonal().maxCoeff();
  for (const int index : program_->equalities) {
    const WideMatrix a = wide(program_->A.row(index));
    const double squared = program_->A.row(index).squaredNorm();
    equality_weights_.push_back(squared > 0.0 ? most / squared : 0.0);
    H += a.transpose() * a * DoubleDouble(equality_weights_.back());
  }
}

// Not definite where a pivot is not positive beyond rounding.
void StrictQp::factorise(const WideMatrix& H) {
  const Eigen::LLT<WideMatrix> factor(H);
  L_ = factor.matrixL();
  definite_ = factor.info() == Eigen::Success;
  for (Eigen::Index i = 0; i < H.rows(); ++i)
    definite_ = definite_ && L_(i, i).high * L_(i, i).high > tolerance::kRankOfSquares * H(i, i).high;
}

void StrictQp::setParameter(const Eigen::VectorXd& theta) {
  bounds_ = affine(program_->b, program_->S, theta);
  gradient_ = Vector::Zero(L_.rows());
  if (convexity_ != Convexity::kFeasibility) gradient_ = affine(program_->f, program_->F, theta);
  for (std::size_t e = 0; e < equality_weights_.size(); ++e) {
    const int index = program_->equalities[e];
    gradient_ -= wide(program_->A.row(index).transpose()) * (equality_weights_[e] * bounds_[index]);
  }
  L_.triangularView<Eigen::Lower>().solveInPlace(gradient_);
}

// Adds a row to the tight ones and to the factor. False where it depends on them.
bool StrictQp::append(int index) {
  const auto k = static_cast<Eigen::Index>(tight_.size());
  if (k == factor_.rows()) return false;
  Vector line = tightRows().transpose() * rows_.col(index);
  factor_.topLeftCorner(k, k).triangularView<Eigen::Lower>().solveInPlace(line);
  const DoubleDouble rest = squared_[index] - line.squaredNorm();
  if (!(rest.high > tolerance::kRankOfSquares * squared_[index].high)) return false;
  factor_.row(k).head(k) = line.transpose();
  factor_(k, k) = sqrt(rest);
  tight_.push_back(index);
  return true;
}

void StrictQp::remove(std::size_t place) {
  const std::vector<int> after(tight_.begin() + static_cast<std::ptrdiff_t>(place) + 1, tight_.end());
  tight_.resize(place);
  const auto rest = static_cast<Eigen::Index>(after.size()), first = static_cast<Eigen::Index>(place);
  multipliers_.segment(first, rest) = multipliers_.tail(rest).eval();
  multipliers_.conservativeResize(first + rest);
  for (const int index : after) append(index);
  ++changes_;
}

WideMatrix StrictQp::tightRows() const {
  WideMatrix result(rows_.rows(), tight_.size());
  for (std::size_t k = 0; k < tight_.size(); ++k)
    result.col(static_cast<Eigen::Index>(k)) = rows_.col(tight_[k]);
  return result;
}

StrictQp::Vector StrictQp::solveTight(Vector x) const {
  const auto L = factor_.topLeftCorner(x.size(), x.size()).triangularView<Eigen::Lower>();
  L.solveInPlace(x);
  L.transpose().solveInPlace(x);
  return x;
}

void StrictQp::findMultipliers() {
  Vector right = -(tightRows().transpose() * gradient_);
  for (std::size_t k = 0; k < tight_.size(); ++k) right[static_cast<Eigen::Index>(k)] -= bounds_[tight_[k]];
  multipliers_ = solveTight(std::move(right));
}

// The tight rows of the guess, without those that depend on others or push the wrong way.
void StrictQp::begin(const std::vector<int>& guess) {
  tight_.clear();
  changes_ = 0;
  for (const int index : program_->equalities) append(index);
  for (const int index : guess) {
    if (!isEquality(index)) append(index);
  }
  for (;;) {
    findMultipliers();
    std::size_t worst = tight_.size();
    for (std::size_t i = 0; i < tight_.size(); ++i) {
      if (isEquality(tight_[i]) || multipliers_[static_cast<Eigen::Index>(i)].high >= 0.0) continue;
      if (worst == tight_.size() || multipliers_[static_cast<Eigen::Index>(i)].high <
                                        multipliers_[static_cast<Eigen::Index>(worst)].high)
        worst = i;
    }
    if (worst == tight_.size()) return;
    remove(worst);
  }
}

void StrictQp::findMinimiser() {
  z_ = -(gradient_ + tightRows() * multipliers_);
  L_.transpose().triangularView<Eigen::Upper>().solveInPlace(z_);
}

// In the metric of H, in which a unit moves an output by at most its length.
int StrictQp::mostViolated(double reach) const {
  int worst = -1;
  double greatest = 0.0;
  for (int i = 0; i < program_->rowCount(); ++i) {
    const Vector terms = wide(program_->A.row(i).transpose()).cwiseProduct(z_);
    const DoubleDouble excess = terms.sum() - bounds_[i];
    const double whole = std::abs(bounds_[i].high) + terms.cast<double>().cwiseAbs().sum();
    const double size = isEquality(i) ? std::abs(excess.high) : excess.high;
    if (!(size > tolerance::kRoundedExcess * whole)) continue;
    const double distance = size / std::sqrt(squared_[i].high);
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
  const Vector added = rows_.col(index);
  const DoubleDouble whole = squared_[index];
  DoubleDouble own;                     // its multiplier
  if (isEquality(index)) return false;  // it depends on the other ones
  for (;;) {
    ++changes_;
    const Vector products = tightRows().transpose() * added;
    const Vector shares = solveTight(products);  // multipliers fall by these
    const DoubleDouble curvature = whole - products.dot(shares);
    const DoubleDouble excess =
        -bounds_[index] - added.dot(gradient_) - own * whole - multipliers_.dot(products);
    const bool depends = !(curvature.high > tolerance::kRankOfSquares * whole.high);
    DoubleDouble step = depends ? DoubleDouble(std::numeric_limits<double>::infinity()) : excess / curvature;
    std::size_t leaving = tight_.size();
    for (std::size_t i = 0; i < tight_.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      const double length = std::sqrt(squared_[tight_[i]].high / whole.high);
      if (isEquality(tight_[i]) || !(shares[at].high * length > tolerance::kNoShare)) continue;
      const DoubleDouble least = multipliers_[at] / shares[at];
      if (least.high < step.high) {
        step = least;
        leaving = i;
      }
    }
    if (leaving == tight_.size() && depends) return false;
    multipliers_ -= shares * step;
    own += step;
    if (leaving == tight_.size()) {
      if (!append(index)) return false;
      multipliers_.conservativeResize(multipliers_.size() + 1);
      multipliers_[multipliers_.size() - 1] = own;
      return true;
    }
    remove(leaving);
  }
}

Eigen::VectorXd StrictQp::output(const Eigen::VectorXd& theta) const {
  const Vector u = affine(program_->c, program_->C, theta) + wide(program_->E) * z_;
  return u.cast<double>();
}

StrictAnswer StrictQp::solve(const Eigen::VectorXd& theta, const std::vector<int>& guess,
                             const Eigen::VectorXd& precision) {
  StrictAnswer answer;
  const Vector beyond = affine(-program_->b_theta, program_->A_theta, theta);
  if (std::any_of(beyond.data(), beyond.data() + beyond.size(),
                  [](const DoubleDouble& value) { return value.high > 0.0; })) {
    answer.verdict = StrictAnswer::Verdict::kInfeasible;
    return answer;
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
        if (isEquality(tight_[i]) || multipliers_[static_cast<Eigen::Index>(i)].high > 0.0)
          answer.pushing.push_back(tight_[i]);
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
