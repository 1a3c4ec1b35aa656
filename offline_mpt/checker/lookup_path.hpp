#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <queue>
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
/// parts, each with its own bounds of rounding, until all parts are proven to hold none, or numbers are found.
/// A computed value is monotone in each parameter, because roundings are. So all numbers of one parameter are tried at once.
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
  /// The numbers of one parameter in a part, by their places in the order of all numbers of its type.
  struct Numbers {
    std::int64_t first = 0, last = -1;

    /// The greatest number of its type where there are more.
    std::int64_t count() const {
      if (last < first) return 0;
      constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
      const std::uint64_t beyond = static_cast<std::uint64_t>(last) - static_cast<std::uint64_t>(first);
      return beyond < static_cast<std::uint64_t>(kMost) ? static_cast<std::int64_t>(beyond) + 1 : kMost;
    }
  };

  /// A part in which nothing is known. `depth`: how far its centre is from the half-spaces, in shares of their rounding.
  struct Part {
    Box box;
    double depth = 0.0;

    bool operator<(const Part& other) const { return depth < other.depth; }
  };

  Verdict search(Box box);
  std::vector<Box> halvesOf(const Box& box) const;
  double change(const Box& box, std::size_t parameter) const;
  bool shrink(Cell& cell, Box& box) const;
  void addSteps(const Box& box, Cell& cell) const;
  bool tryNumbers(const std::vector<double>& centre, const Box& box);
  bool holds(const PathStep& step, const std::vector<double>& theta) const;
  bool isTakenBy(const std::vector<double>& theta);
  bool isTakenOnLine(std::vector<double> theta, std::size_t parameter, Numbers numbers);
  void keepHeld(const PathStep& step, std::vector<double>& theta, std::size_t parameter,
                Numbers& numbers) const;
  std::vector<Numbers> numbersIn(const Box& box) const;
  std::optional<bool> tryAll(const Box& box);
  std::int64_t placeOf(double number) const;
  double numberAt(std::int64_t place) const;

  const ExportedCode& exported_;
  const LookupTables& code_;
  std::vector<PathStep> path_;
  std::vector<double> theta_, tried_;
  std::priority_queue<Part> parts_;
};

}  // namespace checker
