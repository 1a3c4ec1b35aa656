#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "lookup_tables.hpp"

/// Look-ups of exported code at single parameters, in the arithmetic of the code without contracted multiply-adds.
namespace checker {

/// Operations of one look-up.
struct LookupWork {
  /// Sums of p products: the half-spaces of nodes, those of the rows that candidates test, and the rows of the law.
  std::uint64_t sums = 0;
  /// Two for each parameter, one for each node, one for each row and candidate. Where the candidate with the least
  /// violation is taken, two for each row and four for each candidate.
  std::uint64_t comparisons = 0;
};

/// Of each kind, the sum, and the greater number.
LookupWork sum(const LookupWork& a, const LookupWork& b);
LookupWork greater(const LookupWork& a, const LookupWork& b);

constexpr LookupWork kNodeWork = {1, 1};

inline LookupWork lawWork(const LookupTables& code) { return {code.q, 0}; }

constexpr LookupWork candidateWork(const LookupTables& code, std::uint64_t rows) {
  return {rows, code.takes_first ? rows + 1 : 2 * rows + 4};
}

/// a . theta - c as two sums: the code adds them last. Number has the code's arithmetic.
template <class Number>
class PlaneSum {
 public:
  /// theta has p numbers that outlive the object.
  explicit PlaneSum(const std::vector<Number>& theta) : theta_(theta) {}

  std::pair<Number, Number> parts(const double* plane) const {
    const std::size_t p = theta_.size();
    if (p <= kMostByHalves) {
      const std::size_t middle = (p + 2) / 2;
      return {byHalves(plane, 0, middle), byHalves(plane, middle, p + 1)};
    }
    Number rest(0.0);
    for (std::size_t i = 0; i < p; ++i) rest = rest + term(plane, i);
    return {rest, term(plane, p)};
  }

 private:
  /// Up to so many parameters, the code adds by halves.
  static constexpr std::size_t kMostByHalves = 8;

  Number term(const double* plane, std::size_t i) const {
    return i < theta_.size() ? Number(plane[i]) * theta_[i] : Number(-plane[i]);
  }

  Number byHalves(const double* plane, std::size_t first, std::size_t end) const {
    if (end - first == 1) return term(plane, first);
    const std::size_t middle = (first + end + 1) / 2;
    return byHalves(plane, first, middle) + byHalves(plane, middle, end);
  }

  const std::vector<Number>& theta_;
};

/// The numbers of the code's type that are nearest to theta, in the code's box.
std::vector<double> givenNumbers(const ExportedCode& code, std::vector<double> theta);

/// The value of a plane at a theta of given numbers.
double valueAt(const ExportedCode& code, std::uint32_t plane, const std::vector<double>& theta);

/// The operations at a theta of given numbers.
LookupWork workAt(const ExportedCode& code, const std::vector<double>& theta);

}  // namespace checker
