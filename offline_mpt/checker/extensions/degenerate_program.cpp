// Equalities that depend on each other or hold only together, rows that others imply up to rounding, and entries that
// count as others.
#include <algorithm>
#include <utility>

#include "extensions/extended_certificate.hpp"

namespace checker {
namespace {

constexpr unsigned long kDroppedBits = 30, kToleratedBits = 40, kRelaxedBits = 40;
constexpr unsigned long kEntryBits = 30, kBoundBits = 29;

Fraction greatestOf(const Matrix& matrix, std::size_t first, std::size_t count) {
  Fraction greatest;
  for (std::size_t k = first; k < first + count; ++k)
    greatest = std::max(greatest, Fraction(abs(matrix.entries[k])));
  return greatest;
}

/// slack >= - (2^-bits of the size of its inequality).
Row within(const Slack& slack, int sign, unsigned long bits) {
  Row row = slack.value;
  for (Integer& value : row) value = sign * (value << bits);
  row.back() += slack.size;
  return primitive(row);
}

}  // namespace

void ExtendedCertificate::finish() {
  for (const auto* rows : {&dropped_, &relaxed_})
    require(rows->empty() || *rows->rbegin() < m_, "no such row");
  const Vector& H = data("H").entries;
  const bool is_zero = std::all_of(H.begin(), H.end(), [](const Fraction& entry) { return entry == 0; });
  require(is_zero == isLinear(), "convexity: H is zero, or is not");
  original_ = data_;
  replaceEntries();
  relaxBounds();
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
  for (const Counts& counts : counts_)
    require(counts.name != "b" || allowed.count(counts.row) > 0, "b: of no equality");
  for (const std::size_t row : basis_) require(allowed.count(row) > 0, "a row is no equality");
  for (const std::size_t row : dropped_) {
    require(!isInBasis(row), "a row of the basis is dropped");
    require(allowed.count(row) == 0 || equalities_.count(row) > 0, "an implied equality is dropped");
  }
  for (const std::size_t row : relaxed_) require(allowed.count(row) == 0, "an equality is relaxed");
  if (!isLinear()) checkConvexity();
  if (!isLinear() && !isSingular()) checkUniqueness();
}

/// Entries that count as others. They differ by rounding: 2^-30 of the greatest entry of the matrix, or of
/// the row of A; those of b by 2^-29 of the sum of the row's entries. All of H is replaced or nothing; it
/// then has the penalty in it.
void ExtendedCertificate::replaceEntries() {
  std::map<std::string, std::set<std::pair<std::size_t, std::size_t>>> seen;
  for (const Counts& counts : counts_) {
    const bool may_be_singular =
        counts.name == "H" || counts.name == "F" || counts.name == "f" || counts.name == "A";
    require((isSingular() && may_be_singular) || counts.name == "b",
            counts.name + ": its entries cannot count as others");
    const Matrix& matrix = data_.at(counts.name);
    require(counts.row < matrix.rows && counts.column < matrix.columns, counts.name + ": no such entry");
    require(seen[counts.name].emplace(counts.row, counts.column).second, "an entry counts twice");
  }
  const bool has_hessian = seen.count("H") > 0;
  if (has_hessian) {
    require(seen["H"].size() == n_ * n_, "H counts as another only in part");
    replaceHessian();
  }
  const Matrices before = data_;
  for (const Counts& counts : counts_) {
    requireRounding(counts, before);
    Matrix& matrix = data_.at(counts.name);
    matrix.entries[counts.row * matrix.columns + counts.column] = counts.value;
  }
  if (has_hessian) penalty_ = 0;
}

/// H with the penalty, which its new entries are compared with.
void ExtendedCertificate::replaceHessian() {
  Matrix H = data("H");
  for (std::size_t i = 0; i < n_; ++i) {
    for (std::size_t j = 0; j < n_; ++j) {
      Fraction& entry = H.entries[i * n_ + j];
      entry = hessian(i, j);
      for (const std::size_t row : basis_) entry += penalty_ * data("A").at(row, i) * data("A").at(row, j);
    }
  }
  data_.at("H") = H;
}

void ExtendedCertificate::requireRounding(const Counts& counts, const Matrices& before) const {
  const Matrix& old = before.at(counts.name);
  const Matrix& A = before.at("A");
  Fraction size;
  if (counts.name == "b") {
    // z moved by 2^-29 in each entry makes up for it.
    for (std::size_t j = 0; j < n_; ++j) size += abs(A.at(counts.row, j));
  } else if (counts.name == "A") {
    size = greatestOf(old, counts.row * old.columns, old.columns);
  } else {
    size = greatestOf(old, 0, old.entries.size());
  }
  const unsigned long bits = counts.name == "b" ? kBoundBits : kEntryBits;
  require(abs(counts.value - old.at(counts.row, counts.column)) * Fraction(Integer(1) << bits) <= size,
          counts.name + ": an entry counts as one that differs by more than rounding");
}

void ExtendedCertificate::relaxBounds() {
  for (const std::size_t row : relaxed_)
    data_.at("b").entries[row] += greatestOf(data("A"), row * n_, n_) / Fraction(Integer(1) << kRelaxedBits);
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
