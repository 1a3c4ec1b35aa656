#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "rows.hpp"

namespace checker {

/// A map's half-spaces in whole numbers, as they are and moved.
class MapRows {
 public:
  MapRows(const Map& map, const Fraction& slack);

  enum class Moved : std::uint8_t {
    kNot,
    kSlack,     ///< outwards by the slack
    kHandicap,  ///< outwards by the handicap of fallback regions
  };
  /// A row as the map numbers them; with `outside`, what it leaves out.
  const Row& at(std::int32_t row, Moved moved, bool outside) const;
  const Map& map() const { return map_; }
  const Scaling& scaling() const { return scaling_; }

 private:
  const Map& map_;
  Scaling scaling_;
  Fraction slack_, handicap_;
  mutable std::map<std::pair<std::int32_t, int>, Row> known_;
};

/// A certificate that one map answers as the map does that it was reduced from (offline_mpt/CERTIFICATE.md).
/// All throw Refused.
class Reduction {
 public:
  Reduction(const std::string& text, const Map& reduced, const Map& original);
  void check() const;
  std::string conditions() const;  ///< what a reader must know beside "confirmed"

 private:
  using Cell = std::vector<const Row*>;

  /// What may cover a cell.
  struct Scope {
    const Map::Leaf* leaf = nullptr;  ///< of the reduced map, where the cell arrives
    bool is_claim = false;            ///< a part of a region of the reduced map, else of the original
    bool may_cut_ordinary = false;    ///< of a fallback region
    std::uint32_t law = 0;            ///< of that region, in its map
    std::int64_t candidate = -1;      ///< of a sliver: what holds it
    bool owners = false;              ///< of a sliver: regions with the candidate's law hold it too
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
  bool sameLaw(std::uint32_t reduced, std::uint32_t original) const;

  const Map &reduced_map_, &original_map_;
  std::uint32_t first_fallback_ = 0;
  Fraction law_tolerance_, slack_;
  std::set<std::string> head_;                   ///< its lines that were read
  std::vector<std::string> originals_, claims_;  ///< proofs by region
  MapRows reduced_, original_;
  mutable std::map<std::pair<std::uint32_t, std::uint32_t>, bool> same_;
};

}  // namespace checker
