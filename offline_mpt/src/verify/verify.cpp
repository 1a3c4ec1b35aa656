#include "offline_mpt/verify.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "offline_mpt/partition.hpp"
#include "region_maps/region_map.hpp"
#include "support/in_parallel.hpp"
#include "support/region_distance.hpp"
#include "verify/answer_checker.hpp"
#include "verify/parameter_sampler.hpp"
#include "verify/same_signals.hpp"
#include "verify/tolerances.hpp"

namespace polyfly {
namespace {

using Kind = SampleFinding::Kind;

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
  total.infeasible += part.infeasible;
  total.borderline += part.borderline;
  total.max_error = std::max(total.max_error, part.max_error);
  if (part.max_scaled_error > total.max_scaled_error || total.max_error_theta.size() == 0) {
    total.max_scaled_error = std::max(total.max_scaled_error, part.max_scaled_error);
    total.max_error_theta = part.max_error_theta;
    total.max_error_region = part.max_error_region;
  }
  merge(total.errors, part.errors);
  merge(total.missed, part.missed);
  merge(total.false_inside, part.false_inside);
  merge(total.beyond, part.beyond);
  merge(total.overlaps, part.overlaps);
  merge(total.tree_errors, part.tree_errors);
  merge(total.unbounded, part.unbounded);
  merge(total.undecided, part.undecided);
  merge(total.empty_regions, part.empty_regions);
}

/// Half of the samples are.
bool isUniform(const RegionMap& map, std::uint64_t i) { return i % 2 == 0 || map.regionCount() == 0; }

ParameterSampler::Sample sampleOf(const RegionMap& map, ParameterSampler& sampler, std::uint64_t i) {
  return isUniform(map, i) ? sampler.uniform() : sampler.degenerate();
}

std::vector<Eigen::VectorXd> firstSamples(const RegionMap& map, std::uint64_t seed) {
  ParameterSampler sampler(map, seed, 0);
  std::vector<Eigen::VectorXd> samples;
  for (std::uint64_t i = 0; i < kBlock; ++i) samples.push_back(sampleOf(map, sampler, i).theta);
  return samples;
}

/// Checks samples with work space of its own: one per thread.
class Checker {
 public:
  Checker(const RegionMap& map, const ParametricProgram& program, const Eigen::VectorXd& ranges,
          const VerifyOptions& options)
      : map_(map),
        options_(options),
        ranges_(ranges),
        checker_(map, program, ranges, {options.tolerance, options.edge_tolerance, Silence::kExact}),
        hit_(map.regionCount(), 0) {}

  VerifyReport checkBlock(std::uint64_t block) {
    VerifyReport report;
    ParameterSampler sampler(map_, options_.seed, block);
    const std::uint64_t first = block * kBlock, last = std::min(options_.samples, first + kBlock);
    for (std::uint64_t i = first; i < last; ++i) {
      const ParameterSampler::Sample sample = sampleOf(map_, sampler, i);
      ++report.samples;
      if (isUniform(map_, i)) ++report.uniform;
      if (sample.radius <= 0.0) note(report.empty_regions, -sample.radius, sample.theta);
      checkSample(sample.theta, report);
    }
    return report;
  }

  const std::vector<char>& hit() const { return hit_; }

 private:
  void checkSample(const Eigen::VectorXd& theta, VerifyReport& report) {
    const SampleFinding finding = checker_.check(theta);
    if (finding.lookup.status == LookupStatus::kInside) {
      ++report.inside;
      hit_[finding.lookup.region] = 1;
      if (checker_.isStrict()) checkOverlap(theta, finding, report);
    }
    if (searchDiffers(theta, finding.lookup) && !checker_.isAtEdge(theta))
      note(report.tree_errors, 0.0, theta);
    switch (finding.kind) {
      case Kind::kRight:
        return compare(theta, finding, report);
      case Kind::kWrong:
        note(report.errors, finding.error, theta);
        return compare(theta, finding, report);
      case Kind::kOutside:
        ++report.infeasible;
        return;
      case Kind::kMissed:
        return note(report.missed, 0.0, theta);
      case Kind::kFalseInside:
        ++report.infeasible;
        return note(report.false_inside, finding.error, theta);
      case Kind::kBeyond:
        return note(report.beyond, finding.error, theta);
      case Kind::kUnbounded:
        return note(report.unbounded, 0.0, theta);
      case Kind::kEdge:
        ++report.borderline;
        return;
      case Kind::kUndecided:
        return note(report.undecided, 0.0, theta);
    }
  }

  bool searchDiffers(const Eigen::VectorXd& theta, const Lookup& lookup) const {
    const bool inside = lookup.status == LookupStatus::kInside;
    return lookup.status != map_.locateExhaustively(theta.data()).status ||
           (inside && !map_.contains(lookup.region, theta.data()));
  }

  // Without the map's tolerance: beside a face a steep law of the neighbour may differ by more.
  void checkOverlap(const Eigen::VectorXd& theta, const SampleFinding& finding, VerifyReport& report) {
    const Eigen::Index p = theta.size();
    double worst = 0.0;
    for (std::size_t index = 0; index < map_.regionCount(); ++index) {
      if (!isWithin(map_, index, theta, 0.0)) continue;
      const double* law = map_.law(map_.region(index).law);
      for (Eigen::Index i = 0; i < ranges_.size(); ++i) {
        const double* row = law + i * (p + 1);
        const double value = Eigen::Map<const Eigen::VectorXd>(row, p).dot(theta) + row[p];
        worst = std::max(worst, std::abs(value - finding.u[i]) / ranges_(i));
      }
    }
    if (worst > options_.tolerance) note(report.overlaps, worst, theta);
  }

  static void compare(const Eigen::VectorXd& theta, const SampleFinding& finding, VerifyReport& report) {
    ++report.compared;
    report.max_error = std::max(report.max_error, (finding.u - finding.right).cwiseAbs().maxCoeff());
    if (report.max_error_theta.size() > 0 && !(finding.error > report.max_scaled_error)) return;
    report.max_scaled_error = finding.error;
    report.max_error_theta = theta;
    report.max_error_region = finding.lookup.region;
  }

  const RegionMap& map_;
  const VerifyOptions& options_;
  const Eigen::VectorXd& ranges_;
  AnswerChecker checker_;
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

  const Eigen::VectorXd ranges = inputRanges(map, firstSamples(map, options.seed));
  const int threads = std::clamp(options.threads, 1, 256);
  std::vector<Checker> checkers(static_cast<std::size_t>(threads), Checker(map, program, ranges, options));
  VerifyReport report;
  const std::uint64_t blocks = (options.samples + kBlock - 1) / kBlock;
  for (std::uint64_t first = 0; first < blocks; first += kRound) {
    runRound(checkers, first, std::min(kRound, blocks - first), options, report);
    if (options.stop != nullptr && options.stop->load()) break;
  }
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
