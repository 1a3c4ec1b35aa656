#pragma once

#include <utility>
#include <vector>

#include "certify/farkas_proof.hpp"

/// Weights of proofs: from floating point, or from square systems of equations, to whole numbers.
namespace polyfly {

using ExactRows = std::vector<const ExactRow*>;

/// Of the greatest entry of all.
std::size_t mostBits(const ExactRows& rows, const ExactRow* other);

/// sum -= weight * (row << shift)
void subtract(std::vector<Integer>& sum, const Integer& weight, const ExactRow& row, std::size_t shift);

/// Least value in the box.
Integer least(const std::vector<Integer>& affine);

/// value * 2^exponent without its fraction, of a finite value and any exponent.
Integer toInteger(double value, long exponent);

/// Rounds floating-point weights, given for rows of unit length, to whole ones. With `bits` in the greatest.
/// No weights where one of them overflows.
FarkasProof roundWeights(const std::vector<std::pair<int, double>>& weights, const ExactRows& rows,
                         double target_length, int bits);

/// Whole weights from fractions that hold for the rows as they are, not in unit form.
FarkasProof clearFractions(std::vector<std::pair<int, Rational>> weights, const ExactRows& rows,
                           std::size_t bits, std::size_t target_bits);

/// Solves sum of weight * row = target exactly, constants and the coordinates of `skip` apart. False where
/// the rows are dependent; whether the equations that are not needed hold is for the caller to see.
bool combineExactly(const ExactRows& rows, const ExactRow& target, const std::vector<char>& skip,
                    std::vector<Rational>& weights);

/// The rows with a weight that counts, and the coordinates whose sides of the box have one. `first_box` is
/// the index of the first side.
ExactRows rowsOfWeights(const std::vector<std::pair<int, double>>& weights, const ExactRows& rows,
                        int first_box, std::vector<char>& skip, std::vector<int>& places);

}  // namespace polyfly
