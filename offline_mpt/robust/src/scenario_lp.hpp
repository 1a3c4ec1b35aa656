#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "dual_simplex.hpp"
#include "robust_mpc/robust_program.hpp"

namespace polyfly {

/// a . x + sum_t |ta_t . x + te_t . eta| <= e . eta
struct ScenarioRow {
  struct Term {
    Eigen::VectorXd a;
    Eigen::VectorXd e;
  };
  Eigen::VectorXd a;
  Eigen::VectorXd e;
  std::vector<Term> terms;
};

/// The row with its z first among `variables`, and without y. Constants of terms stand at place `constants` of (a, e).
ScenarioRow scenarioRow(const RobustProgram::Row& row, Eigen::Index variables, Eigen::Index parameters,
                        Eigen::Index constants);

/// One linear piece of a row: the signs with which its terms count, as bits (set: minus).
struct Scenario {
  int row = 0;
  std::vector<bool> negative;
  bool operator<(const Scenario& other) const {
    return row != other.row ? row < other.row : negative < other.negative;
  }
};

/// min x_{n-1} as DualSimplex does, over rows with absolute values: each is a worst case, and only the
/// scenarios that were violated on the way become rows of the simplex method.
class ScenarioLp {
 public:
  /// Rows are scaled so that their greatest coefficient is 1.
  ScenarioLp(int variables, int parameters, std::vector<ScenarioRow> rows);

  DualSimplex::Status solve(const Eigen::VectorXd& eta);
  Eigen::VectorXd x() const;
  double objective() const { return simplex_.objective(); }

  struct Tight {
    Scenario scenario;
    /// Multiplier of the row as it was given.
    double multiplier;
  };
  std::vector<Tight> tight() const;
  std::uint64_t pivots() const { return simplex_.pivots(); }

 private:
  bool addViolated(const Eigen::VectorXd& eta);
  void add(Scenario scenario);
  void forget();

  int n_;
  std::vector<ScenarioRow> rows_;
  std::vector<double> scale_;
  // Scenarios by tag.
  std::vector<Scenario> scenarios_;
  // Tags of the scenarios that are rows of the simplex now.
  std::map<Scenario, int> tags_;
  DualSimplex simplex_;
};

}  // namespace polyfly
