#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/lookups.hpp"
#include "core/program.hpp"

namespace checker {

/// What a certificate says of one region.
struct Claim {
  Vector point;
  /// Origin of each row.
  std::vector<std::string> listed;
  /// Proof of what lies behind each row.
  std::vector<std::string> facet_proofs;
  /// Proofs that a row follows from listed ones, by the key of their line and the row's origin.
  std::map<std::string, std::pair<Integer, Weights>> proofs;
};

struct Region {
  std::set<std::size_t> active;
  /// Conditions of optimality, domain and box, by origin.
  std::map<std::string, Row> rows;
  /// Rows of extensions that must follow too, by the key of their proof and their origin.
  std::map<std::string, Row> further;
  std::vector<Row> listed;
  /// Number of listed rows that are rows of the map.
  std::size_t own = 0;
  /// Greatest difference between a row of the map and its condition.
  Fraction plane_error;
  Vector law;
};

/// The solution of the optimality conditions of one active set, affine in t.
struct Optimum {
  Integer determinant;
  /// Variables times the determinant, p + 1 numbers each.
  std::vector<Row> z;
  /// Conditions of the active rows, by origin.
  std::map<std::string, Row> multipliers;
};

/// Slack of an inequality in t: row (t, 1) >= 0.
struct Slack {
  Row value;
  /// The greatest entry of the inequality, in the same unit.
  Integer size = 0;
};

/// The certificate of a strictly convex program, as it was read, and the statements of offline_mpt/CERTIFICATE.md, with
/// one file for each. An extension overrides how it reads a line or shows a statement. Everything throws Refused.
class Certificate {
 public:
  explicit Certificate(const Map& map);
  virtual ~Certificate() = default;

  /// Reads all lines. Must be called once, before all others.
  void read(const std::string& text);
  /// The statements, region by region, then of look-ups.
  void check() const;
  Progress progress = [](const char*, std::size_t, std::size_t) {};
  /// The numbers of the program, and its equalities.
  const Matrices& program() const { return data_; }
  const std::set<std::size_t>& equalities() const { return equalities_; }
  /// What a reader must know besides "confirmed".
  virtual std::string conditions() const;

 protected:
  const Matrix& data(const std::string& name) const;
  const Map& map() const { return map_; }

  // Reading: certificate.cpp.
  /// The first line.
  virtual const char* title() const { return "polyfly certificate 6"; }
  /// Reads the rest of a line of an extension. False: there is no such line.
  virtual bool readFurther(const std::string&, Line&) { return false; }
  /// After all lines: an extension may have the program's numbers from its own.
  virtual void complete() {}
  /// After complete(): the program has its final numbers.
  virtual void finish() {}
  const std::string& convexity() const { return convexity_; }
  const std::string& coverage() const { return coverage_; }
  virtual void requireKinds(const std::string& convexity, const std::string& coverage) const;
  virtual void requireCount(std::size_t claims) const;
  /// Whether the program is strictly convex, and all regions and all half-spaces of each are in the map.
  bool statesBounds() const;
  /// The rest of a line that begins with `key`: the origin of a row of the last claim, and why it follows.
  void readFollows(const std::string& key, Line& line);
  Claim& lastClaim(const std::string& key);

  // 1, optimality: optimality.cpp.
  virtual void checkProgram() const;
  void checkConvexity() const;
  void checkUniqueness() const;
  virtual std::set<std::size_t> activeSet(std::size_t index) const;
  void addActive(std::int64_t row, std::set<std::size_t>& active) const;
  virtual Optimum optimum(const std::vector<std::size_t>& rows) const;
  virtual void addSlack(std::size_t i, const Slack& slack, Region& region) const;
  Fraction hessian(std::size_t i, std::size_t j) const;
  Vector affine(const std::string& matrix, const std::string& vector, std::size_t row, int sign) const;
  Vector bound(std::size_t i) const { return affine("S", "b", i, 1); }
  bool isInBasis(std::size_t row) const;
  Region describe(std::size_t index) const;

  // 2, half-spaces: half_spaces.cpp.
  virtual void checkHalfSpaces(std::size_t index, Region& region) const;
  void checkMapRows(std::size_t index, Region& region) const;
  std::vector<const Row*> distinctRows(const Region& region) const;
  void requireFollows(const Claim& claim, const std::string& key, const Row& row,
                      const std::vector<const Row*>& from) const;
  /// A region whose conditions, half-spaces and inner point are checked.
  const Region& checkedRegion(std::size_t index) const;

  // 3, laws: laws.cpp.
  Fraction sizeOf(std::size_t input) const;
  void checkLaw(std::size_t index, const Region& region) const;

  // 4, coverage: coverage.cpp.
  virtual FacetBehind checkFacet(std::size_t index, const Region& region, std::size_t facet) const;
  virtual bool isLeftOut(std::size_t row) const;
  void checkBoundary(Line& line, const Row& plane) const;

  /// Statements 3 and 4; checkedRegion has shown 1 and 2.
  virtual ProvenRegion checkRegion(std::size_t index, const Region& region) const;
  ProvenRegion proveFacets(std::size_t index, const Region& region) const;
  /// 6, look-ups: lookups.hpp.
  virtual void checkLookups(const std::vector<ProvenRegion>& regions) const;

  Matrices data_;
  std::set<std::size_t> equalities_;
  /// Independent rows that hold with "=" everywhere.
  std::vector<std::size_t> basis_;
  Fraction law_tolerance_, plane_tolerance_, penalty_;
  Scaling scaling_;
  std::size_t n_ = 0, m_ = 0, p_ = 0, q_ = 0;
  std::vector<Claim> claims_;
  /// Lines about look-ups.
  std::vector<std::string> lookups_;

 private:
  bool readHead(const std::string& key, Line& line);
  bool readRegion(const std::string& key, Line& line);
  void checkHead() const;
  std::string boundsOfAnswers(double up) const;
  void checkSizes();
  void addSlackOf(std::size_t i, const Optimum& solution, Region& region) const;
  void addDomain(Region& region) const;
  void checkPoint(const Claim& claim, const Region& region) const;
  std::size_t nextRegion(Line& line, const Region& region, const Row& plane) const;
  void checkCover(Line& line, const Row& plane, std::vector<const Row*> cell,
                  std::vector<std::size_t>& used) const;

  const Map& map_;
  std::string convexity_, coverage_;
  /// Keys of the head lines that were read.
  std::set<std::string> head_;
  /// What each input's law tolerance is a share of at most.
  mutable std::vector<Fraction> input_sizes_;
  /// Greatest difference of a law in the box, what its tolerance is a share of, and change of u from the centre of the box;
  /// found by check().
  mutable Fraction law_error_, greatest_scale_, greatest_change_;
  /// Some checked regions, to be used again.
  mutable std::map<std::size_t, Region> checked_;
};

/// The rows of a region that does not lie along the plane cut the cell: what is outside of each is empty, or `cover`
/// reads its proof. The rows that cut so join the cell.
void readCut(Line& line, const Row& row, const Row* plane, std::vector<const Row*>& cell,
             const std::function<void(const std::vector<const Row*>&)>& cover);

}  // namespace checker
