#include "lookup_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace checker {
namespace {

/// Numbers beside the centre of each part that are tried, up to 2 to this power numbers away.
constexpr int kTries = 200;
constexpr int kMostBeside = 6;
/// Combinations of numbers that are tried one by one.
constexpr std::size_t kMostNumbers = 1u << 16;
constexpr std::uint64_t kSeed = 1;
// The sums below are in doubles; these cover their rounding.
constexpr double kOwnRounding = 1.0 + 1e-9;
constexpr double kOwnUnit = 0x1p-51;
/// Of half-spaces in the search of a centre, whose own rounding is some of 1e-13. [scaled]
constexpr double kLeastWeight = 1e-12;

/// All values that a number of the code may have, and how far it may be from the exact one.
struct Rounded {
  double lower = 0.0, upper = 0.0, error = 0.0;
  Arithmetic arithmetic;

  Rounded() = default;
  explicit Rounded(double value) : lower(value), upper(value) {}
  Rounded(double low, double high, const Arithmetic& rounding)
      : lower(low), upper(high), arithmetic(rounding) {}

  double greatest() const { return std::max(std::abs(lower), std::abs(upper)); }
};

/// With the rounding of one more operation: half the distance of numbers of the greatest size.
Rounded rounded(Rounded value, const Arithmetic& arithmetic) {
  value.arithmetic = arithmetic;
  const double greatest = (value.greatest() + value.error) * kOwnRounding;
  const double power = greatest > 0.0 ? std::ldexp(1.0, std::ilogb(greatest)) : 0.0;
  value.error += arithmetic.unit * power + arithmetic.smallest;
  return value;
}

Rounded operator*(const Rounded& entry, const Rounded& theta) {
  const double a = entry.lower * theta.lower, b = entry.lower * theta.upper;
  return rounded({std::min(a, b), std::max(a, b), theta.arithmetic}, theta.arithmetic);
}

Rounded operator+(const Rounded& a, const Rounded& b) {
  Rounded result(a.lower + b.lower, a.upper + b.upper, a.arithmetic);
  result.error = a.error + b.error;
  return rounded(result, a.arithmetic.unit > b.arithmetic.unit ? a.arithmetic : b.arithmetic);
}

Arithmetic arithmeticOf(CodeType type) {
  switch (type) {
    case CodeType::kDouble:
      return kDoubles;
    case CodeType::kFloat:
      return kFloats;
    case CodeType::kInt16:
      return {};
  }
  return {};
}

}  // namespace

PathSearch::Verdict PathSearch::run(const std::vector<PathStep>& path, int most_parts) {
  path_ = path;
  tried_.clear();
  parts_.assign(1, code_.box);
  is_cut_ = true;
  for (std::size_t done = 0; done < parts_.size(); ++done) {
    if (done == static_cast<std::size_t>(most_parts)) return Verdict::kUnknown;
    // A copy, because halves are added behind.
    const Box part = parts_[done];
    if (search(part) == Verdict::kTaken) return Verdict::kTaken;
  }
  return is_cut_ ? Verdict::kImpossible : Verdict::kUnknown;
}

/// The computed value of a step is a rounded sum of two parts. So it is at most the limit only where their exact sum is at
/// most the limit and a rounding of it.
void PathSearch::addSteps(const Box& box, Cell& cell) const {
  const Arithmetic arithmetic = arithmeticOf(exported_.type);
  std::vector<Rounded> theta;
  for (std::size_t i = 0; i < box.size(); ++i) theta.emplace_back(box.lower[i], box.upper[i], arithmetic);
  const PlaneSum<Rounded> sums(theta);
  for (const PathStep& step : path_) {
    const double* const plane = code_.planes.data() + std::size_t{step.row / 2} * (code_.p + 1);
    const auto [first, last] = sums.parts(plane);
    const double error =
        (first.error + last.error + arithmetic.unit * std::abs(step.limit) + arithmetic.smallest) *
        kOwnRounding;
    const double sign = step.row % 2 == 0 ? 1.0 : -1.0;
    const double constant = sign * plane[code_.p];
    const double limit = step.limit - (step.is_strict ? code_.distance_unit : 0.0);
    const double own = kOwnUnit * (std::abs(constant) + std::abs(step.limit) + error);
    cell.add({plane, sign, constant + limit + error + own,
              std::max(code_.plane_error[step.row / 2], kLeastWeight)});
  }
}

/// To the bounds of each parameter in the cell, and to whole units. False where the cell is proven to hold no numbers.
bool PathSearch::shrink(Cell& cell, Box& box) const {
  Box bounds = box;
  for (std::size_t i = 0; i < box.size(); ++i) {
    for (const double sign : {1.0, -1.0}) {
      std::vector<double> function(box.size(), 0.0);
      function[i] = sign;
      const double bound = cell.upperBound(function, 0.0);
      if (bound == -std::numeric_limits<double>::infinity()) return false;
      double& side = sign > 0.0 ? bounds.upper[i] : bounds.lower[i];
      side = sign > 0.0 ? std::min(side, bound) : std::max(side, -bound);
    }
    if (!code_.parameter_unit.empty()) {
      const double unit = code_.parameter_unit[i];
      bounds.lower[i] = std::ceil(bounds.lower[i] / unit) * unit;
      bounds.upper[i] = std::floor(bounds.upper[i] / unit) * unit;
    }
    if (bounds.lower[i] > bounds.upper[i]) return false;
  }
  box = bounds;
  return true;
}

/// The step that failed last is tried first.
bool PathSearch::isTakenBy(const std::vector<double>& theta) {
  const auto fails = [&](const PathStep& step) {
    const double plane = valueAt(exported_, step.row / 2, theta);
    const double value = step.row % 2 == 0 ? plane : -plane;
    return step.is_strict ? value >= step.limit : value > step.limit;
  };
  if (!path_.empty() && fails(path_.front())) return false;
  const auto failing = std::find_if(path_.begin(), path_.end(), fails);
  if (failing == path_.end()) return true;
  std::iter_swap(path_.begin(), failing);
  return false;
}

/// The centre of the cell, and numbers beside it. The cell may be as thin as the distance of two numbers.
bool PathSearch::tryNumbers(const Cell& cell, const Box& box) {
  const std::size_t p = box.size();
  std::vector<double> function(p + 1);
  // Without symmetry, so that dual variables are apart.
  for (std::size_t k = 0; k < p; ++k) function[k] = 1e-13 * (1.0 + 0.37 * static_cast<double>(k));
  function[p] = 1.0;
  const std::vector<double> centre = cell.point(function);
  if (centre.empty()) return false;
  if (tried_.empty()) tried_ = givenNumbers(exported_, centre);
  if (take(centre, box)) return true;
  std::mt19937_64 random(kSeed);
  for (int i = 0; i < kTries; ++i) {
    const double most = std::ldexp(1.0, i % kMostBeside);
    std::vector<double> theta = centre;
    for (std::size_t k = 0; k < p; ++k) {
      const double share = static_cast<double>(random() >> 11) * 0x1p-52 - 1.0;
      theta[k] += std::round(most * share) * numberDistance(theta[k], k);
    }
    if (take(theta, box)) return true;
  }
  return false;
}

double PathSearch::numberDistance(double value, std::size_t parameter) const {
  if (!code_.parameter_unit.empty()) return code_.parameter_unit[parameter];
  return 2.0 * arithmeticOf(exported_.type).unit * std::abs(value);
}

/// Whether the numbers nearest to theta take the path.
bool PathSearch::take(std::vector<double> theta, const Box& box) {
  for (std::size_t i = 0; i < theta.size(); ++i) theta[i] = std::clamp(theta[i], box.lower[i], box.upper[i]);
  theta = givenNumbers(exported_, theta);
  if (!isTakenBy(theta)) return false;
  theta_ = std::move(theta);
  return true;
}

/// All numbers of the code's type in a part, for each parameter; nothing where they are too many to try.
std::optional<PathSearch::Numbers> PathSearch::numbersIn(const Box& box) const {
  if (exported_.type == CodeType::kDouble) return std::nullopt;
  Numbers numbers(box.size());
  std::size_t combinations = 1;
  for (std::size_t i = 0; i < box.size(); ++i) {
    for (double value = firstNumber(box.lower[i], i); value <= box.upper[i]; value = nextNumber(value, i)) {
      if (numbers[i].size() == kMostNumbers / combinations) return std::nullopt;
      numbers[i].push_back(value);
    }
    combinations *= numbers[i].size();
  }
  return numbers;
}

double PathSearch::nextNumber(double value, std::size_t parameter) const {
  if (!code_.parameter_unit.empty()) return value + code_.parameter_unit[parameter];
  return std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity());
}

/// The least one that is at least `bound`.
double PathSearch::firstNumber(double bound, std::size_t parameter) const {
  if (!code_.parameter_unit.empty())
    return std::ceil(bound / code_.parameter_unit[parameter]) * code_.parameter_unit[parameter];
  const double nearest = static_cast<float>(bound);
  return nearest < bound ? nextNumber(nearest, parameter) : nearest;
}

/// Whether one of the combinations takes the path.
bool PathSearch::tryAll(const Numbers& numbers) {
  const std::size_t p = numbers.size();
  std::vector<std::size_t> at(p, 0);
  std::vector<double> theta(p);
  for (std::size_t i = 0; i < p; ++i) {
    if (numbers[i].empty()) return false;
    theta[i] = numbers[i].front();
  }
  while (true) {
    if (isTakenBy(theta)) {
      theta_ = theta;
      return true;
    }
    std::size_t i = 0;
    while (i < p && ++at[i] == numbers[i].size()) {
      at[i] = 0;
      theta[i] = numbers[i].front();
      ++i;
    }
    if (i == p) return false;
    theta[i] = numbers[i][at[i]];
  }
}

/// Of the widest parameter, where it is not as narrow already as it can be.
void PathSearch::cutInHalves(const Box& box) {
  std::size_t widest = 0;
  double greatest = 0.0;
  for (std::size_t i = 0; i < box.size(); ++i) {
    const double share = (box.upper[i] - box.lower[i]) / (code_.box.upper[i] - code_.box.lower[i]);
    if (share > greatest) {
      greatest = share;
      widest = i;
    }
  }
  constexpr double kLeastShare = 1e-6;
  const bool has_units = !code_.parameter_unit.empty();
  is_cut_ = is_cut_ && greatest > (has_units ? 0.0 : kLeastShare);
  if (!is_cut_) return;
  Box lower = box, upper = box;
  double middle = 0.5 * (box.lower[widest] + box.upper[widest]);
  const double unit = has_units ? code_.parameter_unit[widest] : 0.0;
  if (has_units) middle = std::floor(middle / unit) * unit;
  lower.upper[widest] = middle;
  upper.lower[widest] = middle + unit;
  parts_.push_back(std::move(lower));
  parts_.push_back(std::move(upper));
}

PathSearch::Verdict PathSearch::search(Box box) {
  const Box whole = box;
  Cell cell(whole);
  addSteps(whole, cell);
  if (!shrink(cell, box)) return Verdict::kImpossible;
  Cell smaller(box);
  addSteps(box, smaller);
  if (smaller.isEmpty()) return Verdict::kImpossible;
  if (tryNumbers(smaller, box)) return Verdict::kTaken;
  if (const std::optional<Numbers> numbers = numbersIn(box))
    return tryAll(*numbers) ? Verdict::kTaken : Verdict::kImpossible;
  cutInHalves(box);
  return Verdict::kUnknown;
}

}  // namespace checker
