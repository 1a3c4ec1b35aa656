#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lookup_run.hpp"

namespace checker {

/// A comparison of a look-up, with its outcome: the value of the row is at most `limit`, or less than it.
struct PathStep {
  std::uint32_t row = 0;
  double limit = 0.0;
  bool is_strict = false;
};

/// Looks for numbers of the code's type at which computed values give each comparison of a path its outcome. The box is cut into
/// parts, each with its own bounds of rounding, until a part is proven to hold none, or numbers are found.
class PathSearch {
 public:
  /// The code outlives the object.
  explicit PathSearch(const ExportedCode& code) : exported_(code), code_(code.tables) {}

  enum class Verdict { kTaken, kImpossible, kUnknown };

  /// Cuts the box into `most_parts` at most. From then on nothing is known.
  Verdict run(const std::vector<PathStep>& path, int most_parts);
  /// The first numbers that were tried; empty where none were.
  const std::vector<double>& tried() const { return tried_; }
  /// After kTaken: numbers of the code's type.
  const std::vector<double>& theta() const { return theta_; }

 private:
  /// Of each parameter.
  using Numbers = std::vector<std::vector<double>>;

  Verdict search(Box box);
  void cutInHalves(const Box& box);
  bool shrink(Cell& cell, Box& box) const;
  void addSteps(const Box& box, Cell& cell) const;
  bool tryNumbers(const Cell& cell, const Box& box);
  bool take(std::vector<double> theta, const Box& box);
  double numberDistance(double value, std::size_t parameter) const;
  bool isTakenBy(const std::vector<double>& theta);
  std::optional<Numbers> numbersIn(const Box& box) const;
  double firstNumber(double bound, std::size_t parameter) const;
  double nextNumber(double value, std::size_t parameter) const;
  bool tryAll(const Numbers& numbers);

  const ExportedCode& exported_;
  const LookupTables& code_;
  std::vector<PathStep> path_;
  std::vector<double> theta_, tried_;
  std::vector<Box> parts_;
  /// Whether all parts in which nothing is known were cut.
  bool is_cut_ = true;
};

}  // namespace checker
