#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "bounded.hpp"
#include "core/program.hpp"

namespace checker {

/// What is certain of a map when a proof of its size is confirmed (COUNT.md).
struct Size {
  std::uint64_t regions = 0;
  std::uint64_t active_rows = 0;
  /// Number of regions whose laws differ from all others.
  std::uint64_t laws = 0;
  /// Number of records that were decided in fractions.
  std::uint64_t exact = 0;
  /// Least size of the map.
  std::uint64_t bytes = 0;  ///< [bytes]
};

/// slack(t) = D (t, 1) + gram lambda for the rows of a program, see COUNT.md.
template <typename Number>
struct Reduced {
  std::vector<Number> gram;    ///< m x m
  std::vector<Number> D;       ///< m x (p + 1)
  std::vector<Number> domain;  ///< k x (p + 1): positive strictly inside A_theta
  std::vector<Number> gap;     ///< m: slacks that keep laws apart; empty: unknown
};

/// A file of active sets with witnesses. Everything throws Refused.
class CountProof {
 public:
  explicit CountProof(const std::string& path);

  void compareProblem(const std::string& problem) const;

  /// Checks every record, and that no two are of the same set, on `threads` threads.
  Size check(int threads);

 private:
  struct Record {
    /// Rows without equalities, ascending.
    std::vector<std::size_t> set;
    /// Witness, in units of 2^-39.
    std::vector<std::int64_t> t;
  };
  /// Findings of one thread.
  struct Share;

  const Matrix& data(const std::string& name) const;
  void readHead();
  void reduce();
  void findGaps();
  void findMultiples();
  Record record(const unsigned char* bytes) const;
  void requireProper(const Record& record) const;
  void checkPiece(const std::vector<unsigned char>& bytes, Share& share) const;
  Fraction greatestVariable() const;
  std::uint64_t leastBytes(const Size& size) const;

  /// Whether the record's set is optimal at its witness, strictly; `apart`: whether its law is no other's.
  template <typename Number>
  bool confirms(const Reduced<Number>& reduced, const Record& record, bool& apart) const;

  std::string path_;
  std::ifstream file_;
  Matrices data_;
  std::set<std::size_t> equalities_;
  /// Checksum and size of the problem text.
  std::string problem_;
  Matrix weights_;
  std::size_t n_ = 0, m_ = 0, p_ = 0, q_ = 0;
  std::size_t key_bytes_ = 0, record_bytes_ = 0;
  Reduced<Fraction> exact_;
  Reduced<Bounded> bounded_;
  /// First row of which each row is a positive multiple.
  std::vector<std::size_t> first_of_;  ///< m
};

}  // namespace checker
