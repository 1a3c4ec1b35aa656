#pragma once

#include <set>
#include <string>
#include <vector>

#include "core/certificate.hpp"

namespace checker {

/// Whether a line, by its first words, belongs to an extension.
bool isOfExtension(const std::string& line);

/// Certificates of programs that are degenerate or linear, of maps that leave slivers to their neighbours,
/// and of widened coverage (offline_mpt/CERTIFICATE.md). Everything throws Refused.
class ExtendedCertificate : public Certificate {
 public:
  using Certificate::Certificate;
  std::string conditions() const override;

 protected:
  // extended_certificate.cpp
  bool readFurther(const std::string& key, Line& line) override;
  void requireKinds(const std::string& convexity, const std::string& coverage) const override;
  ProvenRegion checkRegion(std::size_t index, const Region& region) const override;
  void checkLookups(const std::vector<ProvenRegion>& regions) const override;
  // degenerate_program.cpp
  void checkProgram() const override;

 private:
  /// What the lines of extensions say of one region.
  struct FurtherClaim {
    /// Active set, of a sliver only.
    std::vector<std::size_t> active;
    /// Proof that a sliver can be left out.
    std::string cover;
    /// Origins of rows that hold up to rounding only.
    std::set<std::string> tolerated;
  };
  bool isLinear() const { return convexity() == "linear"; }
  bool isWidened() const { return coverage() == "widened"; }

  // extended_certificate.cpp
  void requireCount(std::size_t claims) const override;

  // degenerate_program.cpp
  void finish() override;
  std::set<std::size_t> equalityRows() const;
  bool isLeftOut(std::size_t row) const override { return dropped_.count(row) > 0; }
  void addSlack(std::size_t i, const Slack& slack, Region& region) const override;

  // linear_program.cpp
  Optimum optimum(const std::vector<std::size_t>& rows) const override;
  std::vector<Row> linearSystem(const std::vector<std::size_t>& rows) const;

  // slivers.cpp
  bool isSliver(std::size_t index) const { return index >= map().regions.size(); }
  const FurtherClaim& further(std::size_t index) const;
  std::set<std::size_t> activeSet(std::size_t index) const override;
  void checkHalfSpaces(std::size_t index, Region& region) const override;
  Row movedOutwards(const Row& row) const;
  /// The map's rows of a region, moved outwards.
  std::vector<Row> movedRows(const Region& region) const;
  std::set<std::size_t> checkSliver(std::size_t index, const Region& region) const;
  void checkMovedCover(Line& line, const Row* plane, std::vector<const Row*> cell,
                       std::vector<std::size_t>& used) const;
  FacetBehind checkFacet(std::size_t index, const Region& region, std::size_t facet) const override;

  std::set<std::size_t> dropped_;
  /// Of |z|^2, as binary logarithms. None: they are all the same.
  std::vector<std::size_t> weights_;
  std::vector<Weights> implied_;
  /// By region, as far as there are lines.
  std::vector<FurtherClaim> further_;
};

}  // namespace checker
