#include "linear_part.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "polyfly_base/quantile.hpp"

namespace polyfly {
namespace {

// Ratio of standard deviation to median absolute value, for a normal distribution.
constexpr double kMedianToDeviation = 1.4826;
// Relative ridge. It separates unknowns that no sample tells apart.
constexpr double kRidge = 1e-12;

double huberLoss(const Eigen::VectorXd& residuals, double scale) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < residuals.size(); ++i) {
    const double size = std::abs(residuals[i]) / scale;
    sum += size <= kHuberReach ? 0.5 * size * size : kHuberReach * (size - 0.5 * kHuberReach);
  }
  return sum;
}

Eigen::VectorXd huberWeights(const Eigen::VectorXd& residuals, double scale) {
  return residuals.unaryExpr([scale](double residual) {
    const double size = std::abs(residual) / scale;
    return size <= kHuberReach ? 1.0 : kHuberReach / size;
  });
}

}  // namespace

LinearPart::LinearPart(const std::vector<LoopSegment>& segments) : segments_(segments) {
  starts_.push_back(0);
  for (const LoopSegment& segment : segments) {
    starts_.push_back(starts_.back() + static_cast<Eigen::Index>(segment.time.size()));
  }
  response_.resize(starts_.back());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    response_.segment(starts_[i], starts_[i + 1] - starts_[i]) = Eigen::Map<const Eigen::VectorXd>(
        segments[i].response.data(), static_cast<Eigen::Index>(segments[i].response.size()));
  }
}

void LinearPart::setShape(const LoopShape& shape) {
  const std::size_t states = shape.order == LoopOrder::kFirst ? 1 : 2;
  forced_.resize(samples());
  free_.assign(states, Eigen::VectorXd(samples()));
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    const LoopBasis basis = loopBasis(shape, segments_[i]);
    const Eigen::Index count = starts_[i + 1] - starts_[i];
    forced_.segment(starts_[i], count) = Eigen::Map<const Eigen::VectorXd>(basis.forced.data(), count);
    for (std::size_t k = 0; k < states; ++k) {
      free_[k].segment(starts_[i], count) = Eigen::Map<const Eigen::VectorXd>(basis.free[k].data(), count);
    }
  }
}

// Normal equations; the initial states of a segment meet no others but gain and offset.
void LinearPart::solveWeighted(const Eigen::VectorXd& weights, const Eigen::Vector2d* held) {
  const auto segments = static_cast<Eigen::Index>(segments_.size());
  const Eigen::Index unknowns = 2 + states() * segments;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
  for (Eigen::Index i = 0; i < segments; ++i) {
    const Eigen::Index from = starts_[static_cast<std::size_t>(i)];
    const Eigen::Index count = starts_[static_cast<std::size_t>(i) + 1] - from;
    Eigen::MatrixXd block(count, 2 + states());
    block.col(0) = forced_.segment(from, count);
    block.col(1).setOnes();
    for (Eigen::Index k = 0; k < states(); ++k) {
      block.col(2 + k) = free_[static_cast<std::size_t>(k)].segment(from, count);
    }
    const Eigen::MatrixXd weighted = weights.segment(from, count).asDiagonal() * block;
    const Eigen::MatrixXd square = weighted.transpose() * block;
    const Eigen::VectorXd product = weighted.transpose() * response_.segment(from, count);
    const Eigen::Index own = 2 + states() * i;
    normal.topLeftCorner(2, 2) += square.topLeftCorner(2, 2);
    normal.block(0, own, 2, states()) = square.topRightCorner(2, states());
    normal.block(own, 0, states(), 2) = square.bottomLeftCorner(states(), 2);
    normal.block(own, own, states(), states()) = square.bottomRightCorner(states(), states());
    right.head(2) += product.head(2);
    right.segment(own, states()) = product.tail(states());
  }
  if (held != nullptr) {
    right -= normal.leftCols(2) * *held;
    normal.topRows(2).setZero();
    normal.leftCols(2).setZero();
    normal.topLeftCorner(2, 2).setIdentity();
    right.head(2) = *held;
  }
  normal.diagonal() += kRidge * normal.diagonal();
  coefficients_ = normal.ldlt().solve(right);
  model_ = coefficients_[0] * forced_;
  model_.array() += coefficients_[1];
  for (Eigen::Index i = 0; i < segments; ++i) {
    const Eigen::Index from = starts_[static_cast<std::size_t>(i)];
    const Eigen::Index count = starts_[static_cast<std::size_t>(i) + 1] - from;
    for (Eigen::Index k = 0; k < states(); ++k) {
      model_.segment(from, count) +=
          coefficients_[2 + states() * i + k] * free_[static_cast<std::size_t>(k)].segment(from, count);
    }
  }
}

double LinearPart::solve(double scale, int rounds, const Eigen::Vector2d* held) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(samples());
  solveWeighted(weights, held);
  for (int round = 0; round < rounds; ++round) {
    weights = huberWeights(residuals(), scale);
    if (weights.minCoeff() >= 1.0) break;
    solveWeighted(weights, held);
  }
  return huberLoss(residuals(), scale);
}

Eigen::MatrixXd LinearPart::columns() const {
  const auto segments = static_cast<Eigen::Index>(segments_.size());
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(samples(), 2 + states() * segments);
  all.col(0) = forced_;
  all.col(1).setOnes();
  for (Eigen::Index i = 0; i < segments; ++i) {
    const Eigen::Index from = starts_[static_cast<std::size_t>(i)];
    const Eigen::Index count = starts_[static_cast<std::size_t>(i) + 1] - from;
    for (Eigen::Index k = 0; k < states(); ++k) {
      all.col(2 + states() * i + k).segment(from, count) =
          free_[static_cast<std::size_t>(k)].segment(from, count);
    }
  }
  return all;
}

double robustScale(const Eigen::VectorXd& residuals) {
  const Eigen::VectorXd sizes = residuals.cwiseAbs();
  return kMedianToDeviation * quantileOf({sizes.data(), sizes.data() + sizes.size()});
}

}  // namespace polyfly
