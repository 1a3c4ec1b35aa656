// The kernels of the bounded QP: against Eigen, and bit for bit between processors.
#include "mpc_core/qp_kernels.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "random_matrices.hpp"

namespace polyfly {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// All that the kernels make of one matrix, with the factor checked against Eigen's.
std::vector<double> kernelResults(const QpKernels& kernels, int n, const Eigen::MatrixXd& H) {
  Eigen::MatrixXd factor = H;
  std::vector<double> blocks(static_cast<std::size_t>(n / kPack * kBlockInverse));
  EXPECT_EQ(kernels.factorise(factor.data(), n, n, 1e-15, blocks.data(), 0), n);
  const Eigen::MatrixXd lower = factor.triangularView<Eigen::Lower>();
  EXPECT_LT((lower * lower.transpose() - H).cwiseAbs().maxCoeff(), 1e-10 * H.cwiseAbs().maxCoeff());
  Eigen::VectorXd x = H.col(0), sums = H.col(1), gradient = H.col(n - 1);
  kernels.solveLower(factor.data(), blocks.data(), n, n, x.data());
  kernels.solveUpper(factor.data(), blocks.data(), n, n, x.data());
  EXPECT_LT((x - Eigen::VectorXd::Unit(n, 0)).cwiseAbs().maxCoeff(), 1e-8);
  kernels.addColumns(H.data(), n, n, nullptr, n, gradient.data(), sums.data());
  kernels.addMultiple(n, 0.3, x.data(), sums.data());
  sums(0) += kernels.dot(n, sums.data(), H.data());
  const Eigen::VectorXd lower_bound = Eigen::VectorXd::Constant(n, -0.1), upper_bound = -lower_bound;
  kernels.sweep(H.data(), n, n, n, lower_bound.data(), upper_bound.data(), gradient.data(), x.data());
  std::vector<double> results(blocks);
  for (const Eigen::VectorXd& vector : {x, sums, gradient}) {
    results.insert(results.end(), vector.data(), vector.data() + n);
  }
  results.insert(results.end(), lower.data(), lower.data() + lower.size());
  return results;
}

TEST(QpKernels, GiveTheSameBitsOnEveryProcessor) {
  std::mt19937_64 random(10);
  for (int n = kPack; n <= 64; n += kPack) {
    const Eigen::MatrixXd H = positiveDefinite(n, random);
    EXPECT_EQ(kernelResults(qpKernels(), n, H), kernelResults(plainQpKernels(), n, H)) << n;
  }
}

TEST(QpKernels, AddColumnsAsTheProductSays) {
  std::mt19937_64 random(12);
  const std::vector<int> chosen{3, 0, 2};
  for (int n = kPack; n <= 80; n += kPack) {
    const Eigen::MatrixXd M = gaussian(n, n, random);
    const Eigen::VectorXd x = gaussian(n, 1, random), y = gaussian(n, 1, random);
    for (const QpKernels* kernels : {&qpKernels(), &plainQpKernels()}) {
      Eigen::VectorXd all = y, some = y;
      kernels->addColumns(M.data(), n, n, nullptr, n, x.data(), all.data());
      EXPECT_LT((all - (y + M * x)).cwiseAbs().maxCoeff(), 1e-12) << n;
      kernels->addColumns(M.data(), n, n, chosen.data(), 3, x.data(), some.data());
      const Eigen::VectorXd expected = y + x(0) * M.col(3) + x(1) * M.col(0) + x(2) * M.col(2);
      EXPECT_LT((some - expected).cwiseAbs().maxCoeff(), 1e-12) << n;
    }
  }
}

TEST(QpKernels, TheGreatestMagnitudeTellsOfWhatIsNotFinite) {
  constexpr int kSize = 12;
  for (const QpKernels* kernels : {&qpKernels(), &plainQpKernels()}) {
    EXPECT_EQ(kernels->greatest(0, nullptr), 0.0);
    for (int i = 0; i < kSize; ++i) {
      std::vector<double> x(kSize, 0.5);
      for (const double value : {2.0, -3.0}) {
        x[static_cast<std::size_t>(i)] = value;
        EXPECT_EQ(kernels->greatest(kSize, x.data()), std::abs(value)) << i;
      }
      for (const double value : {kInfinity, -kInfinity, std::nan("")}) {
        x[static_cast<std::size_t>(i)] = value;
        EXPECT_FALSE(std::isfinite(kernels->greatest(kSize, x.data()))) << i;
      }
    }
  }
}

// As a working set grows, its factor does.
TEST(QpKernels, AFactorThatGrowsHasTheSameBits) {
  std::mt19937_64 random(11);
  constexpr int kSize = 32;
  const Eigen::MatrixXd H = positiveDefinite(kSize, random);
  const Eigen::MatrixXd whole = [&] {
    Eigen::MatrixXd factor = H;
    std::vector<double> blocks(kSize / kPack * kBlockInverse);
    EXPECT_EQ(qpKernels().factorise(factor.data(), kSize, kSize, 1e-15, blocks.data(), 0), kSize);
    return Eigen::MatrixXd(factor.triangularView<Eigen::Lower>());
  }();
  for (int done = kPack; done <= kSize; done += kPack) {
    Eigen::MatrixXd factor = H;
    std::vector<double> blocks(kSize / kPack * kBlockInverse);
    EXPECT_EQ(qpKernels().factorise(factor.data(), done, kSize, 1e-15, blocks.data(), 0), done);
    EXPECT_EQ(qpKernels().factorise(factor.data(), kSize, kSize, 1e-15, blocks.data(), done), kSize);
    EXPECT_TRUE(Eigen::MatrixXd(factor.triangularView<Eigen::Lower>()) == whole) << done;
  }
}

}  // namespace
}  // namespace polyfly
