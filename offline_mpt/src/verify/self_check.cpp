#include "verify/self_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "offline_mpt/exact_lp.hpp"
#include "offline_mpt/partition.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"
#include "support/in_parallel.hpp"
#include "support/vector_text.hpp"
#include "verify/check_samples.hpp"
#include "verify/strict_qp.hpp"
#include "verify/tolerances.hpp"

namespace polyfly {
namespace {

using Verdict = StrictAnswer::Verdict;

/// What one sample showed.
struct SampleFinding {
  double error = 0.0;  // as a share of the input's range
  std::string fault;
};

std::string place(std::size_t region, const Eigen::VectorXd& theta) {
  return "region " + std::to_string(region) + " at theta = " + vectorText(theta);
}

std::string wrongAnswer(std::size_t region, const Eigen::VectorXd& theta, double error, const std::string& u,
                        const std::string& right) {
  char share[32];
  std::snprintf(share, sizeof share, "%.3g", error);
  return place(region, theta) + ": u is off by " + share + " of the input's range, u = " + u + ", right is " +
         right;
}

std::string wrongSilence(const Eigen::VectorXd& theta) {
  return "no region holds theta = " + vectorText(theta) + ", which is feasible";
}

std::string wrongPresence(std::size_t region, const Eigen::VectorXd& theta) {
  return place(region, theta) + ": it answers, but the program is infeasible";
}

/// Whether `is` holds at a parameter beside theta along an axis.
template <class Is>
bool anyBeside(const Eigen::VectorXd& theta, const std::vector<Signal>& parameters, const Is& is) {
  Eigen::VectorXd moved = theta;
  for (Eigen::Index j = 0; j < theta.size(); ++j) {
    const Signal& signal = parameters[static_cast<std::size_t>(j)];
    const double step = tolerance::kCheckedEdge * 0.5 * (signal.upper - signal.lower);
    for (const double side : {-step, step}) {
      moved[j] = theta[j] + side;
      if (moved[j] >= signal.lower && moved[j] <= signal.upper && is(moved)) return true;
    }
    moved[j] = theta[j];
  }
  return false;
}

bool isComplete(const RegionMap& map) { return map.solverStatus() == toString(ExploreStatus::kComplete); }

/// One object for each thread.
class AnswerChecker {
 public:
  AnswerChecker(const RegionMap& map, const ParametricProgram& program, const Eigen::VectorXd& range)
      : map_(map), program_(program), range_(range), optimum_(program, Convexity::kAsGiven) {
    if (optimum_.definite()) return;
    is_strict_ = false;
    optimum_ = StrictQp(program, Convexity::kShortest);
    feasible_ = std::make_shared<StrictQp>(program, Convexity::kFeasibility);
  }

  AnswerChecker(const AnswerChecker& other)
      : map_(other.map_),
        program_(other.program_),
        range_(other.range_),
        is_strict_(other.is_strict_),
        optimum_(other.optimum_),
        feasible_(other.feasible_ ? std::make_shared<StrictQp>(*other.feasible_) : nullptr) {}

  SampleFinding check(const Eigen::VectorXd& theta) {
    SampleFinding finding;
    Eigen::VectorXd u(program_.inputCount());
    const Lookup lookup = map_.evaluate(theta.data(), u.data());
    if (lookup.status == LookupStatus::kInside) {
      checkAnswer(theta, u, lookup.region, finding);
    } else if (isComplete(map_) && isDeep(theta) && isFeasible(theta)) {
      finding.fault = wrongSilence(theta);
    }
    return finding;
  }

 private:
  void checkAnswer(const Eigen::VectorXd& theta, const Eigen::VectorXd& u, std::size_t index,
                   SampleFinding& finding) {
    const RegionView region = map_.region(index);
    std::vector<int> active;
    for (std::uint32_t i = 0; i < region.active_count; ++i) {
      if (region.active[i] >= 0 && region.active[i] < program_.rowCount()) active.push_back(region.active[i]);
    }
    const StrictAnswer answer =
        optimum_.solve(theta, active, tolerance::kCheckedRow * tolerance::kCheckedError * range_);
    switch (answer.verdict) {
      case Verdict::kOptimal:
        finding.error = (u - answer.u).cwiseAbs().cwiseQuotient(range_).maxCoeff();
        if (finding.error <= tolerance::kCheckedError) return;
        if (!is_strict_ && isOptimal(theta, u, answer.pushing)) {
          finding.error = 0.0;
          return;
        }
        finding.fault = wrongAnswer(index, theta, finding.error, vectorText(u), vectorText(answer.u));
        return;
      case Verdict::kInfeasible:
        if (!isNearFeasible(theta) && !isFeasible(theta)) finding.fault = wrongPresence(index, theta);
        return;
      case Verdict::kUndecided:
        finding.fault = place(index, theta) + ": the optimum could not be found";
        return;
    }
  }

  Verdict feasibility(const Eigen::VectorXd& theta) {
    for (Eigen::Index i = 0; i < program_.A_theta.rows(); ++i) {
      if (program_.A_theta.row(i).dot(theta) > program_.b_theta[i]) return Verdict::kInfeasible;
    }
    StrictQp& qp = feasible_ ? *feasible_ : optimum_;
    return qp.solve(theta, {}, tolerance::kCheckedRow * tolerance::kCheckedError * range_).verdict;
  }

  bool isDeep(const Eigen::VectorXd& theta) {
    const auto is_infeasible = [&](const Eigen::VectorXd& at) {
      return feasibility(at) == Verdict::kInfeasible;
    };
    return !is_infeasible(theta) && !anyBeside(theta, program_.parameters, is_infeasible);
  }
  bool isNearFeasible(const Eigen::VectorXd& theta) {
    return anyBeside(theta, program_.parameters,
                     [&](const Eigen::VectorXd& at) { return feasibility(at) == Verdict::kOptimal; });
  }

  Rational valueAt(double constant, const Eigen::MatrixXd& rows, int row,
                   const Eigen::VectorXd& theta) const {
    Rational value(constant);
    for (Eigen::Index j = 0; j < theta.size(); ++j) value += Rational(rows(row, j)) * Rational(theta[j]);
    return value;
  }

  /// Variables z, and the rows of the program at theta.
  ExactLp rowsAt(const Eigen::VectorXd& theta, const std::vector<int>& tight) const {
    ExactLp lp;
    lp.addColumns(program_.variableCount());
    lp.addRows(program_.rowCount());
    for (int j = 0; j < program_.variableCount(); ++j) lp.setColumnBounds(j, ExactLp::Bound::kFree, 0, 0);
    std::vector<char> is_tight(static_cast<std::size_t>(program_.rowCount()), 0);
    for (const std::vector<int>* rows : {&program_.equalities, &tight}) {
      for (const int row : *rows) is_tight[static_cast<std::size_t>(row)] = 1;
    }
    for (int i = 0; i < program_.rowCount(); ++i) {
      const Rational bound = valueAt(program_.b[i], program_.S, i, theta);
      const auto type =
          is_tight[static_cast<std::size_t>(i)] != 0 ? ExactLp::Bound::kFixed : ExactLp::Bound::kUpper;
      lp.setRowBounds(i, type, bound, bound);
      for (int j = 0; j < program_.variableCount(); ++j) {
        if (program_.A(i, j) != 0.0) lp.setCoefficient(i, j, Rational(program_.A(i, j)));
      }
    }
    return lp;
  }

  bool isFeasible(const Eigen::VectorXd& theta) const {
    ExactLp lp = rowsAt(theta, {});
    return lp.solve() == ExactLp::Status::kOptimal;
  }

  /// Whether an optimum has this output, of a cost that is not strictly convex: H z + g + A' lambda = 0 with multipliers of
  /// the rows that push, all of them tight.
  bool isOptimal(const Eigen::VectorXd& theta, const Eigen::VectorXd& u,
                 const std::vector<int>& pushing) const {
    ExactLp lp = rowsAt(theta, pushing);
    const int n = program_.variableCount(), q = program_.inputCount();
    const int multipliers = lp.addColumns(static_cast<int>(pushing.size()));
    for (std::size_t k = 0; k < pushing.size(); ++k) {
      const bool free = std::count(program_.equalities.begin(), program_.equalities.end(), pushing[k]) > 0;
      if (free) lp.setColumnBounds(multipliers + static_cast<int>(k), ExactLp::Bound::kFree, 0, 0);
    }
    const int stationary = lp.addRows(n);
    for (int i = 0; i < n; ++i) {
      const Rational value = -valueAt(program_.f[i], program_.F, i, theta);
      lp.setRowBounds(stationary + i, ExactLp::Bound::kFixed, value, value);
      for (int j = 0; j < n; ++j) {
        if (program_.H(i, j) != 0.0) lp.setCoefficient(stationary + i, j, Rational(program_.H(i, j)));
      }
      for (std::size_t k = 0; k < pushing.size(); ++k) {
        const double a = program_.A(pushing[k], i);
        if (a != 0.0) lp.setCoefficient(stationary + i, multipliers + static_cast<int>(k), Rational(a));
      }
    }
    const int outputs = lp.addRows(q);
    for (int k = 0; k < q; ++k) {
      const Rational value = Rational(u[k]) - valueAt(program_.c[k], program_.C, k, theta);
      const Rational width(tolerance::kCheckedError * range_[k]);
      lp.setRowBounds(outputs + k, ExactLp::Bound::kDouble, value - width, value + width);
      for (int j = 0; j < n; ++j) {
        if (program_.E(k, j) != 0.0) lp.setCoefficient(outputs + k, j, Rational(program_.E(k, j)));
      }
    }
    return lp.solve() == ExactLp::Status::kOptimal;
  }

  const RegionMap& map_;
  const ParametricProgram& program_;
  const Eigen::VectorXd& range_;
  bool is_strict_ = true;
  StrictQp optimum_;
  // Of a cost that is not strictly convex.
  std::shared_ptr<StrictQp> feasible_;
};

/// Ranges of the inputs; without one, the greatest |u| at the samples.
Eigen::VectorXd ranges(const RegionMap& map, const std::vector<Eigen::VectorXd>& samples) {
  const auto q = static_cast<Eigen::Index>(map.inputs().size());
  Eigen::VectorXd greatest = Eigen::VectorXd::Constant(q, tolerance::kNoOutput), u(q);
  for (const Eigen::VectorXd& theta : samples) {
    if (map.evaluate(theta.data(), u.data()).status == LookupStatus::kInside)
      greatest = greatest.cwiseMax(u.cwiseAbs());
  }
  for (Eigen::Index k = 0; k < q; ++k) {
    const Signal& signal = map.inputs()[static_cast<std::size_t>(k)];
    const double range = signal.upper - signal.lower;
    if (std::isfinite(range) && range > 0.0) greatest[k] = range;
  }
  return greatest;
}

/// The first of the worst faults counts.
AnswerCheck summary(const std::vector<SampleFinding>& findings) {
  AnswerCheck result;
  result.samples = findings.size();
  double worst_fault = -1.0;
  for (const SampleFinding& finding : findings) {
    result.worst = std::max(result.worst, finding.error);
    if (finding.fault.empty() || !(finding.error > worst_fault)) continue;
    worst_fault = finding.error;
    result.fault = finding.fault;
  }
  return result;
}

/// A map that is not written yet, laid out as it will be.
class LaidOut {
 public:
  explicit LaidOut(const MapContent& content) {
    const std::vector<std::byte> bytes = layOut(content);
    blocks_.resize(bytes.size() / sizeof(Block) + 1);
    std::memcpy(blocks_.data(), bytes.data(), bytes.size());
    map_.emplace(RegionMap::view(blocks_.data(), bytes.size(), content.name));
  }
  const RegionMap& map() const { return *map_; }

 private:
  struct alignas(64) Block {
    std::byte bytes[64];
  };
  std::vector<Block> blocks_;
  std::optional<RegionMap> map_;
};

}  // namespace

AnswerCheck checkAnswers(const RegionMap& map, const ParametricProgram& program, int threads) {
  const std::vector<Eigen::VectorXd> samples = checkSamples(map);
  const Eigen::VectorXd range = ranges(map, samples);
  std::vector<AnswerChecker> checkers(static_cast<std::size_t>(std::clamp(threads, 1, 256)),
                                      AnswerChecker(map, program, range));
  std::vector<SampleFinding> findings(samples.size());
  inParallel(samples.size(), static_cast<int>(checkers.size()), nullptr, {},
             [&](std::size_t thread, std::uint64_t i) { findings[i] = checkers[thread].check(samples[i]); });
  return summary(findings);
}

AnswerCheck checkAnswers(const MapContent& content, const ParametricProgram& program, int threads) {
  return checkAnswers(LaidOut(content).map(), program, threads);
}

AnswerCheck checkAnswers(const MapContent& content,
                         const std::function<std::optional<double>(const double* theta)>& first_input) {
  const LaidOut laid_out(content);
  const RegionMap& map = laid_out.map();
  const std::vector<Eigen::VectorXd> samples = checkSamples(map);
  const Eigen::VectorXd range = ranges(map, samples);
  const auto has_answer = [&](const Eigen::VectorXd& theta) { return first_input(theta.data()).has_value(); };
  const auto has_none = [&](const Eigen::VectorXd& theta) { return !has_answer(theta); };
  std::vector<SampleFinding> findings;
  Eigen::VectorXd u(range.size());
  for (const Eigen::VectorXd& theta : samples) {
    SampleFinding finding;
    const Lookup lookup = map.evaluate(theta.data(), u.data());
    const std::optional<double> right = first_input(theta.data());
    if (lookup.status != LookupStatus::kInside) {
      if (right && isComplete(map) && !anyBeside(theta, map.parameters(), has_none))
        finding.fault = wrongSilence(theta);
    } else if (right) {
      finding.error = std::abs(u[0] - *right) / range[0];
      if (!(finding.error <= tolerance::kCheckedError))
        finding.fault =
            wrongAnswer(lookup.region, theta, finding.error, std::to_string(u[0]), std::to_string(*right));
    } else if (!anyBeside(theta, map.parameters(), has_answer)) {
      finding.fault = wrongPresence(lookup.region, theta);
    }
    findings.push_back(std::move(finding));
  }
  return summary(findings);
}

}  // namespace polyfly
