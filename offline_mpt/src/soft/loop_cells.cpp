#include "soft/loop_cells.hpp"

#include <algorithm>
#include <cmath>

#include "soft/tolerances.hpp"

namespace polyfly {

LoopScale::LoopScale(const MpcProblem& problem)
    : p_(static_cast<Eigen::Index>(problem.parameters.size())), channel_count_(problem.Bd_c.cols()) {
  std::vector<const Signal*> entries;
  for (const MpcProblem::Parameter& parameter : problem.parameters) entries.push_back(&parameter.signal);
  for (std::size_t i = 0; i < problem.disturbances.size(); ++i) {
    if (!std::isfinite(problem.disturbances[i].lower)) continue;
    entries.push_back(&problem.disturbances[i]);
    channels_.push_back(static_cast<Eigen::Index>(i));
  }
  middle_.resize(static_cast<Eigen::Index>(entries.size()));
  lower_ = upper_ = half_ = middle_;
  for (Eigen::Index j = 0; j < middle_.size(); ++j) {
    const Signal& signal = *entries[static_cast<std::size_t>(j)];
    lower_(j) = signal.lower;
    upper_(j) = signal.upper;
    middle_(j) = 0.5 * (signal.lower + signal.upper);
    half_(j) = 0.5 * (signal.upper - signal.lower);
  }
}

Eigen::VectorXd LoopScale::theta(const Eigen::VectorXd& s) const {
  const Eigen::VectorXd theta = middle_.head(p_) + half_.head(p_).cwiseProduct(s.head(p_));
  return theta.cwiseMax(lower_.head(p_)).cwiseMin(upper_.head(p_));
}

Eigen::VectorXd LoopScale::disturbance(const Eigen::VectorXd& s) const {
  Eigen::VectorXd d = Eigen::VectorXd::Zero(channel_count_);
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const Eigen::Index entry = p_ + static_cast<Eigen::Index>(i);
    d(channels_[i]) = std::clamp(middle_(entry) + half_(entry) * s(entry), lower_(entry), upper_(entry));
  }
  return d;
}

Eigen::MatrixXd LoopScale::loop(const CriticalRegion& region) const {
  const Eigen::Index nu = region.K.rows(), last = size();
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(p_ + nu + channel_count_ + 1, size() + 1);
  w.topLeftCorner(p_, p_) = half_.head(p_).asDiagonal();
  w.col(last).head(p_) = middle_.head(p_);
  w.middleRows(p_, nu).noalias() = region.K * w.topRows(p_);
  w.col(last).segment(p_, nu) += region.k;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const Eigen::Index entry = p_ + static_cast<Eigen::Index>(i);
    w(p_ + nu + channels_[i], entry) = half_(entry);
    w(p_ + nu + channels_[i], last) = middle_(entry);
  }
  w(w.rows() - 1, last) = 1.0;
  return w;
}

Eigen::RowVectorXd LoopScale::ofTheta(const Eigen::RowVectorXd& on_theta, double constant) const {
  Eigen::RowVectorXd function = Eigen::RowVectorXd::Zero(size() + 1);
  function.head(p_) = on_theta.cwiseProduct(half_.head(p_).transpose());
  function(size()) = on_theta.dot(middle_.head(p_)) + constant;
  return function;
}

Eigen::MatrixXd LoopScale::scaled(const Eigen::MatrixXd& theta) const {
  Eigen::MatrixXd result = theta;
  result.col(size()) -= middle_.head(p_);
  return half_.head(p_).cwiseInverse().asDiagonal() * result;
}

LoopCell::LoopCell(Eigen::Index size) : size_(size), solver_(static_cast<int>(size)), interior_(size) {
  reset();
}

void LoopCell::reset() {
  rows_.clear();
  count_ = 0;
  empty_ = false;
  for (Eigen::Index j = 0; j < size_; ++j) {
    for (const double sign : {1.0, -1.0}) {
      Eigen::RowVectorXd face = sign * Eigen::RowVectorXd::Unit(size_ + 1, j);
      face(size_) = -1.0;
      addRow(face);
    }
  }
}

void LoopCell::add(const Eigen::MatrixXd& functions) {
  for (Eigen::Index i = 0; i < functions.rows(); ++i) addRow(functions.row(i));
}

void LoopCell::addRow(const Eigen::RowVectorXd& function) {
  const double length = function.head(size_).norm();
  if (length <= tolerance::kConstantFunction) {
    empty_ = empty_ || function(size_) > tolerance::kZeroFunction;
    return;
  }
  for (Eigen::Index j = 0; j < size_; ++j) rows_.push_back(function(j) / length);
  rows_.push_back(-function(size_) / length);
  ++count_;
}

bool LoopCell::enter() {
  if (empty_) return false;
  double radius = 0.0;
  return solver_.chebyshevInBox(rows_.data(), count_, interior_.data(), radius) &&
         radius > tolerance::kFaceOfOthers;
}

Eigen::VectorXd LoopCell::greatest(const Eigen::RowVectorXd& function) {
  Eigen::VectorXd point = interior_, direction = function.head(size_).transpose();
  const double length = direction.norm();
  if (length <= tolerance::kConstantFunction) return interior_;
  direction /= length;
  if (!solver_.support(rows_.data(), count_, interior_.data(), direction.data(), point.data()))
    return interior_;
  return point;
}

}  // namespace polyfly
