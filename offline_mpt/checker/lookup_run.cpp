#include "lookup_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace checker {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Number>
double valueOf(const LookupTables& code, std::uint32_t plane, const std::vector<double>& theta) {
  // The numbers are of this type already.
  std::vector<Number> numbers;
  for (const double value : theta) numbers.push_back(static_cast<Number>(value));
  const auto [first, last] =
      PlaneSum<Number>(numbers).parts(code.planes.data() + std::size_t{plane} * (code.p + 1));
  return static_cast<double>(first + last);
}

}  // namespace

LookupWork sum(const LookupWork& a, const LookupWork& b) {
  return {a.sums + b.sums, a.comparisons + b.comparisons};
}

LookupWork greater(const LookupWork& a, const LookupWork& b) {
  return {std::max(a.sums, b.sums), std::max(a.comparisons, b.comparisons)};
}

std::vector<double> givenNumbers(const ExportedCode& code, std::vector<double> theta) {
  const LookupTables& tables = code.tables;
  for (std::size_t i = 0; i < theta.size(); ++i) {
    if (code.type == CodeType::kFloat) theta[i] = static_cast<float>(theta[i]);
    theta[i] = std::clamp(theta[i], tables.box.lower[i], tables.box.upper[i]);
  }
  return theta;
}

double valueAt(const ExportedCode& code, std::uint32_t plane, const std::vector<double>& theta) {
  return code.type == CodeType::kFloat ? valueOf<float>(code.tables, plane, theta)
                                       : valueOf<double>(code.tables, plane, theta);
}

LookupWork workAt(const ExportedCode& exported, const std::vector<double>& theta) {
  const LookupTables& code = exported.tables;
  LookupWork work = {0, 2 * code.p};
  std::uint32_t child = code.root();
  while (child < code.node_plane.size()) {
    work = sum(work, kNodeWork);
    child = code.children[child][valueAt(exported, code.node_plane[child], theta) <= 0.0 ? 0 : 1];
  }
  double least = kInfinity;
  bool has_answer = false;
  for (const LookupTables::Candidate& candidate : code.leaves[child - code.node_plane.size()]) {
    double greatest = -kInfinity;
    std::uint64_t tested = 0;
    while (tested < candidate.rows.size() && greatest < kInfinity) {
      const std::uint32_t row = candidate.rows[tested++];
      const double value = valueAt(exported, row / 2, theta);
      const double violation = row % 2 == 0 ? value : -value;
      greatest = violation <= code.tolerance ? std::max(greatest, violation) : kInfinity;
    }
    work = sum(work, candidateWork(code, tested));
    has_answer = has_answer || greatest < kInfinity;
    if (code.takes_first && has_answer) break;
    if (candidate.is_fallback) greatest = std::max(greatest, 0.0) + code.handicap;
    least = std::min(least, greatest);
    if (least <= 0.0) break;
  }
  return has_answer ? sum(work, lawWork(code)) : work;
}

}  // namespace checker
