#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "rows.hpp"

/// What look-ups answer: "Look-ups" in offline_mpt/CERTIFICATE.md.
namespace checker {

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
  /// Regions of the map that cover a sliver, moved outwards.
  std::set<std::size_t> covered_by;
  /// All conditions hold in it, and not only up to rounding.
  bool is_exact = true;
};

/// Lines of a certificate about look-ups, checked against the map. Everything throws Refused.
class Lookups {
 public:
  /// `rows` gives the half-spaces of a region that count in the proof of coverage, `moved_rows` those that count in
  /// covers of slivers, and `conditions` those that are listed.
  Lookups(const Map& map, const Fraction& plane_tolerance, const std::vector<ProvenRegion>& regions,
          std::function<std::vector<Row>(std::size_t)> rows,
          std::function<std::vector<Row>(std::size_t)> moved_rows,
          std::function<std::vector<Row>(std::size_t)> conditions, bool moved);

  void check(const std::vector<std::string>& lines);

 private:
  /// A node or leaf, in the order of descents, and the row that leads there.
  struct Visit {
    std::uint32_t child = 0;
    std::size_t parent = 0;
    std::int32_t row = 0;
  };
  /// A row of a region as a combination of rows on the path and of others, see CERTIFICATE.md.
  struct Drop {
    std::size_t visit = 0, row = 0;
    Fraction constant, path_weight, row_weight;
    std::vector<std::pair<std::size_t, Fraction>> rows;
  };

  /// What covers a cell: tested rows of candidates, moved outwards, and what lies beyond the boundary.
  struct CoverBy {
    Fraction reach;
    bool boundary = false;
  };

  void requirePlainMap() const;
  void findRounding();
  void walkTree();
  std::vector<std::int32_t> pathTo(std::size_t visit) const;
  Vector mapRow(std::int32_t row) const;
  Row movedRow(std::int32_t row, const Fraction& outwards) const;
  Fraction leastInWideBox(const Vector& row) const;
  std::int32_t rowOf(std::size_t region, std::size_t row) const;

  void readDrop(Line& line);
  void checkLeaf(std::size_t visit, const std::vector<std::string>& lines, std::size_t& next);
  void checkBounds(std::size_t region, std::uint32_t tests) const;
  std::vector<const Drop*> dropsOf(std::size_t region) const;

  void checkWalk(Line& line, const std::vector<std::string>& lines, std::size_t& next);
  void checkStart(Line& line);
  void checkBehind(std::size_t region, bool is_candidate) const;
  bool isOutside(std::size_t region, std::size_t facet) const;
  void readOutside(Line& line);
  void readNear(Line& line);
  void readBeyond(Line& line);
  void readSliver(Line& line);
  std::vector<const Row*> cellWith(const std::vector<Row>& rows) const;

  void checkCover(Line& line, std::vector<const Row*> cell, const CoverBy& by) const;

  const Map& map_;
  const Scaling scaling_;
  const Fraction tolerance_, plane_tolerance_;
  const std::vector<ProvenRegion>& regions_;
  const std::function<std::vector<Row>(std::size_t)> rows_, moved_rows_, conditions_;
  /// Coverage is that of regions moved outwards.
  const bool moved_;
  /// Greatest rounding error of a distance in a look-up.
  Fraction rounding_;
  std::vector<Visit> visits_;
  /// By region, ascending by visit.
  std::vector<std::vector<Drop>> drops_;

  // The leaf at hand.
  std::size_t visit_ = 0;
  Map::Leaf leaf_ = {};
  std::vector<std::int32_t> path_;
  std::vector<std::size_t> candidates_;
  std::vector<std::uint32_t> tests_;
  Fraction depth_;
  std::vector<Row> path_inside_;
  /// Candidates, and regions that are proven not to be missed.
  std::set<std::size_t> known_;
  /// Regions that do not reach into the leaf even if they are moved outwards.
  std::set<std::size_t> beyond_;
  /// Regions of known_ whose facets count, besides candidates.
  std::vector<std::size_t> near_;
};

}  // namespace checker
