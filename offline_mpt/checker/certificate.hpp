#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "lookups.hpp"
#include "program.hpp"

namespace checker {

/// What a certificate says of one region, or of a sliver that the map leaves out.
struct Claim {
  bool is_sliver = false;
  /// Active set, of a sliver only.
  std::vector<std::size_t> active;
  /// Proof that a sliver can be left out.
  std::string cover;
  Vector point;
  /// Origin of each row of the map, then of other rows.
  std::vector<std::string> listed;
  /// Proof of what lies behind each facet.
  std::vector<std::string> closings;
  /// Origins of rows that hold up to rounding only.
  std::set<std::string> forgiven;
  /// Farkas proofs by origin.
  std::map<std::string, std::pair<Integer, Weights>> proofs;
};

/// An entry of the program that counts as another number.
struct Counts {
  std::string name;
  std::size_t row = 0, column = 0;
  Fraction value;
};

struct Region {
  std::set<std::size_t> active;
  /// Conditions of optimality, domain and box, by origin.
  std::map<std::string, Row> rows;
  /// Dropped rows by origin, plus their tolerance.
  std::map<std::string, Row> dropped;
  /// In a widened certificate: slacks plus the possible rounding.
  std::map<std::string, Row> forgiven;
  std::vector<Row> listed;
  /// Number of listed rows that are rows of the map.
  std::size_t own = 0;
  /// Greatest difference between a row of the map and its condition.
  Fraction plane_error;
  Vector law;
};

/// A certificate as it was read, and the rules that it must fulfil (offline_mpt/CERTIFICATE.md). All throw
/// Refused.
class Certificate {
 public:
  Certificate(const std::string& text, const Map& map);
  void compareProblem(const std::string& problem) const;
  void check() const;
  /// Conditions that a reader must know besides "confirmed".
  std::string conditions() const;

 private:
  const Matrix& given(const std::string& name) const {
    const auto at = given_.find(name);
    return at != given_.end() ? at->second : data(name);
  }
  const Matrix& data(const std::string& name) const {
    const auto at = data_.find(name);
    require(at != data_.end(), name + " is missing");
    return at->second;
  }
  void readLine(const std::string& text, Claim*& claim);
  void checkHead() const;
  void checkSizes();
  void checkProgram() const;
  void checkConvexity() const;
  void replaceEntries();
  void countBound(const Counts& counts);
  Fraction hessian(std::size_t i, std::size_t j) const;
  std::vector<Row> optimalitySystem(const std::vector<std::size_t>& rows) const;
  std::vector<Row> limitSystem(const std::vector<std::size_t>& rows) const;
  Vector affine(const std::string& matrix, const std::string& vector, std::size_t row, int sign) const;
  Vector bound(std::size_t row) const;
  std::set<std::size_t> activeSet(std::size_t index) const;
  Region describe(std::size_t index) const;
  void addSlacks(const std::vector<Row>& z, const Integer& determinant, const std::set<std::size_t>& used,
                 Region& region) const;
  void addDomain(Region& region) const;
  void setLaw(const std::vector<Row>& z, const Integer& determinant, Region& region) const;
  void checkLaw(std::size_t index, const Region& region) const;
  void checkRows(std::size_t index, Region& region) const;
  void checkMapRows(std::size_t index, Region& region) const;
  Row relaxed(const Row& row) const;
  std::vector<Row> coveringRows(const Region& region, bool of_sliver) const;
  const Region& checkedRegion(std::size_t index) const;
  void checkPoint(const Claim& claim, const Region& region) const;
  FacetBehind checkFacetCover(std::size_t index, const Region& region, std::size_t facet) const;
  /// The regions that cover it.
  std::set<std::size_t> checkSliver(std::size_t index, const Region& region) const;
  void checkEdge(Line& line, const Row& plane) const;
  void checkCover(Line& line, const Row* plane, std::vector<const Row*> cell,
                  std::vector<std::size_t>& used) const;
  void checkLookups(const std::vector<ProvenRegion>& regions) const;

  const Map& map_;
  /// Keys of the head lines that were read.
  std::set<std::string> head_;
  /// Matrices of the program, with replaced entries.
  std::map<std::string, Matrix> data_;
  /// Original matrices of the problem, for those with replaced entries.
  std::map<std::string, Matrix> given_;
  std::set<std::size_t> equalities_, dropped_, relaxed_;
  std::vector<std::size_t> basis_;
  std::vector<Weights> implied_;
  Fraction law_tolerance_, plane_tolerance_, penalty_;
  std::vector<Counts> counts_;
  Scaling scaling_;
  std::size_t n_ = 0, m_ = 0, p_ = 0, q_ = 0;
  /// Whether coverage is that of the regions moved outwards.
  bool widened_ = false;
  bool linear_ = false;  ///< H = 0
  /// Whether H is singular and not zero.
  bool singular_ = false;
  /// Regions of the map, then slivers.
  std::vector<Claim> claims_;
  /// Lines about look-ups.
  std::vector<std::string> lookups_;
  /// Some checked regions, to be used again.
  mutable std::map<std::size_t, Region> checked_;
};

}  // namespace checker
