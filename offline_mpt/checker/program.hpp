#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>

#include "rows.hpp"

/// The program that a proof is about, as its lines give it.
namespace checker {

struct Matrix {
  std::size_t rows = 0, columns = 0;
  Vector entries;
  const Fraction& at(std::size_t i, std::size_t j) const { return entries[i * columns + j]; }
};

/// The rest of a line: rows, columns, entries.
Matrix readMatrix(Line& line, const std::string& key);

/// There are the matrices of a program of n variables, m rows, p parameters and q outputs, and no others.
void requireSizes(const std::map<std::string, Matrix>& data, std::size_t n, std::size_t m, std::size_t p,
                  std::size_t q);

/// Compares every number with those of a JSON problem.
void compareNumbers(const std::string& problem, const std::function<const Matrix&(const std::string&)>& given,
                    const std::set<std::size_t>& equalities);

}  // namespace checker
