#include "problem/ball.hpp"

#include <algorithm>
#include <utility>

#include "core/text.hpp"

namespace checker {
namespace {

mpz_class roundedUp(const mpz_class& numerator, const mpz_class& denominator) {
  mpz_class result;
  mpz_cdiv_q(result.get_mpz_t(), numerator.get_mpz_t(), denominator.get_mpz_t());
  return result;
}

}  // namespace

Ball::Ball(const mpq_class& exact) {
  const mpz_class scaled = exact.get_num() << kBits;
  mpz_fdiv_q(value_.get_mpz_t(), scaled.get_mpz_t(), exact.get_den_mpz_t());
  radius_ = value_ * exact.get_den() == scaled ? 0 : 1;
}

Ball Ball::operator-() const {
  Ball result = *this;
  result.value_ = -value_;
  return result;
}

Ball operator+(const Ball& a, const Ball& b) {
  Ball result;
  result.value_ = a.value_ + b.value_;
  result.radius_ = a.radius_ + b.radius_;
  return result;
}

Ball operator*(const Ball& a, const Ball& b) {
  Ball result;
  result.value_ = (a.value_ * b.value_) >> Ball::kBits;
  const mpz_class error = abs(a.value_) * b.radius_ + abs(b.value_) * a.radius_ + a.radius_ * b.radius_;
  // One for the value that was rounded down, one for the error's own rounding.
  result.radius_ = (error >> Ball::kBits) + 2;
  return result;
}

Ball operator/(const Ball& a, const Ball& b) {
  const mpz_class least = abs(b.value_) - b.radius_;
  require(least > 0, "a division by what may be zero");
  Ball result;
  const mpz_class scaled = a.value_ << Ball::kBits;
  mpz_fdiv_q(result.value_.get_mpz_t(), scaled.get_mpz_t(), b.value_.get_mpz_t());
  // |a / b - quotient| <= (error of a + |quotient| * error of b) / least, plus one for rounding.
  const mpz_class error = (a.radius_ << Ball::kBits) + (abs(result.value_) + 1) * b.radius_;
  result.radius_ = roundedUp(error, least) + 1;
  return result;
}

Ball Ball::widened(const mpq_class& by) const {
  Ball result = *this;
  result.radius_ += roundedUp(by.get_num() << kBits, by.get_den());
  return result;
}

Ball Ball::middle() const {
  Ball result = *this;
  result.radius_ = 0;
  return result;
}

mpq_class Ball::upper() const {
  mpq_class result(value_ + radius_, mpz_class(1) << kBits);
  result.canonicalize();
  return result;
}

Ball Ball::magnitude() const {
  Ball result = *this;
  result.value_ = abs(value_);
  return result;
}

mpq_class Ball::greatest() const { return magnitude().upper(); }

BallMatrix::BallMatrix(const Matrix& exact)
    : rows_(exact.rows), columns_(exact.columns), entries_(exact.entries.begin(), exact.entries.end()) {}

BallMatrix BallMatrix::identity(std::size_t size) {
  BallMatrix result(size, size);
  for (std::size_t i = 0; i < size; ++i) result.at(i, i) = Ball(1);
  return result;
}

BallMatrix operator+(const BallMatrix& a, const BallMatrix& b) {
  BallMatrix result = a;
  for (std::size_t k = 0; k < result.entries_.size(); ++k) result.entries_[k] += b.entries_[k];
  return result;
}

BallMatrix operator-(const BallMatrix& a, const BallMatrix& b) {
  BallMatrix result = a;
  for (std::size_t k = 0; k < result.entries_.size(); ++k) result.entries_[k] -= b.entries_[k];
  return result;
}

BallMatrix operator*(const BallMatrix& a, const BallMatrix& b) {
  BallMatrix result(a.rows_, b.columns_);
  for (std::size_t i = 0; i < a.rows_; ++i) {
    for (std::size_t k = 0; k < a.columns_; ++k) {
      for (std::size_t j = 0; j < b.columns_; ++j) result.at(i, j) += a.at(i, k) * b.at(k, j);
    }
  }
  return result;
}

BallMatrix BallMatrix::transposed() const {
  BallMatrix result(columns_, rows_);
  for (std::size_t i = 0; i < rows_; ++i) {
    for (std::size_t j = 0; j < columns_; ++j) result.at(j, i) = at(i, j);
  }
  return result;
}

BallMatrix BallMatrix::block(std::size_t row, std::size_t column, std::size_t rows,
                             std::size_t columns) const {
  BallMatrix result(rows, columns);
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) result.at(i, j) = at(row + i, column + j);
  }
  return result;
}

void BallMatrix::setBlock(std::size_t row, std::size_t column, const BallMatrix& block) {
  for (std::size_t i = 0; i < block.rows_; ++i) {
    for (std::size_t j = 0; j < block.columns_; ++j) at(row + i, column + j) = block.at(i, j);
  }
}

BallMatrix BallMatrix::scaled(const mpq_class& factor) const {
  const Ball ball(factor);
  return changed([&](const Ball& entry) { return entry * ball; });
}

BallMatrix BallMatrix::widened(const mpq_class& by) const {
  return changed([&](const Ball& entry) { return entry.widened(by); });
}

BallMatrix BallMatrix::magnitudes() const {
  return changed([](const Ball& entry) { return entry.magnitude(); });
}

BallMatrix BallMatrix::middle() const {
  return changed([](const Ball& entry) { return entry.middle(); });
}

mpq_class BallMatrix::greatest() const {
  mpq_class result;
  for (const Ball& entry : entries_) result = std::max(result, entry.greatest());
  return result;
}

mpq_class BallMatrix::norm() const {
  mpq_class result;
  for (std::size_t i = 0; i < rows_; ++i) {
    mpq_class sum;
    for (std::size_t j = 0; j < columns_; ++j) sum += at(i, j).greatest();
    result = std::max(result, sum);
  }
  return result;
}

BallMatrix solved(BallMatrix A, BallMatrix B) {
  const std::size_t size = A.rows();
  for (std::size_t k = 0; k < size; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < size; ++i) {
      if (A.at(pivot, k).isSmaller(A.at(i, k))) pivot = i;
    }
    for (std::size_t j = 0; j < size; ++j) std::swap(A.at(k, j), A.at(pivot, j));
    for (std::size_t j = 0; j < B.columns(); ++j) std::swap(B.at(k, j), B.at(pivot, j));
    for (std::size_t i = 0; i < size; ++i) {
      if (i == k) continue;
      const Ball factor = A.at(i, k) / A.at(k, k);
      for (std::size_t j = k; j < size; ++j) A.at(i, j) -= factor * A.at(k, j);
      for (std::size_t j = 0; j < B.columns(); ++j) B.at(i, j) -= factor * B.at(k, j);
    }
  }
  for (std::size_t k = 0; k < size; ++k) {
    for (std::size_t j = 0; j < B.columns(); ++j) B.at(k, j) = B.at(k, j) / A.at(k, k);
  }
  return B;
}

}  // namespace checker
