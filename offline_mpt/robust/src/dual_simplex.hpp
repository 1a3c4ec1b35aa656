#pragma once

#include <cstdint>
#include <vector>

namespace polyfly {

/// min x_{n-1}   s.t.   x_{n-1} >= 0, the other x free,   a . x <= e . eta  for all rows
///
/// by the dual simplex method on a dense dictionary: rows can be added and eta can be changed at any time,
/// and the last basis stays dual feasible, so the next solution takes few pivots.
class DualSimplex {
 public:
  enum class Status { kOptimal, kInfeasible, kLimit };

  DualSimplex(int variables, int parameters);

  /// `tag` is handed back by tight(). `a` has n entries, `e` as many as eta.
  void addRow(int tag, const double* a, const double* e);
  void setParameters(const double* eta);
  Status solve();

  int rowCount() const { return static_cast<int>(tags_.size()); }
  double value(int variable) const;
  double objective() const { return value(n_ - 1); }

  struct TightRow {
    int tag;
    double multiplier;  ///< >= 0; sum of multiplier * a is minus the cost's gradient
  };
  /// Rows that hold with equality in the basis, by tag.
  std::vector<TightRow> tight() const;

  /// Drops the slackest rows until `count` are left (never tight ones); true when any was dropped.
  bool dropSlackest(int count);
  /// Tags of the rows that are left.
  const std::vector<int>& tags() const { return tags_; }
  std::uint64_t pivots() const { return pivots_; }

 private:
  static constexpr int kNone = -1;

  double* row(int r) { return &table_[static_cast<std::size_t>(r) * static_cast<std::size_t>(width_)]; }
  const double* row(int r) const {
    return &table_[static_cast<std::size_t>(r) * static_cast<std::size_t>(width_)];
  }
  bool isFree(int variable) const { return variable < n_ - 1; }
  void appendDictionaryRow(int variable, const double* a, const double* e);
  double constant(int r) const;
  int leavingRow(bool by_index) const;
  int enteringColumn(int leaving, bool by_index) const;
  void pivot(int leaving, int entering);
  void rebuild(const std::vector<int>& nonbasic_rows);
  void startCold();
  Status iterate();

  int n_;
  int h_;
  int width_;
  std::vector<double> eta_;
  // Rows as they were given.
  std::vector<int> tags_;
  std::vector<double> a_;
  std::vector<double> e_;
  // The dictionary: basic variable = table row . (nonbasic, eta). Variables n.. are slacks.
  std::vector<double> table_;
  std::vector<int> basic_;
  std::vector<int> nonbasic_;
  // Row of each structural variable, or kNone where it is nonbasic.
  std::vector<int> place_;
  std::vector<double> cost_;
  std::uint64_t pivots_ = 0;
  std::uint64_t since_rebuild_ = 0;
};

}  // namespace polyfly
