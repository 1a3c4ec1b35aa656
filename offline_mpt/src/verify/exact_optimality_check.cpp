#include "verify/exact_optimality_check.hpp"

#include <algorithm>

#include "exact_kkt/exact_equalities.hpp"
#include "exact_kkt/exact_region.hpp"

namespace polyfly {
namespace {

/// (t, 1) of the parameter, exactly.
std::vector<Rational> scaled(const ExactProgram& program, const Eigen::VectorXd& theta) {
  std::vector<Rational> t;
  for (int j = 0; j < program.p; ++j) {
    const auto index = static_cast<std::size_t>(j);
    t.push_back((Rational(theta[j]) - program.centre[index]) / program.half[index]);
  }
  t.emplace_back(1);
  return t;
}

template <class Entry>
Rational valueAt(const Entry& entry, const std::vector<Rational>& t) {
  Rational value;
  for (std::size_t j = 0; j < t.size(); ++j) value += Rational(entry(static_cast<int>(j))) * t[j];
  return value;
}

/// Whether every multiplier of an inequality and every slack is at least zero, and equalities hold
/// that follow from others without rounding.
bool meetsConditions(const ExactProgram& program, const ExactSolution& solution,
                     const std::vector<Rational>& t) {
  std::vector<char> in_system(static_cast<std::size_t>(program.m), 0);
  for (std::size_t r = 0; r < solution.rows().size(); ++r) {
    const auto row = static_cast<std::size_t>(solution.rows()[r]);
    in_system[row] = 1;
    if (program.is_equality[row]) continue;
    if (valueAt([&](int j) { return solution.multiplier(static_cast<int>(r), j); }, t) < 0) return false;
  }
  for (int i = 0; i < program.m; ++i) {
    if (in_system[static_cast<std::size_t>(i)] != 0 || program.is_dropped[static_cast<std::size_t>(i)] != 0)
      continue;
    const std::vector<Integer> slack = solution.slack(program, i);
    const Rational value = valueAt([&](int j) { return slack[static_cast<std::size_t>(j)]; }, t);
    if (program.is_equality[static_cast<std::size_t>(i)] ? value != 0 : value < 0) return false;
  }
  return true;
}

}  // namespace

bool ExactOptimalityCheck::optimal(const Eigen::VectorXd& theta, const std::vector<int>& active,
                                   Eigen::VectorXd& u) {
  if (!exact_) {
    ProgramPerturbation as_given;
    chooseBasis(*program_, program_->equalities, as_given);
    exact_ = std::make_shared<const ExactProgram>(*program_, as_given);
  }
  // A linear program need not have a unique optimum.
  if (exact_->linear) return false;
  ExactSolution solution;
  if (solution.solve(*exact_, active) != ExactStatus::kRegion) return false;
  const std::vector<Rational> t = scaled(*exact_, theta);
  if (!meetsConditions(*exact_, solution, t)) return false;
  const std::vector<Rational> law = solution.law(*exact_);
  u.resize(exact_->q);
  for (int i = 0; i < exact_->q; ++i) {
    const auto first = static_cast<std::size_t>(i) * t.size();
    u[i] = valueAt([&](int j) { return law[first + static_cast<std::size_t>(j)]; }, t).get_d();
  }
  return true;
}

}  // namespace polyfly
