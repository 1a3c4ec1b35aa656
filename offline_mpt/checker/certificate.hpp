#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "program.hpp"

namespace checker {

/// What a certificate says of one region, or of a sliver that the map leaves out.
struct Claim {
  bool is_sliver = false;
  std::vector<std::size_t> active;  ///< of a sliver
  std::string cover;                ///< of a sliver: why it can be left out
  Vector point;
  std::vector<std::string> listed;    ///< origin of each row of the map, then of others
  std::vector<std::string> closings;  ///< how each facet is closed
  std::set<std::string> forgiven;     ///< origins that hold up to rounding
  std::map<std::string, std::pair<Integer, Weights>> proofs;  ///< by origin
};

/// An entry of the program that counts as another number.
struct Counts {
  std::string name;
  std::size_t row = 0, column = 0;
  Fraction value;
};

struct Region {
  std::set<std::size_t> active;
  std::map<std::string, Row> rows;     ///< conditions of optimality, domain and box, by origin
  std::map<std::string, Row> dropped;  ///< with what they may fall short added
  /// In a widened certificate: slacks plus the possible rounding.
  std::map<std::string, Row> forgiven;
  std::vector<Row> listed;
  std::size_t own = 0;  ///< of the listed rows, those of the map
  Vector law;
};

/// A certificate as it was read, and the rules that it must fulfil (offline_mpt/CERTIFICATE.md). All throw
/// Refused.
class Certificate {
 public:
  Certificate(const std::string& text, const Map& map);
  void compareProblem(const std::string& problem) const;
  void check() const;
  std::string conditions() const;  ///< what a reader must know beside "confirmed"

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
  void checkFacetCover(std::size_t index, const Region& region, std::size_t facet) const;
  void checkSliver(std::size_t index, const Region& region) const;
  void checkEdge(Line& line, const Row& plane) const;
  void checkCover(Line& line, const Row* plane, std::vector<const Row*> cell) const;

  const Map& map_;
  std::set<std::string> head_;           ///< its lines that were read
  std::map<std::string, Matrix> data_;   ///< what counts
  std::map<std::string, Matrix> given_;  ///< of `data_`, what was replaced, as the problem has it
  std::set<std::size_t> equalities_, dropped_, relaxed_;
  std::vector<std::size_t> basis_;
  std::vector<Weights> implied_;
  Fraction law_tolerance_, plane_tolerance_, penalty_;
  std::vector<Counts> counts_;
  Scaling scaling_;
  std::size_t n_ = 0, m_ = 0, p_ = 0, q_ = 0;
  bool widened_ = false;                           ///< coverage is that of the regions moved outwards
  bool linear_ = false;                            ///< H = 0
  bool singular_ = false;                          ///< H is otherwise
  std::vector<Claim> claims_;                      ///< regions of the map, then slivers
  mutable std::map<std::size_t, Region> checked_;  ///< some, to be used again
};

}  // namespace checker
