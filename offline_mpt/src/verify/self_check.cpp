#include "verify/self_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "lp/polytope.hpp"
#include "offline_mpt/exact_lp.hpp"
#include "offline_mpt/partition.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"
#include "support/in_parallel.hpp"
#include "support/vector_text.hpp"
#include "verify/parameter_sampler.hpp"
#include "verify/strict_qp.hpp"
#include "verify/tolerances.hpp"

namespace polyfly {
namespace {

using Verdict = StrictAnswer::Verdict;

constexpr std::uint64_t kLeastSamples = 200;
constexpr std::uint64_t kRegionsPerSample = 50;
constexpr std::uint64_t kSeed = 1;

/// Parameters in the box [-1, 1]^p of the map's own regions.
class RegionSampler {
 public:
  explicit RegionSampler(const RegionMap& map) : map_(map), p_(map.parameters().size()), solver_(static_cast<int>(p_)) {
    for (const Signal& signal : map.parameters()) {
      middle_.push_back(0.5 * (signal.lower + signal.upper));
      half_.push_back(0.5 * (signal.upper - signal.lower));
    }
  }

  /// The centre of a region; false where it has none.
  bool centre(std::size_t region, Eigen::VectorXd& theta) {
    gatherRows(region);
    t_.assign(p_, 0.0);
    double radius = 0.0;
    const int count = static_cast<int>(rows_.size() / (p_ + 1));
    if (!solver_.chebyshevInBox(rows_.data(), count, t_.data(), radius) || !(radius > 0.0)) return false;
    theta = parameter();
    return true;
  }

  /// Just behind the facet that `along` points to from that centre; false where this is outside of the box.
  bool behindFacet(const Eigen::VectorXd& along, Eigen::VectorXd& theta) {
    double nearest = 2.0 * static_cast<double>(p_);
    for (std::size_t first = 0; first < rows_.size(); first += p_ + 1) {
      double speed = 0.0, slack = rows_[first + p_];
      for (std::size_t j = 0; j < p_; ++j) {
        speed += rows_[first + j] * along[static_cast<Eigen::Index>(j)];
        slack -= rows_[first + j] * t_[j];
      }
      if (speed > 0.0) nearest = std::min(nearest, (slack + tolerance::kCheckedBehind) / speed);
    }
    for (std::size_t j = 0; j < p_; ++j) {
      t_[j] += nearest * along[static_cast<Eigen::Index>(j)];
      if (!(std::abs(t_[j]) <= 1.0)) return false;
    }
    theta = parameter();
    return true;
  }

 private:
  void gatherRows(std::size_t index) {
    rows_.clear();
    for (std::size_t j = 0; j < 2 * p_; ++j) {
      for (std::size_t k = 0; k < p_; ++k) rows_.push_back(k != j / 2 ? 0.0 : j % 2 == 0 ? 1.0 : -1.0);
      rows_.push_back(1.0);
    }
    const RegionView region = map_.region(index);
    for (std::uint32_t i = 0; i < region.row_count; ++i) {
      const double sign = region.rows[i] > 0 ? 1.0 : -1.0;
      const double* plane = map_.plane(static_cast<std::size_t>(std::abs(region.rows[i])) - 1);
      double bound = plane[p_], squared = 0.0;
      for (std::size_t j = 0; j < p_; ++j) {
        bound -= plane[j] * middle_[j];
        squared += plane[j] * half_[j] * plane[j] * half_[j];
      }
      const double factor = sign / std::sqrt(squared);
      for (std::size_t j = 0; j < p_; ++j) rows_.push_back(factor * plane[j] * half_[j]);
      rows_.push_back(factor * bound);
    }
  }

  Eigen::VectorXd parameter() const {
    Eigen::VectorXd theta(static_cast<Eigen::Index>(p_));
    for (std::size_t j = 0; j < p_; ++j) {
      const Signal& signal = map_.parameters()[j];
      theta[static_cast<Eigen::Index>(j)] = std::clamp(middle_[j] + half_[j] * t_[j], signal.lower, signal.upper);
    }
    return theta;
  }

  const RegionMap& map_;
  std::size_t p_;
  PolytopeSolver solver_;
  std::vector<double> middle_, half_, rows_, t_;
};

std::vector<Eigen::VectorXd> drawSamples(const RegionMap& map) {
  const std::uint64_t regions = map.firstFallback();
  const std::uint64_t count = kLeastSamples + regions / kRegionsPerSample;
  ParameterSampler uniform(map, kSeed, 0);
  RegionSampler sampler(map);
  std::vector<Eigen::VectorXd> samples;
  Eigen::VectorXd theta;
  for (std::uint64_t i = 0; samples.size() < count; ++i) {
    samples.push_back(uniform.uniform().theta);
    // Regions at equal distances in the list, all where they are few.
    const std::uint64_t region = regions <= count / 3 ? i % regions : (i * 3 * regions / count) % regions;
    if (!sampler.centre(region, theta)) continue;
    samples.push_back(theta);
    if (sampler.behindFacet(uniform.direction(), theta)) samples.push_back(theta);
  }
  return samples;
}

/// What one sample showed.
struct SampleFinding {
  double error = 0.0;  // as a share of the input's range
  std::string fault;
};

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
    } else if (map_.solverStatus() == toString(ExploreStatus::kComplete) && isDeep(theta) && isFeasible(theta)) {
      finding.fault = "no region holds theta = " + vectorText(theta) + ", which is feasible";
    }
    return finding;
  }

 private:
  static std::string place(std::size_t region, const Eigen::VectorXd& theta) {
    return "region " + std::to_string(region) + " at theta = " + vectorText(theta);
  }

  void checkAnswer(const Eigen::VectorXd& theta, const Eigen::VectorXd& u, std::size_t index, SampleFinding& finding) {
    const RegionView region = map_.region(index);
    std::vector<int> active;
    for (std::uint32_t i = 0; i < region.active_count; ++i) {
      if (region.active[i] >= 0 && region.active[i] < program_.rowCount()) active.push_back(region.active[i]);
    }
    const StrictAnswer answer = optimum_.solve(theta, active, tolerance::kCheckedRow * tolerance::kCheckedError * range_);
    switch (answer.verdict) {
      case Verdict::kOptimal:
        finding.error = (u - answer.u).cwiseAbs().cwiseQuotient(range_).maxCoeff();
        if (finding.error <= tolerance::kCheckedError) return;
        if (!is_strict_ && isOptimal(theta, u, answer.pushing)) {
          finding.error = 0.0;
          return;
        }
        char error[64];
        std::snprintf(error, sizeof error, "%.3g", finding.error);
        finding.fault = place(index, theta) + ": u is off by " + error + " of the input's range, u = " + vectorText(u) +
                        ", right is " + vectorText(answer.u);
        return;
      case Verdict::kInfeasible:
        if (!isNearFeasible(theta) && !isFeasible(theta))
          finding.fault = place(index, theta) + ": it answers, but the program is infeasible";
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

  /// Parameters beside theta along each axis.
  template <class Is>
  bool anyBeside(const Eigen::VectorXd& theta, const Is& is) {
    Eigen::VectorXd moved = theta;
    for (Eigen::Index j = 0; j < theta.size(); ++j) {
      const Signal& signal = program_.parameters[static_cast<std::size_t>(j)];
      const double step = tolerance::kCheckedEdge * 0.5 * (signal.upper - signal.lower);
      for (const double side : {-step, step}) {
        moved[j] = theta[j] + side;
        if (moved[j] >= signal.lower && moved[j] <= signal.upper && is(feasibility(moved))) return true;
      }
      moved[j] = theta[j];
    }
    return false;
  }

  bool isDeep(const Eigen::VectorXd& theta) {
    return feasibility(theta) != Verdict::kInfeasible &&
           !anyBeside(theta, [](Verdict verdict) { return verdict == Verdict::kInfeasible; });
  }
  bool isNearFeasible(const Eigen::VectorXd& theta) {
    return anyBeside(theta, [](Verdict verdict) { return verdict == Verdict::kOptimal; });
  }

  Rational valueAt(double constant, const Eigen::MatrixXd& rows, int row, const Eigen::VectorXd& theta) const {
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
      const auto type = is_tight[static_cast<std::size_t>(i)] != 0 ? ExactLp::Bound::kFixed : ExactLp::Bound::kUpper;
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
  bool isOptimal(const Eigen::VectorXd& theta, const Eigen::VectorXd& u, const std::vector<int>& pushing) const {
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

}  // namespace

AnswerCheck checkAnswers(const RegionMap& map, const ParametricProgram& program, int threads) {
  AnswerCheck result;
  const std::vector<Eigen::VectorXd> samples = drawSamples(map);
  const Eigen::VectorXd range = ranges(map, samples);
  std::vector<AnswerChecker> checkers(static_cast<std::size_t>(std::clamp(threads, 1, 256)),
                                      AnswerChecker(map, program, range));
  std::vector<SampleFinding> findings(samples.size());
  inParallel(samples.size(), static_cast<int>(checkers.size()), nullptr, {}, [&](std::size_t thread, std::uint64_t i) {
    findings[i] = checkers[thread].check(samples[i]);
  });
  result.samples = samples.size();
  double worst_fault = -1.0;
  for (const SampleFinding& finding : findings) {
    result.worst = std::max(result.worst, finding.error);
    if (finding.fault.empty() || !(finding.error > worst_fault)) continue;
    worst_fault = finding.error;
    result.fault = finding.fault;
  }
  return result;
}

AnswerCheck checkAnswers(const MapContent& content, const ParametricProgram& program, int threads) {
  struct alignas(64) Block {
    std::byte bytes[64];
  };
  const std::vector<std::byte> bytes = layOut(content);
  std::vector<Block> aligned(bytes.size() / sizeof(Block) + 1);
  std::memcpy(aligned.data(), bytes.data(), bytes.size());
  return checkAnswers(RegionMap::view(aligned.data(), bytes.size(), content.name), program, threads);
}

}  // namespace polyfly
