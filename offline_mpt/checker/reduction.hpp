#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/lookups.hpp"
#include "core/rows.hpp"

namespace checker {

/// A map's half-spaces in whole numbers, as they are and moved.
class MapRows {
 public:
  MapRows(const Map& map, const Fraction& slack);

  enum class Moved : std::uint8_t {
    kNot,
    /// Outwards by the slack.
    kSlack,
  };
  /// A row as the map numbers them; with `outside`, what it leaves out.
  const Row& at(std::int32_t row, Moved moved, bool outside) const;
  const Map& map() const { return map_; }
  const Scaling& scaling() const { return scaling_; }

 private:
  const Map& map_;
  Scaling scaling_;
  Fraction slack_;
  mutable std::map<std::pair<std::int32_t, int>, Row> known_;
};

/// A certificate that one map answers as the map does that it was reduced from (offline_mpt/CERTIFICATE.md).
/// All throw Refused.
class Reduction {
 public:
  Reduction(const std::string& text, const Map& reduced, const Map& original);
  void check();
  /// Conditions that a reader must know besides "confirmed".
  std::string conditions() const;

 private:
  using Cell = std::vector<const Row*>;

  /// What may cover a cell.
  struct Scope {
    /// Leaf of the reduced map at which the cell arrives.
    const Map::Leaf* leaf = nullptr;
    /// True: the cell is part of a region of the reduced map. False: of the original.
    bool is_claim = false;
    /// Law of the region that holds the cell, numbered as in its map.
    std::uint32_t law = 0;
    /// Candidate that must hold a sliver. -1: the cell is no sliver.
    std::int64_t candidate = -1;
    /// Whether regions of the original with the candidate's law must hold the sliver, not the candidate.
    bool owners = false;
  };

  void readHead(Line& line);
  Cell cellOf(const MapRows& rows, std::size_t region) const;
  void checkOriginal(std::size_t region) const;
  void checkReduced(std::size_t region) const;
  template <class Visit>
  void checkSides(Line& line, const MapRows& rows, std::uint32_t plane, const Cell& cell,
                  Visit&& visit) const;
  void walk(Line& line, std::uint32_t child, const Cell& cell, Scope scope, int depth) const;
  void cover(Line& line, Cell cell, const Scope& scope, int depth) const;
  void coverByBoth(Line& line, const Cell& cell, const Scope& scope, int depth) const;
  void cutByRegion(Line& line, const std::string& kind, Cell cell, const Scope& scope, int depth) const;
  void requireAllowed(const std::string& kind, std::uint32_t region, const Scope& scope) const;
  bool isCandidate(std::uint32_t region, const Scope& scope) const;
  Fraction scaleOf(std::size_t input) const;
  bool sameLaw(std::uint32_t reduced, std::uint32_t original) const;

  const Map &reduced_map_, &original_map_;
  Fraction law_tolerance_, slack_;
  /// Keys of the head lines that were read.
  std::set<std::string> head_;
  /// Where leaves of the reduced map test some rows only.
  std::optional<LookupAnswers> answers_;
  /// Proofs by region.
  std::vector<std::string> originals_, claims_;
  MapRows reduced_, original_;
  mutable std::map<std::pair<std::uint32_t, std::uint32_t>, bool> same_;
  // What the law tolerance of each input is a share of.
  mutable std::vector<Fraction> scales_;
};

}  // namespace checker
