#include "polytope_sets/double_description.hpp"

#include <algorithm>
#include <utility>

namespace polyfly {
namespace {

// first * weight + second * other_weight, made primitive.
std::vector<Integer> combine(const std::vector<Integer>& first, const Integer& weight,
                             const std::vector<Integer>& second, const Integer& other_weight) {
  std::vector<Integer> result(first.size());
  for (std::size_t j = 0; j < first.size(); ++j) {
    mpz_mul(result[j].get_mpz_t(), first[j].get_mpz_t(), weight.get_mpz_t());
    mpz_addmul(result[j].get_mpz_t(), second[j].get_mpz_t(), other_weight.get_mpz_t());
  }
  makePrimitive(result);
  return result;
}

}  // namespace

bool TightSet::contains(const TightSet& other) const {
  const mp_limb_t* const mine = mpz_limbs_read(bits_.get_mpz_t());
  const mp_limb_t* const theirs = mpz_limbs_read(other.bits_.get_mpz_t());
  const std::size_t size = mpz_size(bits_.get_mpz_t());
  for (std::size_t k = 0; k < mpz_size(other.bits_.get_mpz_t()); ++k) {
    if ((theirs[k] & ~(k < size ? mine[k] : 0)) != 0) return false;
  }
  return true;
}

Integer dot(const std::vector<Integer>& row, const std::vector<Integer>& y) {
  Integer sum;
  for (std::size_t j = 0; j < row.size(); ++j)
    mpz_addmul(sum.get_mpz_t(), row[j].get_mpz_t(), y[j].get_mpz_t());
  return sum;
}

void makePrimitive(std::vector<Integer>& values) {
  Integer divisor;
  for (const Integer& value : values) {
    mpz_gcd(divisor.get_mpz_t(), divisor.get_mpz_t(), value.get_mpz_t());
    if (divisor == 1) return;
  }
  if (divisor == 0) return;
  for (Integer& value : values) mpz_divexact(value.get_mpz_t(), value.get_mpz_t(), divisor.get_mpz_t());
}

std::vector<Integer> wholeNumbers(const RationalVector& values) {
  Integer denominator(1);
  for (const Rational& value : values)
    mpz_lcm(denominator.get_mpz_t(), denominator.get_mpz_t(), value.get_den_mpz_t());
  std::vector<Integer> result;
  for (const Rational& value : values) result.emplace_back(value.get_num() * (denominator / value.get_den()));
  makePrimitive(result);
  return result;
}

DoubleDescription::DoubleDescription(int size) : size_(static_cast<std::size_t>(size)) {
  for (std::size_t j = 0; j < size_; ++j) {
    lines_.emplace_back(size_);
    lines_.back()[j] = 1;
  }
}

std::size_t DoubleDescription::add(const std::vector<Integer>& row, bool equality) {
  if (!addAcrossLines(row, equality)) addAcrossRays(row, equality);
  all_rows_.set(row_count_);
  return row_count_++;
}

// A line that the row cuts becomes a ray into the half-space; all else is moved along it onto the plane.
bool DoubleDescription::addAcrossLines(const std::vector<Integer>& row, bool equality) {
  std::size_t cut = 0;
  Integer slope;
  for (; cut < lines_.size(); ++cut) {
    slope = dot(row, lines_[cut]);
    if (slope != 0) break;
  }
  if (cut == lines_.size()) return false;
  std::vector<Integer> line = std::move(lines_[cut]);
  lines_.erase(lines_.begin() + static_cast<std::ptrdiff_t>(cut));
  if (slope < 0) {
    slope = -slope;
    for (Integer& value : line) value = -value;
  }
  for (std::vector<Integer>& other : lines_) {
    const Integer value = dot(row, other);
    if (value != 0) other = combine(other, slope, line, -value);
  }
  for (Ray& ray : rays_) {
    const Integer value = dot(row, ray.value);
    if (value != 0) ray.value = combine(ray.value, slope, line, -value);
    ray.tight.set(row_count_);
  }
  if (!equality) rays_.push_back({std::move(line), all_rows_});
  return true;
}

void DoubleDescription::addAcrossRays(const std::vector<Integer>& row, bool equality) {
  std::vector<Integer> values;
  std::vector<std::size_t> positive, negative;
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    values.push_back(dot(row, rays_[i].value));
    if (values[i] > 0) positive.push_back(i);
    if (values[i] < 0) negative.push_back(i);
    if (values[i] == 0) rays_[i].tight.set(row_count_);
  }
  if (negative.empty() && (!equality || positive.empty())) return;
  std::vector<Ray> fresh;
  for (const std::size_t i : positive) {
    for (const std::size_t j : negative) {
      TightSet common = rays_[i].tight & rays_[j].tight;
      if (!adjacent(i, j, common)) continue;
      common.set(row_count_);
      fresh.push_back({combine(rays_[i].value, -values[j], rays_[j].value, values[i]), std::move(common)});
    }
  }
  std::vector<Ray> kept;
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    if (values[i] == 0 || (values[i] > 0 && !equality)) kept.push_back(std::move(rays_[i]));
  }
  for (Ray& ray : fresh) kept.push_back(std::move(ray));
  rays_ = std::move(kept);
}

// Two rays span a face of two dimensions when no third ray is tight wherever both are.
bool DoubleDescription::adjacent(std::size_t first, std::size_t second, const TightSet& common) const {
  if (common.count() + lines_.size() + 2 < size_) return false;
  for (std::size_t k = 0; k < rays_.size(); ++k) {
    if (k != first && k != second && rays_[k].tight.contains(common)) return false;
  }
  return true;
}

}  // namespace polyfly
