#pragma once

#include <cstddef>
#include <vector>

#include "polytope_sets/rational.hpp"

namespace polyfly {

/// A set of small whole numbers: which rows are tight, which vertices a face holds.
class TightSet {
 public:
  void set(std::size_t index) { mpz_setbit(bits_.get_mpz_t(), index); }
  bool test(std::size_t index) const { return mpz_tstbit(bits_.get_mpz_t(), index) != 0; }
  std::size_t count() const { return mpz_popcount(bits_.get_mpz_t()); }
  bool contains(const TightSet& other) const;  ///< every member of `other` is one of this
  bool operator==(const TightSet& other) const { return bits_ == other.bits_; }
  bool operator<(const TightSet& other) const { return bits_ < other.bits_; }  ///< any strict order
  TightSet operator&(const TightSet& other) const {
    TightSet result;
    result.bits_ = bits_ & other.bits_;
    return result;
  }

 private:
  Integer bits_;
};

/// The cone {y : row . y >= 0 for all rows} by its generators, kept up to date while rows are added. This is the
/// double description method (Motzkin, Raiffa, Thompson and Thrall, 1953; Fukuda and Prodon, 1996), in whole numbers,
/// without rounding. Every y of the cone is a sum of rays with weights >= 0 and lines with any weights; no ray can be
/// left out.
///
/// The number of rays may grow exponentially with the dimension before it falls again. A cell of a few dozen rows in
/// up to 8 dimensions takes milliseconds.
class DoubleDescription {
 public:
  struct Ray {
    std::vector<Integer> value;  ///< without a common factor
    TightSet tight;              ///< rows, by their order, that are zero here
  };

  /// The whole space of `size` dimensions.
  explicit DoubleDescription(int size);

  /// Also demands row . y >= 0, or = 0. Returns the row's place.
  std::size_t add(const std::vector<Integer>& row, bool equality = false);

  const std::vector<Ray>& rays() const { return rays_; }
  const std::vector<std::vector<Integer>>& lines() const { return lines_; }
  std::size_t rowCount() const { return row_count_; }

 private:
  bool addAcrossLines(const std::vector<Integer>& row, bool equality);
  void addAcrossRays(const std::vector<Integer>& row, bool equality);
  bool adjacent(std::size_t first, std::size_t second, const TightSet& common) const;

  std::size_t size_;
  std::size_t row_count_ = 0;
  TightSet all_rows_;
  std::vector<std::vector<Integer>> lines_;
  std::vector<Ray> rays_;
};

/// row . y
Integer dot(const std::vector<Integer>& row, const std::vector<Integer>& y);

/// Whole numbers without a common factor in the proportions of `values`, signs kept; zeros stay zeros.
std::vector<Integer> wholeNumbers(const RationalVector& values);

/// Divides by the greatest common factor.
void makePrimitive(std::vector<Integer>& values);

}  // namespace polyfly
