#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/rows.hpp"

/// What look-ups answer: "Look-ups" in offline_mpt/CERTIFICATE.md.
namespace checker {

/// Tolerances of the map by which an answer may violate a half-space of its region.
constexpr int kReach = 8;

/// What lies behind a facet of a region, as its proof says.
struct FacetBehind {
  /// Nothing behind it has a solution, or it ends the domain.
  bool is_boundary = false;
  std::vector<std::size_t> regions;
};

/// What the proofs of a region show that look-ups depend on.
struct ProvenRegion {
  std::vector<FacetBehind> facets;
  /// Greatest difference of a plane from its condition.
  Fraction plane_error;
  /// Of a sliver (an extension): the regions of the map that cover it, moved outwards.
  std::set<std::size_t> covered_by;
};

using RowsOfRegion = std::function<std::vector<Row>(std::size_t)>;
/// Is told how many items of a kind are checked.
using Progress = std::function<void(const char* kind, std::size_t done, std::size_t total)>;

/// What look-ups answer, checked leaf by leaf: lookup_answers.cpp. Everything throws Refused.
class LookupAnswers {
 public:
  explicit LookupAnswers(const Map& map);
  virtual ~LookupAnswers() = default;

  /// Reads a line after `drop`.
  void readDrop(Line& line);
  /// Shows for all leaves that answers are right, and calls `visit` at each.
  void checkLeaves(const Progress& progress, const std::function<void()>& visit);

 protected:
  Vector mapRow(std::int32_t row) const { return scaling_.mapRow(map_, row); }
  Row movedRow(std::int32_t row, const Fraction& outwards) const;
  std::int32_t rowOf(std::size_t region, std::size_t row) const;

  /// A row of a region as a combination of rows on the path and of others, see CERTIFICATE.md.
  struct Drop {
    std::size_t visit = 0, row = 0;
    Fraction constant, path_weight, row_weight;
    std::vector<std::pair<std::size_t, Fraction>> rows;
  };
  std::vector<const Drop*> dropsOf(std::size_t region) const;

  const Map& map_;
  const Fraction tolerance_;
  /// Greatest rounding error of a distance in a look-up.
  Fraction rounding_;

  // The leaf at hand.
  std::vector<std::int32_t> path_;
  std::vector<std::size_t> candidates_;
  /// Which rows of each candidate a look-up tests.
  std::vector<std::uint32_t> tests_;

 private:
  /// A node or leaf, in the order of descents, and the row that leads there.
  struct Visit {
    std::uint32_t child = 0;
    std::size_t parent = 0;
    std::int32_t row = 0;
  };

  void findRounding();
  void walkTree();
  std::vector<std::int32_t> pathTo(std::size_t visit) const;
  Fraction leastInWideBox(const Vector& row) const;
  void readCandidates(std::size_t visit);
  void checkBounds(std::size_t region, std::uint32_t tests) const;

  const Scaling scaling_;
  std::vector<Visit> visits_;
  /// By region, ascending by visit.
  std::vector<std::vector<Drop>> drops_;
  /// That of the leaf at hand.
  std::size_t visit_ = 0;
};

/// Lines of a certificate about look-ups, checked against the map: what is not missed, lookup_coverage.cpp, besides what is
/// answered.
class Lookups : public LookupAnswers {
 public:
  /// `rows` gives the half-spaces of a region that count in the proof of coverage.
  Lookups(const Map& map, const Fraction& plane_tolerance, const std::vector<ProvenRegion>& regions,
          RowsOfRegion rows);

  void check(const std::vector<std::string>& lines, const Progress& progress);

 protected:
  virtual void beginWalk() {}
  /// Reads a line of an extension after `leaf walk`. False: it is none.
  virtual bool readFurther(Line&) { return false; }
  /// The half-spaces in which a candidate has its solution.
  virtual std::vector<Row> conditions(std::size_t candidate) const { return rows_(candidate); }
  /// Whether the constants of dropped rows show that a facet does not reach into a leaf.
  virtual bool dropsShowOutside() const { return true; }

  /// The part of the leaf with path rows >= mu, and these rows.
  std::vector<const Row*> cellWith(const std::vector<Row>& rows) const;

  const std::vector<ProvenRegion>& regions_;
  const RowsOfRegion rows_;
  /// Candidates of the leaf at hand, and regions that are proven not to be missed.
  std::set<std::size_t> known_;
  /// Regions of known_ whose facets count, besides candidates.
  std::vector<std::size_t> near_;

 private:
  /// What covers a cell: tested rows of candidates, moved outwards, and what lies beyond the boundary.
  struct CoverBy {
    Fraction reach;
    bool boundary = false;
  };

  void checkCoverage(const std::vector<std::string>& lines, std::size_t& next);
  void checkCover(Line& line, std::vector<const Row*> cell, const CoverBy& by) const;
  void checkWalk(Line& line, const std::vector<std::string>& lines, std::size_t& next);
  bool readWalk(Line& line);
  void checkStart(Line& line);
  void checkBehind(std::size_t region, bool is_candidate) const;
  bool isOutside(std::size_t region, std::size_t facet) const;
  void readOutside(Line& line);
  void readNear(Line& line);

  const Fraction plane_tolerance_;
  /// Of each path row of the leaf at hand, mu.
  Vector depths_;
  std::vector<Row> path_inside_;
};

inline Fraction powerOfTwo(int exponent) {
  return exponent >= 0 ? Fraction(Integer(1) << static_cast<unsigned long>(exponent))
                       : Fraction(1) / Fraction(Integer(1) << static_cast<unsigned long>(-exponent));
}

/// Rounded up to a multiple of 2^-120.
inline Fraction roundedUp(const Fraction& value) {
  const Fraction whole = value * powerOfTwo(120);
  Integer up;
  mpz_cdiv_q(up.get_mpz_t(), whole.get_num_mpz_t(), whole.get_den_mpz_t());
  return up * powerOfTwo(-120);
}

/// Whether a look-up tests a row; bit 31 stands for all rows from 31 on.
inline bool isTested(std::uint32_t bits, std::size_t row) {
  return (bits >> std::min<std::size_t>(row, 31) & 1u) != 0;
}

}  // namespace checker
