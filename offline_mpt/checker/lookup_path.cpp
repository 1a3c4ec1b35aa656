#include "lookup_path.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>

namespace checker {
namespace {

/// Lines beside the centre of each part that are tried, up to 2 to this power numbers away.
constexpr int kTries = 200;
constexpr int kMostBeside = 6;
/// Lines in a part that are tried one by one.
constexpr std::int64_t kMostLines = 1 << 16;
constexpr std::uint64_t kSeed = 1;
// The sums below are in doubles; these cover their rounding.
constexpr double kOwnRounding = 1.0 + 1e-9;
constexpr double kOwnUnit = 0x1p-51;
/// Of half-spaces in the search of a centre, whose own rounding is some of 1e-13. [scaled]
constexpr double kLeastWeight = 1e-12;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

double powerOfSize(double size) { return size > 0.0 ? std::ldexp(1.0, std::ilogb(size)) : 0.0; }

/// With the rounding of one more operation: half the distance of numbers of the greatest size, and at most `most`.
Rounded rounded(Rounded value, const Arithmetic& arithmetic, double most) {
  value.arithmetic = arithmetic;
  const double half = arithmetic.unit * powerOfSize((value.greatest() + value.error) * kOwnRounding);
  value.error += std::min(half, most) + arithmetic.smallest;
  return value;
}

Rounded operator*(const Rounded& entry, const Rounded& theta) {
  const double a = entry.lower * theta.lower, b = entry.lower * theta.upper;
  return rounded({std::min(a, b), std::max(a, b), theta.arithmetic}, theta.arithmetic, kInfinity);
}

/// Each of the two numbers is one to which their sum may be rounded, so the other one bounds the rounding.
Rounded operator+(const Rounded& a, const Rounded& b) {
  Rounded result(a.lower + b.lower, a.upper + b.upper, a.arithmetic);
  result.error = a.error + b.error;
  const double most = std::min(a.greatest() + a.error, b.greatest() + b.error) * kOwnRounding;
  return rounded(result, a.arithmetic.unit > b.arithmetic.unit ? a.arithmetic : b.arithmetic, most);
}

/// A power of two of which all values of a number are multiples; 0 where it may be as small as any.
double gridOf(const Rounded& number, const Arithmetic& arithmetic) {
  if (number.lower <= 0.0 && number.upper >= 0.0) return 0.0;
  const double least = std::min(std::abs(number.lower), std::abs(number.upper)) / kOwnRounding - number.error;
  return least > 0.0 ? 2.0 * arithmetic.unit * powerOfSize(least) : 0.0;
}

/// The greatest value of a step that gives it its outcome. Values are multiples of `grid`.
double greatestValue(const PathStep& step, double grid) {
  if (grid <= 0.0) return step.limit;
  const double multiple = step.limit / grid;
  return grid * (step.is_strict ? std::ceil(multiple) - 1.0 : std::floor(multiple));
}

Arithmetic arithmeticOf(CodeType type) { return type == CodeType::kDouble ? kDoubles : kFloats; }

/// Numbers in their order: those of one sign are ordered as their bits are. Both zeros have place 0.
template <class Number, class Bits>
std::int64_t placeOfBits(Number number) {
  Bits bits = 0;
  std::memcpy(&bits, &number, sizeof bits);
  return bits >= 0 ? bits : std::numeric_limits<Bits>::min() - bits;
}

template <class Number, class Bits>
double numberOfPlace(std::int64_t place) {
  const Bits bits = static_cast<Bits>(std::abs(place));
  Number number = 0;
  std::memcpy(&number, &bits, sizeof bits);
  return place < 0 ? -number : number;
}

}  // namespace

/// The part whose centre is deepest is cut first.
PathSearch::Verdict PathSearch::run(const std::vector<PathStep>& path, int most_parts) {
  path_ = path;
  tried_.clear();
  parts_ = {};
  const Verdict whole = search(code_.box);
  if (whole != Verdict::kUnknown) return whole;
  bool is_impossible = true;
  for (int done = 1; !parts_.empty();) {
    const std::vector<Box> halves = halvesOf(parts_.top().box);
    parts_.pop();
    is_impossible = is_impossible && !halves.empty();
    for (const Box& half : halves) {
      if (done++ == most_parts) return Verdict::kUnknown;
      if (search(half) == Verdict::kTaken) return Verdict::kTaken;
    }
  }
  return is_impossible ? Verdict::kImpossible : Verdict::kUnknown;
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
    const double grid = std::min(gridOf(first, arithmetic), gridOf(last, arithmetic));
    const double limit = greatestValue(step, grid);
    const double error =
        (first.error + last.error + arithmetic.unit * std::abs(limit) + arithmetic.smallest) * kOwnRounding;
    const double sign = step.row % 2 == 0 ? 1.0 : -1.0;
    const double constant = sign * plane[code_.p];
    const double own = kOwnUnit * (std::abs(constant) + std::abs(limit) + error);
    cell.add({plane, sign, constant + limit + error + own, std::max(error, kLeastWeight)});
  }
}

/// To the bounds of each parameter in the cell. False where the cell is proven to hold no numbers.
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
    if (bounds.lower[i] > bounds.upper[i]) return false;
  }
  box = bounds;
  return true;
}

bool PathSearch::holds(const PathStep& step, const std::vector<double>& theta) const {
  const double plane = valueAt(exported_, step.row / 2, theta);
  const double value = step.row % 2 == 0 ? plane : -plane;
  return step.is_strict ? value < step.limit : value <= step.limit;
}

bool PathSearch::isTakenBy(const std::vector<double>& theta) {
  if (!std::all_of(path_.begin(), path_.end(), [&](const PathStep& step) { return holds(step, theta); }))
    return false;
  theta_ = theta;
  return true;
}

/// Drops the numbers of a parameter at which the step has another outcome. They are the first ones or the last ones.
void PathSearch::keepHeld(const PathStep& step, std::vector<double>& theta, std::size_t parameter,
                          Numbers& numbers) const {
  const auto holdsAt = [&](std::int64_t place) {
    theta[parameter] = numberAt(place);
    return holds(step, theta);
  };
  const bool holds_first = holdsAt(numbers.first), holds_last = holdsAt(numbers.last);
  if (holds_first && holds_last) return;
  if (!holds_first && !holds_last) {
    numbers.last = numbers.first - 1;
    return;
  }
  // The step holds at `held`, and not at `failed`.
  std::int64_t held = holds_first ? numbers.first : numbers.last;
  std::int64_t failed = holds_first ? numbers.last : numbers.first;
  // Halves are added, because the difference of two places may be too great for their type.
  const auto between = [&] { return held / 2 + failed / 2 + (held % 2 + failed % 2) / 2; };
  for (std::int64_t middle = between(); middle != held && middle != failed; middle = between())
    (holdsAt(middle) ? held : failed) = middle;
  (holds_first ? numbers.last : numbers.first) = held;
}

/// Whether one of a parameter's numbers takes the path, with the others of theta. The step that failed last is tried first.
bool PathSearch::isTakenOnLine(std::vector<double> theta, std::size_t parameter, Numbers numbers) {
  for (PathStep& step : path_) {
    if (numbers.count() > 0) keepHeld(step, theta, parameter, numbers);
    if (numbers.count() > 0) continue;
    std::swap(step, path_.front());
    return false;
  }
  theta[parameter] = numberAt(numbers.first);
  return isTakenBy(theta);
}

/// The centre of a cell, and lines of numbers beside it. The cell may be as thin as the distance of two numbers.
bool PathSearch::tryNumbers(const std::vector<double>& centre, const Box& box) {
  const std::size_t p = box.size();
  const std::vector<double> nearest = givenNumbers(exported_, centre);
  if (tried_.empty()) tried_ = nearest;
  if (isTakenBy(nearest)) return true;
  const std::vector<Numbers> numbers = numbersIn(box);
  std::mt19937_64 random(kSeed);
  for (int i = 0; i < kTries; ++i) {
    const double most = std::ldexp(1.0, i % kMostBeside);
    std::vector<double> theta = nearest;
    for (std::size_t k = 0; k < p; ++k) {
      const double share = static_cast<double>(random() >> 11) * 0x1p-52 - 1.0;
      const auto beside = static_cast<std::int64_t>(std::round(most * share));
      theta[k] = numberAt(std::clamp(placeOf(theta[k]) + beside, numbers[k].first, numbers[k].last));
    }
    const std::size_t parameter = static_cast<std::size_t>(i) % p;
    if (isTakenOnLine(theta, parameter, numbers[parameter])) return true;
  }
  return false;
}

/// Whether numbers of the part take the path, where they are few enough to try: all but those of one parameter, one by one.
std::optional<bool> PathSearch::tryAll(const Box& box) {
  std::vector<Numbers> numbers = numbersIn(box);
  const auto byCount = [](const Numbers& a, const Numbers& b) { return a.count() < b.count(); };
  const auto line =
      static_cast<std::size_t>(std::max_element(numbers.begin(), numbers.end(), byCount) - numbers.begin());
  const Numbers on_line = numbers[line];
  numbers[line].last = numbers[line].first;
  std::int64_t lines = 1;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    Numbers& some = numbers[i];
    if (some.count() == 0) return false;
    // No step has an entry of it.
    if (change(box, i) == 0.0) some.last = some.first;
    if (some.count() > kMostLines / lines) return std::nullopt;
    lines *= some.count();
  }
  std::vector<double> theta(numbers.size());
  for (std::int64_t i = 0; i < lines; ++i) {
    std::int64_t rest = i;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      theta[k] = numberAt(numbers[k].first + rest % numbers[k].count());
      rest /= numbers[k].count();
    }
    if (isTakenOnLine(theta, line, on_line)) return true;
  }
  return false;
}

std::vector<PathSearch::Numbers> PathSearch::numbersIn(const Box& box) const {
  std::vector<Numbers> numbers(box.size());
  for (std::size_t i = 0; i < box.size(); ++i) {
    const std::int64_t first = placeOf(box.lower[i]), last = placeOf(box.upper[i]);
    numbers[i].first = numberAt(first) < box.lower[i] ? first + 1 : first;
    numbers[i].last = numberAt(last) > box.upper[i] ? last - 1 : last;
  }
  return numbers;
}

/// Of the nearest number of the code's type.
std::int64_t PathSearch::placeOf(double number) const {
  return exported_.type == CodeType::kDouble ? placeOfBits<double, std::int64_t>(number)
                                             : placeOfBits<float, std::int32_t>(static_cast<float>(number));
}

double PathSearch::numberAt(std::int64_t place) const {
  return exported_.type == CodeType::kDouble ? numberOfPlace<double, std::int64_t>(place)
                                             : numberOfPlace<float, std::int32_t>(place);
}

/// How far the value of a step changes at most with a parameter in a box.
double PathSearch::change(const Box& box, std::size_t parameter) const {
  double greatest = 0.0;
  for (const PathStep& step : path_)
    greatest = std::max(greatest, std::abs(code_.planes[step.row / 2 * (code_.p + 1) + parameter]));
  return greatest * (box.upper[parameter] - box.lower[parameter]);
}

/// Of the parameter that changes values most. Nothing where it changes them as little as rounding does.
std::vector<Box> PathSearch::halvesOf(const Box& box) const {
  std::size_t widest = box.size();
  double greatest = 32.0 * arithmeticOf(exported_.type).unit;
  for (std::size_t i = 0; i < box.size(); ++i) {
    if (change(box, i) <= greatest) continue;
    greatest = change(box, i);
    widest = i;
  }
  if (widest == box.size()) return {};
  std::vector<Box> halves(2, box);
  const double middle = 0.5 * (box.lower[widest] + box.upper[widest]);
  halves[0].upper[widest] = middle;
  halves[1].lower[widest] = middle;
  return halves;
}

PathSearch::Verdict PathSearch::search(Box box) {
  const Box whole = box;
  Cell cell(whole);
  addSteps(whole, cell);
  if (!shrink(cell, box)) return Verdict::kImpossible;
  Cell smaller(box);
  addSteps(box, smaller);
  if (smaller.isEmpty()) return Verdict::kImpossible;
  std::vector<double> deepest(box.size() + 1, 0.0);
  // Without symmetry, so that dual variables are apart.
  for (std::size_t k = 0; k < box.size(); ++k) deepest[k] = 1e-13 * (1.0 + 0.37 * static_cast<double>(k));
  deepest[box.size()] = 1.0;
  const std::vector<double> centre = smaller.point(deepest);
  if (!centre.empty() && tryNumbers(centre, box)) return Verdict::kTaken;
  if (const std::optional<bool> is_taken = tryAll(box))
    return *is_taken ? Verdict::kTaken : Verdict::kImpossible;
  parts_.push({box, centre.empty() ? -kInfinity : smaller.depth(centre)});
  return Verdict::kUnknown;
}

}  // namespace checker
