#pragma once

#include <cstddef>
#include <utility>
#include <vector>

/// Proven bounds of linear functions over a box cut by half-spaces, in doubles.
namespace checker {

/// sign normal . theta <= limit. The normal is p numbers that outlive the half-space.
struct HalfSpace {
  const double* normal = nullptr;
  double sign = 1.0;
  double limit = 0.0;
  /// Of Cell::point.
  double weight = 0.0;
};

/// A box of parameters.
struct Box {
  std::vector<double> lower, upper;

  std::size_t size() const { return lower.size(); }
  /// Greatest size of a parameter.
  double greatest(std::size_t i) const;
};

/// The part of a box that some half-spaces hold.
class Cell {
 public:
  /// The box outlives the cell.
  explicit Cell(const Box& box) : box_(&box) {}

  void add(const HalfSpace& half_space) { half_spaces_.push_back(half_space); }
  std::size_t size() const { return half_spaces_.size(); }
  /// Drops all half-spaces after the first `size`.
  void shrink(std::size_t size) { half_spaces_.resize(size); }

  /// Whether it is proven that no theta of the box holds all half-spaces.
  bool isEmpty();

  /// A number that function . theta + constant exceeds nowhere in the cell: minus infinity where the cell is proven
  /// empty. The bound follows from multipliers by weak duality, with the rounding of its own sums added. So it holds
  /// however the multipliers were found: in doubles, and where these get stuck in rational numbers.
  double upperBound(const std::vector<double>& function, double constant);

  /// A theta of the cell that maximises the function, of parameters in half-ranges of the box. A last entry counts the
  /// distance from the half-spaces, in shares of the greatest weight: each holds by its weight times that at least.
  /// Nothing is proven of it. Empty where none is found.
  std::vector<double> point(const std::vector<double>& function) const;

  /// The least distance of theta from a half-space, in shares of the half-space's weight; negative beyond one.
  double depth(const std::vector<double>& theta) const;

 private:
  template <class Number>
  std::vector<double> pointBy(const std::vector<double>& function) const;
  template <class Number>
  bool solve(const std::vector<double>& function, double constant, double& bound);
  double weakDual(const std::vector<double>& function, double constant) const;

  const Box* box_;
  std::vector<HalfSpace> half_spaces_;
  // Of half-spaces, nonnegative.
  std::vector<std::pair<std::size_t, double>> multipliers_;
};

}  // namespace checker
