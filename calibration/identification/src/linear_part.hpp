#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/loop_response.hpp"

namespace polyfly {

/// Loss of Huber: squares up to `kHuberReach` scales, straight beyond.
constexpr double kHuberReach = 2.0;

/// All samples of all segments in one row, and the part of the model that is linear.
/// Unknowns: gain, offset, then the initial states of each segment.
class LinearPart {
 public:
  explicit LinearPart(const std::vector<LoopSegment>& segments);

  /// The basis of all segments for one shape.
  void setShape(const LoopShape& shape);

  /// Least loss for the given scale by reweighting; the first solution is that of least squares. Gain and
  /// offset are held if `held` is given. Returns the loss in units of scale squared.
  double solve(double scale, int rounds, const Eigen::Vector2d* held = nullptr);

  Eigen::Index samples() const { return response_.size(); }
  const Eigen::VectorXd& response() const { return response_; }
  const Eigen::VectorXd& coefficients() const { return coefficients_; }
  const Eigen::VectorXd& model() const { return model_; }
  Eigen::VectorXd residuals() const { return response_ - model_; }

  /// One column for each unknown.
  Eigen::MatrixXd columns() const;

  /// First sample of each segment, and the number of samples at the end.
  const std::vector<Eigen::Index>& starts() const { return starts_; }

 private:
  void solveWeighted(const Eigen::VectorXd& weights, const Eigen::Vector2d* held);
  Eigen::Index states() const { return static_cast<Eigen::Index>(free_.size()); }

  const std::vector<LoopSegment>& segments_;
  std::vector<Eigen::Index> starts_;
  Eigen::VectorXd response_;
  Eigen::VectorXd forced_;
  // Response of each initial state, all segments in one row.
  std::vector<Eigen::VectorXd> free_;
  Eigen::VectorXd coefficients_;
  Eigen::VectorXd model_;
};

/// Robust standard deviation: 1.4826 times the median of the absolute values.
double robustScale(const Eigen::VectorXd& residuals);

}  // namespace polyfly
