#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "extensions/extended_certificate.hpp"

namespace checker {

/// The certificate of a robust map: "Robust maps" in offline_mpt/CERTIFICATE.md. The half-spaces of the feasible set are
/// the rows of a linear program in (u~_0 - K e, tau), which has the statements of any linear program. This class shows
/// what the linear program has to do with the robust MPC. Everything throws Refused.
class RobustCertificate : public ExtendedCertificate {
 public:
  using ExtendedCertificate::ExtendedCertificate;
  std::string conditions() const override;

  using Sparse = std::vector<std::pair<std::size_t, Fraction>>;

  /// y . (theta, u~_0, tau) + z . plan + sum of |term| <= bound; y is dense.
  struct PlanRow {
    struct Term {
      Fraction constant;
      Sparse z;
    };
    Fraction bound;
    Vector y;
    Sparse z;
    std::vector<Term> terms;
  };

  /// What the lines state; its sizes fit.
  const Matrices& models() const { return model_; }
  const std::vector<std::size_t>& errors() const { return errors_; }
  const std::map<std::size_t, std::pair<Fraction, Fraction>>& stateRanges() const { return state_ranges_; }
  std::size_t predictions() const { return predictions_; }
  const std::vector<PlanRow>& rows() const { return rows_; }

 private:
  /// (theta, u~_0, tau), and the plan that reaches it.
  struct Point {
    Vector y, plan;
  };
  using Simplex = std::vector<std::size_t>;

  // robust_certificate.cpp: lines.
  const char* title() const override { return "polyfly robust certificate 2"; }
  bool readFurther(const std::string& key, Line& line) override;
  bool readProgram(const std::string& key, Line& line);
  void readModel(Line& line);
  void readRow(Line& line);
  void readHalfSpace(Line& line);
  void readPoint(Line& line);
  Sparse readSparse(Line& line) const;
  void complete() override;
  void requireModel() const;
  const Matrix& model(const std::string& name) const;
  Vector preferredInput() const;
  void requireKinds(const std::string& convexity, const std::string& coverage) const override;

  // plans.cpp
  void checkProgram() const override;
  void checkPlan(const Point& point, const std::vector<Row>& rows) const;
  ProvenRegion checkRegion(std::size_t index, const Region& region) const override;
  void checkVertices(std::size_t index, const Region& region) const;
  std::set<std::size_t> pointsOf(std::size_t index) const;
  void checkSimplices(std::size_t index, const Region& region) const;
  std::vector<std::set<std::size_t>> pointsOutside(std::size_t index, const Region& region) const;
  std::vector<Row> sidesOf(const Simplex& simplex) const;
  Row atPoint(Vector t) const;
  Vector inBox(const Vector& theta) const;

  // one_step.cpp
  void checkLookups(const std::vector<ProvenRegion>& regions) const override;
  void checkStep(const Point& point, const std::vector<Row>& boundary) const;
  void checkBounds(const Point& point, const Vector& next) const;
  void noteFeasibility(const Vector& next, const std::vector<Row>& boundary) const;
  Vector successor(const Point& point, std::size_t corner) const;
  Fraction shifted(const Point& point, const Vector& shift, const Fraction& value) const;
  std::size_t endedRange(const Row& row) const;

  Matrices model_;
  std::vector<std::size_t> errors_;
  /// Bounds of the states that have any.
  std::map<std::size_t, std::pair<Fraction, Fraction>> state_ranges_;
  std::size_t predictions_ = 0;
  bool has_predictions_ = false;
  std::vector<PlanRow> rows_;
  /// (theta, u~_0, tau) and bound of each facet of the feasible set.
  std::vector<Vector> half_spaces_;
  std::vector<Point> points_;
  /// By region.
  std::map<std::size_t, std::vector<Simplex>> simplices_;
  /// Successors that no plan meets, of pairs of a vertex and a disturbance; found by check().
  mutable std::size_t lost_ = 0, left_range_ = 0, steps_ = 0;
};

}  // namespace checker
