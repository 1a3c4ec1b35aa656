#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "certify/lookup/candidate_cover.hpp"
#include "certify/lookup/lookup_context.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

/// Proves that the candidates of a leaf answer all parameters with a solution that arrive there: see "Look-ups" in
/// CERTIFICATE.md. From a point inside of one candidate, regions are left through facets only. Behind each lies another
/// candidate, or nothing that has a solution; or the facet, or what lies behind it, does not reach into the leaf; or what
/// reaches into it lies within the tolerance of a candidate.
class LeafWalk {
 public:
  /// `visit` is the leaf's place in the tree.
  LeafWalk(const LookupContext& context, std::size_t visit);

  /// Appends the lines of the certificate. False: it cannot be proven in this way.
  bool prove(std::string& text);

 private:
  struct Start {
    std::uint32_t place = 0;
    std::vector<Rational> point;
    /// Least value of a path row that presses at the point [in the unit of the planes].
    Integer depth;
  };

  bool proveFrom(const Start& start, std::string& text);
  bool findStart(Start& start) const;
  bool tryStart(std::uint32_t place, Start& start) const;
  Integer valueAt(std::int32_t row, const std::vector<Rational>& point) const;
  bool chooseShare(const Start& start);
  bool letPress();
  bool closeFacets(std::uint32_t region, std::uint32_t place, std::string& text);
  bool isOutside(std::uint32_t place, std::uint32_t facet) const;
  bool isCandidate(std::uint32_t region) const;
  bool dismiss(std::uint32_t region, std::string& text);
  bool dismissSliver(std::uint32_t sliver, std::string& text);
  Interior interiorInside(const std::vector<ExactRow>& rows);
  std::vector<ExactRow> rowsOf(std::uint32_t region) const;
  const std::vector<ExactRow>& pathInside();

  const LookupContext& context_;
  std::size_t visit_;
  LeafView view_;
  std::vector<std::int32_t> path_;
  std::vector<std::uint32_t> candidates_;  // sorted
  CandidateCover near_candidates_;
  /// Of each path row, whether the starting point is to be deep in it, and not only inside.
  std::vector<char> presses_;
  /// Of a region that could not be dismissed, a point in the part.
  std::vector<Rational> failed_at_;
  /// What arrives is moved by this share of its way to the starting point.
  Rational share_;
  /// Of each path row, by how much it holds in the part of the leaf that the walk covers; and the least of them.
  std::vector<Integer> depths_;
  Integer least_depth_;
  std::vector<ExactRow> path_inside_;
  /// Regions that are no candidates, and do not reach into the leaf or are near a candidate there.
  std::set<std::uint32_t> dismissed_;
  /// Regions that do not reach into the leaf even if they are moved outwards.
  std::set<std::uint32_t> beyond_;
  /// Of the dismissed regions those that reach into the leaf, whose facets count.
  std::vector<std::uint32_t> near_;
};

}  // namespace polyfly
