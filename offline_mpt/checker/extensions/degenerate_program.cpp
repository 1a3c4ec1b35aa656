// Equalities that depend on each other or hold only together, and rows that others imply up to rounding.
#include <algorithm>
#include <utility>

#include "extensions/extended_certificate.hpp"

namespace checker {
namespace {

constexpr unsigned long kDroppedBits = 30, kToleratedBits = 40;

/// slack >= - (2^-bits of the size of its inequality).
Row within(const Slack& slack, int sign, unsigned long bits) {
  Row row = slack.value;
  for (Integer& value : row) value = sign * (value << bits);
  row.back() += slack.size;
  return primitive(row);
}

}  // namespace

void ExtendedCertificate::finish() {
  require(dropped_.empty() || *dropped_.rbegin() < m_, "no such row");
  const Vector& H = data("H").entries;
  const bool is_zero = std::all_of(H.begin(), H.end(), [](const Fraction& entry) { return entry == 0; });
  require(is_zero == isLinear(), "convexity: H is zero, or is not");
  require(weights_.empty() || (is_zero && weights_.size() == n_), "weights do not fit the program");
}

/// Equalities, and inequalities that can only hold with equality.
std::set<std::size_t> ExtendedCertificate::equalityRows() const {
  std::set<std::size_t> allowed = equalities_;
  for (const Weights& proof : implied_) {
    Vector sum(n_ + p_ + 1);
    for (const auto& [row, weight] : proof) {
      require(row < m_ && (weight > 0 || equalities_.count(row) > 0), "an implied equality has a wrong sign");
      for (std::size_t j = 0; j < n_; ++j) sum[j] += weight * data("A").at(row, j);
      for (std::size_t j = 0; j < p_; ++j) sum[n_ + j] += weight * data("S").at(row, j);
      sum[n_ + p_] += weight * data("b").at(row, 0);
      allowed.insert(row);
    }
    for (const Fraction& value : sum) require(value == 0, "an implied equality does not follow");
  }
  return allowed;
}

void ExtendedCertificate::checkProgram() const {
  const std::set<std::size_t> allowed = equalityRows();
  for (const std::size_t row : basis_) require(allowed.count(row) > 0, "a row is no equality");
  for (const std::size_t row : dropped_) {
    require(!isInBasis(row), "a row of the basis is dropped");
    require(allowed.count(row) == 0 || equalities_.count(row) > 0, "an implied equality is dropped");
  }
  if (isLinear()) return;
  checkConvexity();
  checkUniqueness();
}

/// Dropped rows are no conditions, but hold up to rounding. So do tolerated ones.
void ExtendedCertificate::addSlack(std::size_t i, const Slack& slack, Region& region) const {
  const std::string row = std::to_string(i);
  const bool is_equality = equalities_.count(i) > 0;
  if (isLeftOut(i)) {
    region.further["dropped_follows s" + row] = within(slack, 1, is_equality ? kToleratedBits : kDroppedBits);
    if (is_equality) region.further["dropped_follows x" + row] = within(slack, -1, kToleratedBits);
    return;
  }
  if (isWidened() && !is_equality)
    region.further["tolerated_follows s" + row] = within(slack, 1, kToleratedBits);
  Certificate::addSlack(i, slack, region);
}

}  // namespace checker
