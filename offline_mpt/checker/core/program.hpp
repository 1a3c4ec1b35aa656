#pragma once

#include <map>
#include <string>

#include "core/rows.hpp"

/// The program that a proof is about, as its lines give it.
namespace checker {

struct Matrix {
  std::size_t rows = 0, columns = 0;
  Vector entries;
  const Fraction& at(std::size_t i, std::size_t j) const { return entries[i * columns + j]; }
};

/// box, H, f, F, A, b, S, A_theta, b_theta, E, C, c (offline_mpt/CERTIFICATE.md).
using Matrices = std::map<std::string, Matrix>;

/// The rest of a line: rows, columns, entries.
Matrix readMatrix(Line& line, const std::string& key);

/// There are the matrices of a program of n variables, m rows, p parameters and q outputs, and no others.
void requireSizes(const Matrices& data, std::size_t n, std::size_t m, std::size_t p, std::size_t q);

}  // namespace checker
