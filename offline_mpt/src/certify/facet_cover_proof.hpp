#pragma once

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "certify/facet_cover.hpp"
#include "certify/region_check.hpp"

namespace polyfly {

/// How a facet was closed.
enum class FacetCoverKind : std::uint8_t { kDomain, kEdge, kMatched, kCovered, kOpen };

/// What lies behind a facet.
struct FacetBehind {
  FacetCoverKind kind = FacetCoverKind::kOpen;
  /// Regions behind a facet that is matched or covered, some more than once.
  std::vector<std::uint32_t> regions;
};

/// Decides for each facet of each region what lies behind it. Read-only after construction.
class FacetCoverProof {
 public:
  /// `widened`: half-spaces of the map count as moved outwards by the plane tolerance.
  FacetCoverProof(const CheckContext& context, const std::vector<RegionCheck>& checks, bool widened);

  /// Appends the facet's line of the certificate to `text`, or a defect to `defects`.
  FacetBehind close(std::uint32_t region, std::uint32_t row, std::string& text,
                    std::vector<Defect>& defects) const;

  /// Region with this active set, -1 if there is none.
  int find(const std::vector<int>& active) const;

  bool stopped() const { return context_.stopped(); }

 private:
  const std::vector<ExactRow>& rowsOf(std::uint32_t region, std::deque<std::vector<ExactRow>>& storage) const;
  bool proveEdge(const RegionCheck& check, const std::vector<ExactOrigin>& origins, std::string& text) const;
  /// Whether the region, with an inner point, has that behind the plane.
  bool reachesBehind(std::uint32_t region, const std::vector<ExactRow>& rows, const ExactRow& plane) const;
  std::vector<CoverCandidate> behind(std::uint32_t region, const ExactRow& plane,
                                     std::deque<std::vector<ExactRow>>& storage) const;
  FacetBehind closeByCover(std::uint32_t region, std::uint32_t row, const std::vector<ExactRow>& listed,
                           std::string& text, std::vector<Defect>& defects,
                           std::vector<Rational>& uncovered) const;
  FacetBehind closeWidened(std::uint32_t region, std::uint32_t row, std::string& text,
                           std::vector<Defect>& defects) const;
  FacetBehind addGap(std::uint32_t region, std::uint32_t row, const ExactRow& plane,
                     const std::vector<Rational>& uncovered, std::vector<Defect>& defects) const;
  void findMissing(const RegionCheck& check, const ExactRow& plane, const std::vector<Rational>& uncovered,
                   Defect& defect) const;
  bool liesBehind(const std::vector<int>& active, const std::vector<Rational>& uncovered,
                  std::vector<Rational>& point) const;

  const CheckContext& context_;
  const std::vector<RegionCheck>& checks_;
  /// Of each region of the map, moved outwards; empty unless widened.
  std::vector<std::vector<ExactRow>> wide_;
  std::map<std::vector<int>, std::uint32_t> by_active_set_;
  // Planes of the map without relaxation, with unit normals in t.
  std::vector<std::vector<double>> planes_;
  // Users of each plane: region + 1, negative where the plane is negated.
  std::vector<std::vector<std::int32_t>> users_;
};

/// The active set across a facet of this origin, if one row changes: the row of a multiplier or cost multiplier leaves,
/// that of a slack joins.
std::vector<int> changedSet(std::vector<int> active, const ExactOrigin& origin);

}  // namespace polyfly
