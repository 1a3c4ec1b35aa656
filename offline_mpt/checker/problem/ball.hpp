#pragma once

#include <vector>

#include "core/program.hpp"

/// Real numbers in fixed point with a bound of their error, and matrices of them.
namespace checker {

/// A number that differs from `value` by at most `radius`, both in units of 2^-kBits.
class Ball {
 public:
  static constexpr unsigned long kBits = 512;

  Ball() = default;
  explicit Ball(const mpq_class& exact);

  Ball operator-() const;
  friend Ball operator+(const Ball& a, const Ball& b);
  friend Ball operator-(const Ball& a, const Ball& b) { return a + -b; }
  friend Ball operator*(const Ball& a, const Ball& b);
  /// Throws Refused where b may be zero.
  friend Ball operator/(const Ball& a, const Ball& b);
  Ball& operator+=(const Ball& other) { return *this = *this + other; }
  Ball& operator-=(const Ball& other) { return *this = *this - other; }

  /// The number with an error that is greater by this.
  Ball widened(const mpq_class& by) const;
  /// The same number without an error, to go on with as an approximation.
  Ball middle() const;
  /// At least the number.
  mpq_class upper() const;
  /// The absolute value.
  Ball magnitude() const;
  /// At least the absolute value.
  mpq_class greatest() const;
  /// At least the distance from an exact number.
  mpq_class distance(const mpq_class& exact) const { return (*this - Ball(exact)).greatest(); }
  /// Whether the absolute value of the middle is smaller.
  bool isSmaller(const Ball& other) const { return cmp(abs(value_), abs(other.value_)) < 0; }

 private:
  mpz_class value_ = 0, radius_ = 0;
};

class BallMatrix {
 public:
  BallMatrix() = default;
  BallMatrix(std::size_t rows, std::size_t columns)
      : rows_(rows), columns_(columns), entries_(rows * columns) {}
  explicit BallMatrix(const Matrix& exact);
  static BallMatrix identity(std::size_t size);

  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return columns_; }
  Ball& at(std::size_t i, std::size_t j) { return entries_[i * columns_ + j]; }
  const Ball& at(std::size_t i, std::size_t j) const { return entries_[i * columns_ + j]; }

  friend BallMatrix operator+(const BallMatrix& a, const BallMatrix& b);
  friend BallMatrix operator-(const BallMatrix& a, const BallMatrix& b);
  friend BallMatrix operator*(const BallMatrix& a, const BallMatrix& b);
  BallMatrix transposed() const;
  BallMatrix block(std::size_t row, std::size_t column, std::size_t rows, std::size_t columns) const;
  void setBlock(std::size_t row, std::size_t column, const BallMatrix& block);
  BallMatrix scaled(const mpq_class& factor) const;
  BallMatrix widened(const mpq_class& by) const;
  BallMatrix magnitudes() const;
  /// Approximation: all entries without their errors.
  BallMatrix middle() const;
  /// At least the greatest absolute value.
  mpq_class greatest() const;
  /// At least the greatest sum of absolute values of a row.
  mpq_class norm() const;

 private:
  template <class Change>
  BallMatrix changed(const Change& change) const {
    BallMatrix result = *this;
    for (Ball& entry : result.entries_) entry = change(entry);
    return result;
  }

  std::size_t rows_ = 0, columns_ = 0;
  std::vector<Ball> entries_;
};

/// A^-1 B. Throws Refused where A may be singular.
BallMatrix solved(BallMatrix A, BallMatrix B);

}  // namespace checker
