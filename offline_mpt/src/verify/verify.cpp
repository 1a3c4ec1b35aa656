#include "offline_mpt/verify.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "offline_mpt/partition.hpp"
#include "polyfly_base/error.hpp"
#include "program/scaled_program.hpp"
#include "region_maps/region_map.hpp"
#include "support/in_parallel.hpp"
#include "verify/exact_optimality_check.hpp"
#include "verify/parameter_sampler.hpp"
#include "verify/program_oracle.hpp"
#include "verify/same_signals.hpp"
#include "verify/tolerances.hpp"

namespace polyfly {
namespace {

constexpr std::uint64_t kBlock = 256;   // samples drawn from one generator, checked by one thread
constexpr std::uint64_t kRound = 4096;  // blocks whose reports are kept in memory at a time

void note(Finding& finding, double measure, const Eigen::VectorXd& theta) {
  ++finding.count;
  if (finding.example.size() == 0 || measure > finding.worst) {
    finding.worst = measure;
    finding.example = theta;
  }
}

void merge(Finding& total, const Finding& part) {
  if (part.count == 0) return;
  if (total.count == 0 || part.worst > total.worst) {
    total.worst = part.worst;
    total.example = part.example;
  }
  total.count += part.count;
}

void merge(VerifyReport& total, const VerifyReport& part) {
  total.samples += part.samples;
  total.uniform += part.uniform;
  total.inside += part.inside;
  total.compared += part.compared;
  total.settled += part.settled;
  total.infeasible += part.infeasible;
  total.borderline += part.borderline;
  total.max_error = std::max(total.max_error, part.max_error);
  if (part.max_scaled_error > total.max_scaled_error || total.max_error_theta.size() == 0) {
    total.max_scaled_error = std::max(total.max_scaled_error, part.max_scaled_error);
    total.max_error_theta = part.max_error_theta;
  }
  merge(total.errors, part.errors);
  merge(total.missed, part.missed);
  merge(total.false_inside, part.false_inside);
  merge(total.overlaps, part.overlaps);
  merge(total.tree_errors, part.tree_errors);
  merge(total.unbounded, part.unbounded);
  merge(total.undecided, part.undecided);
  merge(total.empty_regions, part.empty_regions);
  total.oracle_residual = std::max(total.oracle_residual, part.oracle_residual);
  total.oracle_iterations = std::max(total.oracle_iterations, part.oracle_iterations);
}

/// What errors of each input are shares of: its range, or the greatest |u| of samples where it has none.
Eigen::VectorXd inputSizes(const RegionMap& map, const ParametricProgram& program, std::uint64_t seed) {
  Eigen::VectorXd greatest = Eigen::VectorXd::Zero(program.inputCount()), u = greatest;
  ParameterSampler sampler(map, seed, 0);
  for (std::uint64_t i = 0; i < kBlock; ++i) {
    const bool uniform = i % 2 == 0 || map.regionCount() == 0;
    const Eigen::VectorXd theta = (uniform ? sampler.uniform() : sampler.degenerate()).theta;
    if (map.evaluate(theta.data(), u.data()).status == LookupStatus::kInside)
      greatest = greatest.cwiseMax(u.cwiseAbs());
  }
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const Signal& input = program.inputs[static_cast<std::size_t>(i)];
    const double range = input.upper - input.lower;
    if (range > 0.0 && range < tolerance::kNoRange) greatest(i) = range;
    if (greatest(i) == 0.0) greatest(i) = 1.0;
  }
  return greatest;
}

/// Checks samples with work space of its own: one per thread.
class Checker {
 public:
  Checker(const RegionMap& map, const ParametricProgram& program, const ScaledProgram& scaled,
          const VerifyOptions& options)
      : map_(map),
        options_(options),
        units_(scaled.outputs),
        sizes_(inputSizes(map, program, options.seed)),
        oracle_(scaled.program),
        arbiter_(program),
        u_(program.inputCount()),
        hit_(map.regionCount(), 0) {}

  VerifyReport checkBlock(std::uint64_t block) {
    VerifyReport report;
    ParameterSampler sampler(map_, options_.seed, block);
    const std::uint64_t first = block * kBlock, last = std::min(options_.samples, first + kBlock);
    for (std::uint64_t i = first; i < last; ++i) {
      const bool uniform = i % 2 == 0 || map_.regionCount() == 0;
      const ParameterSampler::Sample sample = uniform ? sampler.uniform() : sampler.degenerate();
      ++report.samples;
      if (uniform) ++report.uniform;
      if (sample.radius <= 0.0) note(report.empty_regions, -sample.radius, sample.theta);
      checkSample(sample.theta, report);
    }
    return report;
  }

  bool strictlyConvex() const { return oracle_.strictlyConvex(); }
  const std::vector<char>& hit() const { return hit_; }

 private:
  void checkSample(const Eigen::VectorXd& theta, VerifyReport& report) {
    const Lookup lookup = map_.evaluate(theta.data(), u_.data());
    const bool inside = lookup.status == LookupStatus::kInside;
    if (inside) {
      ++report.inside;
      hit_[lookup.region] = 1;
      if (oracle_.strictlyConvex()) checkOverlap(theta, lookup.region, report);
    }
    const bool search_differs = searchDiffers(theta, lookup);
    const OracleAnswer answer = oracle_.solve(theta);
    report.oracle_iterations = std::max(report.oracle_iterations, answer.iterations);
    switch (answer.verdict) {
      case OracleAnswer::Verdict::kFeasible:
        report.oracle_residual = std::max(report.oracle_residual, answer.residual);
        if (inside) compare(theta, lookup.region, answer, report);
        if (!inside || search_differs)
          checkByPlace(theta, inside ? report.tree_errors : report.missed, report);
        break;
      case OracleAnswer::Verdict::kInfeasible:
        ++report.infeasible;
        if (inside || search_differs)
          checkByDistance(theta, inside ? report.false_inside : report.tree_errors, report);
        break;
      case OracleAnswer::Verdict::kUnbounded:
        checkByPlace(theta, report.unbounded, report);
        break;
      case OracleAnswer::Verdict::kUndecided:
        checkByPlace(theta, report.undecided, report);
        break;
    }
  }

  bool searchDiffers(const Eigen::VectorXd& theta, const Lookup& lookup) const {
    const Lookup exhaustive = map_.locateExhaustively(theta.data());
    const bool inside = lookup.status == LookupStatus::kInside;
    if (lookup.status != exhaustive.status || (inside && !map_.contains(lookup.region, theta.data())))
      return true;
    if (!inside || isFallback(lookup.region) == isFallback(exhaustive.region)) return false;
    return difference(theta, lookup.law, exhaustive.law) > options_.tolerance;
  }

  bool isFallback(std::size_t region) const { return region >= map_.firstFallback(); }

  /// Greatest |u - other|, each as a share of its input's size.
  double share(const Eigen::VectorXd& u, const Eigen::VectorXd& other) const {
    return (u - other).cwiseAbs().cwiseQuotient(sizes_).maxCoeff();
  }

  Eigen::VectorXd inUnits(Eigen::VectorXd u, int sign) const {
    for (Eigen::Index i = 0; i < u.size(); ++i)
      u(i) = std::ldexp(u(i), sign * units_[static_cast<std::size_t>(i)]);
    return u;
  }

  /// Of two laws, as `share`.
  double difference(const Eigen::VectorXd& theta, std::uint32_t law, std::uint32_t other) const {
    const Eigen::Index p = theta.size();
    double worst = 0.0;
    for (Eigen::Index i = 0; i < u_.size(); ++i) {
      const double* row = map_.law(law) + i * (p + 1);
      const double* other_row = map_.law(other) + i * (p + 1);
      const double value = Eigen::Map<const Eigen::VectorXd>(row, p).dot(theta) + row[p];
      const double other_value = Eigen::Map<const Eigen::VectorXd>(other_row, p).dot(theta) + other_row[p];
      worst = std::max(worst, std::abs(value - other_value) / sizes_(i));
    }
    return worst;
  }

  // At the edge of the feasible set map and program may differ.
  void checkByPlace(const Eigen::VectorXd& theta, Finding& finding, VerifyReport& report) {
    switch (oracle_.place(theta, options_.edge_tolerance)) {
      case ProgramOracle::Place::kDeep:
        note(finding, 0.0, theta);
        return;
      case ProgramOracle::Place::kEdge:
        ++report.borderline;
        return;
      case ProgramOracle::Place::kUnknown:
        note(report.undecided, 0.0, theta);
        return;
    }
  }

  void checkByDistance(const Eigen::VectorXd& theta, Finding& finding, VerifyReport& report) {
    const double distance = oracle_.distanceToFeasible(theta);
    if (std::isnan(distance)) {
      note(report.undecided, distance, theta);
    } else if (distance > options_.edge_tolerance) {
      note(finding, distance, theta);
    } else {
      ++report.borderline;
    }
  }

  bool holds(std::size_t index, const Eigen::VectorXd& theta, double tolerance) const {
    const RegionView region = map_.region(index);
    const Eigen::Index p = theta.size();
    for (std::uint32_t i = 0; i < region.row_count; ++i) {
      const std::int32_t row = region.rows[i];
      const double* plane = map_.plane(static_cast<std::size_t>(std::abs(row)) - 1);
      const double excess = Eigen::Map<const Eigen::VectorXd>(plane, p).dot(theta) - plane[p];
      if ((row > 0 ? excess : -excess) > tolerance) return false;
    }
    return true;
  }

  // Fallback regions may lie over ordinary ones. Without the map's tolerance: beside a face a steep law of
  // the neighbour may differ by more.
  void checkOverlap(const Eigen::VectorXd& theta, std::size_t region, VerifyReport& report) {
    const Eigen::Index p = theta.size();
    double worst = 0.0;
    const std::size_t first = isFallback(region) ? map_.firstFallback() : 0;
    const std::size_t end = isFallback(region) ? map_.regionCount() : map_.firstFallback();
    for (std::size_t index = first; index < end; ++index) {
      if (!holds(index, theta, 0.0)) continue;
      const double* law = map_.law(map_.region(index).law);
      for (Eigen::Index i = 0; i < u_.size(); ++i) {
        const double* row = law + i * (p + 1);
        const double value = Eigen::Map<const Eigen::VectorXd>(row, p).dot(theta) + row[p];
        worst = std::max(worst, std::abs(value - u_[i]) / sizes_(i));
      }
    }
    if (worst > options_.tolerance) note(report.overlaps, worst, theta);
  }

  // Where doubles of the oracle and the map differ, the conditions of optimality are solved exactly for the
  // region's active set, and for those of regions beside it: theta may lie on a face, up to rounding. If they
  // hold at theta, whatever the map says, theirs is the one right answer.
  bool settle(const Eigen::VectorXd& theta, std::size_t index, Eigen::VectorXd& u) {
    const auto is_optimal = [&](std::size_t candidate) {
      const RegionView region = map_.region(candidate);
      return arbiter_.optimal(theta, {region.active, region.active + region.active_count}, u);
    };
    bool found = is_optimal(index);
    for (std::size_t other = 0; other < map_.firstFallback() && !found; ++other)
      found = other != index && holds(other, theta, map_.tolerance()) && is_optimal(other);
    return found;
  }

  void compare(const Eigen::VectorXd& theta, std::size_t region, const OracleAnswer& answer,
               VerifyReport& report) {
    double error = 0.0, scaled = 0.0;
    if (oracle_.strictlyConvex()) {
      Eigen::VectorXd u = inUnits(answer.u, 1);
      if (!(share(u_, u) <= options_.tolerance)) {
        Eigen::VectorXd exact;
        if (settle(theta, region, exact)) {
          ++report.settled;
          u = exact;
        } else if (oracle_.place(theta, options_.edge_tolerance) == ProgramOracle::Place::kEdge) {
          // Near the edge of the feasible set, a steep law and the oracle may differ.
          ++report.borderline;
          return;
        }
      }
      error = (u_ - u).cwiseAbs().maxCoeff();
      scaled = share(u_, u);
    } else {
      // u may be off by the tolerance, so rows give way by as much; that can only lower the objective.
      error = oracle_.objectiveWithOutput(theta, inUnits(u_, -1), options_.tolerance) - answer.objective;
      if (std::isnan(error)) {
        note(report.undecided, error, theta);
        return;
      }
      error = std::max(0.0, error);
      scaled = error / std::max(1.0, std::abs(answer.objective));
    }
    ++report.compared;
    report.max_error = std::max(report.max_error, error);
    if (report.max_error_theta.size() == 0 || scaled > report.max_scaled_error) {
      report.max_scaled_error = scaled;
      report.max_error_theta = theta;
    }
    if (!(scaled <= options_.tolerance)) note(report.errors, scaled, theta);
  }

  const RegionMap& map_;
  const VerifyOptions& options_;
  const std::vector<int> units_;
  const Eigen::VectorXd sizes_;
  ProgramOracle oracle_;
  ExactOptimalityCheck arbiter_;
  Eigen::VectorXd u_;
  std::vector<char> hit_;  // per region
};

// Consecutive blocks. Parts are merged in the order of their blocks, so the report does not depend on which
// thread did which.
void runRound(std::vector<Checker>& checkers, std::uint64_t first, std::uint64_t count,
              const VerifyOptions& options, VerifyReport& report) {
  std::vector<VerifyReport> parts(count);
  std::function<void(std::uint64_t, std::uint64_t)> progress;
  if (options.progress) {
    progress = [&](std::uint64_t done, std::uint64_t) {
      options.progress(std::min(options.samples, (first + done) * kBlock), options.samples);
    };
  }
  inParallel(count, static_cast<int>(checkers.size()), options.stop, progress,
             [&](std::size_t thread, std::uint64_t i) { parts[i] = checkers[thread].checkBlock(first + i); });
  for (const VerifyReport& part : parts) merge(report, part);
}

}  // namespace

bool VerifyReport::passed() const {
  for (const Finding* finding :
       {&errors, &missed, &false_inside, &overlaps, &tree_errors, &unbounded, &undecided, &empty_regions}) {
    if (finding->count > 0) return false;
  }
  return !interrupted && samples == requested && map_status == toString(ExploreStatus::kComplete);
}

VerifyReport verify(const RegionMap& map, const ParametricProgram& program, const VerifyOptions& options) {
  checkProgram(program);
  requireSameSignals(map, program, tolerance::kSameRange);

  const ScaledProgram scaled = scaleProgram(program);
  const int threads = std::clamp(options.threads, 1, 256);
  std::vector<Checker> checkers(static_cast<std::size_t>(threads), Checker(map, program, scaled, options));
  VerifyReport report;
  const std::uint64_t blocks = (options.samples + kBlock - 1) / kBlock;
  for (std::uint64_t first = 0; first < blocks; first += kRound) {
    runRound(checkers, first, std::min(kRound, blocks - first), options, report);
    if (options.stop != nullptr && options.stop->load()) break;
  }
  report.mode = checkers.front().strictlyConvex() ? VerifyMode::kOutput : VerifyMode::kObjective;
  report.seed = options.seed;
  report.tolerance = options.tolerance;
  report.edge_tolerance = options.edge_tolerance;
  report.requested = options.samples;
  report.interrupted = report.samples < report.requested;
  report.map_status = std::string(map.solverStatus());
  report.regions = map.regionCount();
  for (std::size_t index = 0; index < map.regionCount(); ++index) {
    report.regions_hit += std::any_of(checkers.begin(), checkers.end(),
                                      [index](const Checker& checker) { return checker.hit()[index] != 0; });
  }
  return report;
}

}  // namespace polyfly
