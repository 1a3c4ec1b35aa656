#pragma once

#include <gmpxx.h>

#include <cstdint>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

/// What check_certificate reads: files, maps (region_maps/FORMAT.md), numbers, JSON problems. Shares no code
/// with what wrote them.
namespace checker {

struct Refused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file that cannot be read, which says nothing about what it holds.
struct Unreadable : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline void require(bool condition, const std::string& rule) {
  if (!condition) throw Refused(rule);
}

/// The greatest tolerances that a certificate may state: with any, anything could be confirmed.
constexpr double kMostLawTolerance = 1e-6;    ///< relative, what is promised of u
constexpr double kMostPlaneTolerance = 1e-7;  ///< [scaled]

/// Throws Unreadable where there is no file that can be read whole.
std::string readFile(const std::string& path);

/// Throws Unreadable where `path` is neither a file nor a pipe.
void requireFile(const std::string& path);
std::uint64_t xxh64(const std::string& bytes);  ///< seed 0
std::string hexText(std::uint64_t value);       ///< 16 digits

/// The parts of a region map that a certificate speaks of.
struct Map {
  explicit Map(const std::string& file);

  struct Region {
    std::uint32_t first_row, row_count, law, first_active, active_count;
  };

  /// A child with bit 31 set is a leaf.
  struct Node {
    std::uint32_t plane, below, above;
  };
  struct Leaf {
    std::uint32_t first, count;
  };
  static constexpr std::uint32_t kLeaf = 0x80000000u;

  std::uint32_t p = 0, q = 0, root = 0, first_fallback = 0;
  std::uint64_t checksum = 0, size = 0, reduced_from = 0;
  double tolerance = 0.0;
  std::string problem;             ///< text
  std::vector<std::string> words;  ///< all strings of the text section, in order
  std::vector<double> bounds;      ///< lower and upper of each parameter
  std::vector<double> planes, laws;
  std::vector<Region> regions;
  std::vector<std::int32_t> rows, active;
  std::vector<Node> nodes;
  std::vector<Leaf> leaves;
  std::vector<std::uint32_t> candidates;
  std::vector<std::uint32_t> tests;  ///< rows that leaves test; empty: all

 private:
  void readText(const std::string& file);
  void checkTables() const;
  void checkTree() const;
};

/// Words of one line.
class Line {
 public:
  explicit Line(const std::string& text) : words_(text) {}
  std::string word();
  bool done() { return (words_ >> std::ws).eof(); }
  std::size_t count(std::size_t limit);    ///< whole, at most `limit`
  mpz_class integer();                     ///< base 16
  mpq_class fraction();                    ///< base 16, as numerator/denominator
  mpq_class real();                        ///< a double as printf's %a writes it, at its exact value
  bool next(const std::string& expected);  ///< takes the next word if it is this one
  std::string rest();                      ///< all words that are left
  void end() { require(done(), "a line is longer than its rule"); }

 private:
  std::istringstream words_;
};

/// All numbers behind a key of the outermost object, in order; none where it is missing.
std::vector<double> jsonNumbers(const std::string& text, const std::string& key);

}  // namespace checker
