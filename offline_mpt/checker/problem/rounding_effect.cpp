#include "problem/rounding_effect.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/text.hpp"

namespace checker {
namespace {

/// At least the root.
Fraction rootAbove(const Fraction& square) {
  constexpr double kUp = 1.0 + 0x1p-40;
  return square == 0 ? Fraction() : Fraction(std::sqrt(square.get_d() * kUp) * kUp);
}

/// (M, v)
BallMatrix besides(const Matrix& M, const Matrix& v) {
  BallMatrix result(M.rows, M.columns + 1);
  result.setBlock(0, 0, BallMatrix(M));
  result.setBlock(0, M.columns, BallMatrix(v));
  return result;
}

}  // namespace

RoundingEffect::RoundingEffect(const Matrices& program, const Ranges& parameters, const Ranges& inputs,
                               std::size_t moves)
    : program_(program), inputs_(inputs), moves_(moves), n_(program.at("H").rows), p_(parameters.size()) {
  inverse_ = solved(BallMatrix(program.at("H")), BallMatrix::identity(n_));
  for (const auto& [lower, upper] : parameters)
    theta_.emplace_back(std::max(std::abs(lower), std::abs(upper)));
  theta_.emplace_back(1);
  const BallMatrix free = inverse_ * besides(program.at("F"), program.at("f"));
  for (std::size_t i = 0; i < n_; ++i) {
    free_.emplace_back();
    for (std::size_t j = 0; j <= p_; ++j) free_.back() += free.at(i, j).greatest() * theta_[j];
  }
  boundVariables();
}

void RoundingEffect::boundVariables() {
  const Matrix& A = program_.at("A");
  std::vector<std::optional<Fraction>> above(n_), below(n_);
  for (std::size_t i = 0; i < A.rows; ++i) {
    std::size_t used = 0, at = 0;
    for (std::size_t j = 0; j < n_; ++j) {
      if (A.at(i, j) == 0) continue;
      ++used;
      at = j;
    }
    if (used != 1) continue;
    Fraction bound = abs(program_.at("b").at(i, 0));
    for (std::size_t j = 0; j < p_; ++j) bound += abs(program_.at("S").at(i, j)) * theta_[j];
    bound /= abs(A.at(i, at));
    std::optional<Fraction>& side = (A.at(i, at) > 0 ? above : below)[at];
    if (!side || bound < *side) side = bound;
  }
  for (std::size_t j = 0; j < n_; ++j) {
    const auto& [lower, upper] = inputs_[j % inputs_.size()];
    const Fraction range = j < moves_ && std::isfinite(upper - lower) ? Fraction(upper - lower) : Fraction();
    z_.push_back(above[j] && below[j] ? std::max(*above[j], *below[j]) : std::max(free_[j], range));
  }
}

/// In the norm of H^-1.
Fraction RoundingEffect::lengthOf(const Vector& vector) const {
  Fraction square;
  for (std::size_t i = 0; i < n_; ++i) {
    Ball sum;
    for (std::size_t j = 0; j < n_ && vector[i] != 0; ++j) {
      if (vector[j] != 0) sum += inverse_.at(i, j) * Ball(vector[j]);
    }
    square += (Ball(vector[i]) * sum).upper();
  }
  return rootAbove(std::max(square, Fraction()));
}

void RoundingEffect::addCost(const ExpectedProgram& expected) {
  const auto add = [this](const BallMatrix& difference, const Vector& greatest) {
    for (std::size_t j = 0; j < difference.columns(); ++j) {
      Vector column;
      for (std::size_t i = 0; i < n_; ++i) column.push_back(difference.at(i, j).upper());
      cost_ += lengthOf(column) * greatest[j];
    }
  };
  add(expected.H - BallMatrix(program_.at("H")), z_);
  add(expected.F - besides(program_.at("F"), program_.at("f")), theta_);
}

void RoundingEffect::addRow(const Vector& row, const Vector& on_z, const Vector& on_theta,
                            const Fraction& bound) {
  Fraction moved = bound;
  for (std::size_t j = 0; j < n_; ++j) moved += on_z[j] * z_[j];
  for (std::size_t j = 0; j < p_; ++j) moved += on_theta[j] * theta_[j];
  if (moved == 0) return;
  // At most the squared length.
  Ball minus;
  for (std::size_t i = 0; i < n_; ++i) {
    for (std::size_t j = 0; j < n_ && row[i] != 0; ++j) minus -= inverse_.at(i, j) * Ball(row[i] * row[j]);
  }
  const Fraction square = -minus.upper();
  // A row without z bounds theta alone.
  if (square > 0) row_ = std::max(row_, Fraction(moved * rootAbove(Fraction(1 / square))));
}

Fraction RoundingEffect::ofInputs(const BallMatrix& C) const {
  const BallMatrix difference = C - besides(program_.at("C"), program_.at("c"));
  Fraction greatest;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    Fraction change = rootAbove(inverse_.at(i, i).upper()) * (cost_ + row_), size = free_[i];
    for (std::size_t j = 0; j <= p_; ++j) {
      change += difference.at(i, j).greatest() * theta_[j];
      size += C.at(i, j).greatest() * theta_[j];
    }
    const double range = inputs_[i].second - inputs_[i].first;
    if (std::isfinite(range)) size = Fraction(range);
    if (change > 0) greatest = std::max(greatest, Fraction(change / size));
  }
  return greatest;
}

}  // namespace checker
