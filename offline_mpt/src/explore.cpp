#include "offline_mpt/explore.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <functional>
#include <memory>
#include <random>
#include <thread>
#include <unordered_set>

#include "feasible_slack.hpp"
#include "least_distance.hpp"
#include "margin.hpp"
#include "mpc_core/dense_qp.hpp"
#include "region_builder.hpp"
#include "region_maps/error.hpp"

namespace polyfly {
namespace {

constexpr double kProbeStep = 1e-7;  // how far a probe steps across a degenerate facet [scaled]
constexpr double kLinearProbe =
    1e4;  // by how much step and edge are wider for linear programs, whose starting points are less exact
constexpr double kProbeTolerance =
    1e-8;  // a region holds a probe within this, as the map's look-up does [scaled]
constexpr double kClearlyInside =
    1e-10;  // distance from all of a region's half-spaces at which it has an interior for certain [scaled]
constexpr double kEdge =
    1e-9;  // a probe whose rows cannot all keep this slack lies at the edge of the feasible set
constexpr double kActive = 1e-10;     // multipliers below this are not active in a starting point
constexpr std::size_t kBatch = 1024;  // sets handed out between two looks at the limits

struct ActiveSetHash {
  std::size_t operator()(const ActiveSet& set) const {
    std::uint64_t hash = 1469598103934665603ull;
    for (const std::uint16_t row : set) hash = (hash ^ row) * 1099511628211ull;
    return static_cast<std::size_t>(hash ^ hash >> 29);
  }
};

/// What describing one active set yields.
struct Described {
  BuildStatus status = BuildStatus::kThin;
  RegionData region;
  std::vector<ActiveSet> neighbours;
  std::vector<double> unsettled;  // probes (p numbers each) that no candidate of their facet holds
  std::uint32_t degenerate_facets = 0;
};

/// Everything that one thread needs.
struct Worker {
  Worker(const LeastDistance& program, const ExploreOptions& options)
      : builder(program, options.facet_tolerance, options.radius_tolerance), qp(program.H, program.A) {}

  RegionBuilder builder;
  DenseQp qp;
  std::vector<ActiveSet> sets;
};

/// Active set at t with all rows of unit length tightened by `margin`, ascending; false where that is
/// infeasible.
bool activeSetAt(const LeastDistance& program, DenseQp& qp, const Eigen::VectorXd& t, double margin,
                 ActiveSet& active) {
  Eigen::VectorXd t1(program.p + 1);
  t1 << t, 1.0;
  const Eigen::VectorXd g = program.F * t1;
  const Eigen::VectorXd b = program.S * t1 - margin * program.length;
  if (qp.solve(g.data(), b.data()) != QpStatus::kOptimal) return false;
  active.clear();
  for (int k = 0; k < qp.activeCount(); ++k) {
    const int row = qp.activeRows()[k];
    if (qp.lambda()(row) > kActive) active.push_back(static_cast<std::uint16_t>(row));
  }
  std::sort(active.begin(), active.end());
  return true;
}

/// A point just across the facet, on the way from the region's centre to a point beyond.
Eigen::VectorXd across(const RegionData& region, const Facet& facet, int p, double step) {
  double inside = facet.row[p];
  double outside = facet.row[p];
  double distance = 0.0;
  for (int j = 0; j < p; ++j) {
    inside -= facet.row[j] * region.centre[j];
    outside -= facet.row[j] * facet.beyond[j];
    distance = std::max(distance, std::abs(facet.beyond[j] - region.centre[j]));
  }
  double fraction = inside / (inside - outside);
  fraction = std::min(0.5 * (fraction + 1.0), fraction + step / std::max(distance, step));
  Eigen::VectorXd probe(p);
  for (int j = 0; j < p; ++j) probe(j) = region.centre[j] + fraction * (facet.beyond[j] - region.centre[j]);
  return probe;
}

/// Checks that one of the candidates of a degenerate facet holds a point just across it. Where none does so
/// clearly, a program of its own finds the active set there, which joins the candidates.
void probeFacet(const LeastDistance& program, Worker& worker, const Facet& facet,
                std::vector<ActiveSet>& sets, Described& out) {
  const double widen = program.linear ? kLinearProbe : 1.0;
  const Eigen::VectorXd probe = across(out.region, facet, program.p, widen * kProbeStep);
  const auto held = [&](double tolerance) {
    return std::any_of(sets.begin(), sets.end(), [&](const ActiveSet& set) {
      return worker.builder.holds(set, probe.data(), tolerance);
    });
  };
  if (held(-kClearlyInside)) return;
  ActiveSet active;
  if (!activeSetAt(program, worker.qp, probe, widen * kEdge, active)) return;  // the edge of the feasible set
  if (!activeSetAt(program, worker.qp, probe, 0.0, active)) return;
  sets.push_back(active);
  if (held(kProbeTolerance)) return;
  RegionData optimal;
  if (worker.builder.build(active, optimal) == BuildStatus::kRegion) return;  // ill-conditioned, but not lost
  out.unsettled.insert(out.unsettled.end(), probe.data(), probe.data() + program.p);
}

/// The same set without one of its rows, for each: one of its multipliers is zero everywhere.
void addSmallerSets(const ActiveSet& active, std::vector<ActiveSet>& sets) {
  for (std::size_t left_out = 0; left_out < active.size(); ++left_out) {
    ActiveSet smaller = active;
    smaller.erase(smaller.begin() + static_cast<std::ptrdiff_t>(left_out));
    sets.push_back(std::move(smaller));
  }
}

Described describe(const LeastDistance& program, Worker& worker, const ActiveSet& active) {
  Described out;
  out.status = worker.builder.build(active, out.region);
  if (out.status == BuildStatus::kWeak) addSmallerSets(active, out.neighbours);
  if (out.status != BuildStatus::kRegion) return out;
  std::vector<std::pair<std::size_t, std::vector<ActiveSet>>> degenerate;
  for (std::size_t f = 0; f < out.region.facets.size(); ++f) {
    const Crossing crossing = worker.builder.neighbours(active, out.region.facets[f], worker.sets);
    if (crossing == Crossing::kDegenerate) {
      degenerate.emplace_back(f, worker.sets);
    } else {
      out.neighbours.insert(out.neighbours.end(), worker.sets.begin(), worker.sets.end());
    }
  }
  out.degenerate_facets = static_cast<std::uint32_t>(degenerate.size());
  for (auto& [f, sets] : degenerate) {  // after all facets: a probe overwrites the builder's rows
    probeFacet(program, worker, out.region.facets[f], sets, out);
    out.neighbours.insert(out.neighbours.end(), sets.begin(), sets.end());
  }
  return out;
}

/// A full-dimensional region to begin with.
bool findStart(const LeastDistance& program, const Eigen::VectorXd& centre, Worker& worker,
               ActiveSet& active) {
  std::mt19937_64 random(1);
  constexpr int kTries = 200;
  RegionData region;
  for (int round = 0; round < kTries; ++round) {
    Eigen::VectorXd t = centre;
    const double spread = round == 0 ? 0.0 : std::pow(10.0, -1.0 - round % 6);
    for (int j = 0; j < program.p; ++j) {
      const double unit = static_cast<double>(random() >> 11) * 0x1.0p-53;
      t(j) += spread * (2.0 * unit - 1.0);
    }
    if (!activeSetAt(program, worker.qp, t, 0.0, active)) continue;
    if (worker.builder.build(active, region) == BuildStatus::kRegion) return true;
  }
  return false;
}

CriticalRegion toRegion(const LeastDistance& program, const ActiveSet& active, const RegionData& data) {
  const int p = program.p;
  const int q = static_cast<int>(program.U.rows());
  CriticalRegion region;
  for (const std::uint16_t row : active) region.active.push_back(program.row_ids[row]);
  std::sort(region.active.begin(), region.active.end());
  region.G.resize(static_cast<Eigen::Index>(data.facets.size()), p);
  region.g.resize(region.G.rows());
  for (Eigen::Index f = 0; f < region.G.rows(); ++f) {
    double bound = data.facets[f].row[p];
    for (int j = 0; j < p; ++j) {
      region.G(f, j) = data.facets[f].row[j] / program.half(j);
      bound += region.G(f, j) * program.centre(j);
    }
    region.g(f) = bound;
  }
  region.K.resize(q, p);
  region.k.resize(q);
  region.centre.resize(p);
  for (int i = 0; i < q; ++i) {
    double constant = data.law[static_cast<std::size_t>(i) * (p + 1) + p];
    for (int j = 0; j < p; ++j) {
      region.K(i, j) = data.law[static_cast<std::size_t>(i) * (p + 1) + j] / program.half(j);
      constant -= region.K(i, j) * program.centre(j);
    }
    region.k(i) = constant;
  }
  for (int j = 0; j < p; ++j) region.centre(j) = program.centre(j) + program.half(j) * data.centre[j];
  region.radius = data.radius;
  return region;
}

/// The exploration itself: waves of active sets, each described in parallel and merged in order.
class Exploration {
 public:
  Exploration(const LeastDistance& program, const Eigen::VectorXd& start, const ExploreOptions& options)
      : program_(program), start_(start), options_(options) {
    const int most = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    const int threads = std::clamp(options.threads, 1, most);
    for (int k = 0; k < threads; ++k) workers_.push_back(std::make_unique<Worker>(program, options));
  }

  Partition run() {
    const std::clock_t cpu_start = std::clock();
    begin_ = std::chrono::steady_clock::now();
    ActiveSet first;
    if (!findStart(program_, start_, *workers_.front(), first)) {
      partition_.status = ExploreStatus::kIncomplete;
      partition_.witness = program_.centre + program_.half.cwiseProduct(start_);
      return std::move(partition_);
    }
    partition_.status = ExploreStatus::kComplete;
    seen_.insert(first);
    std::vector<ActiveSet> wave{first};
    while (!wave.empty() && partition_.status == ExploreStatus::kComplete) wave = advance(wave);
    std::sort(partition_.regions.begin(), partition_.regions.end(),
              [](const CriticalRegion& a, const CriticalRegion& b) { return a.active < b.active; });
    if (partition_.status == ExploreStatus::kComplete) settleProbes();
    partition_.stats.regions = partition_.regions.size();
    partition_.stats.candidate_sets = seen_.size();
    for (const auto& worker : workers_) partition_.stats.lp_pivots += worker->builder.pivots();
    partition_.stats.cpu_seconds = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
    return std::move(partition_);
  }

 private:
  std::vector<ActiveSet> advance(const std::vector<ActiveSet>& wave) {
    std::vector<ActiveSet> next;
    std::vector<Described> described;
    for (std::size_t first = 0; first < wave.size(); first += kBatch) {
      if (limitReached()) return {};
      const std::size_t count = std::min(kBatch, wave.size() - first);
      described.assign(count, {});
      describeAll(wave.data() + first, described);
      for (std::size_t i = 0; i < count; ++i) merge(wave[first + i], described[i], next);
      if (options_.progress)
        options_.progress({partition_.regions.size(), wave.size() - first - count + next.size()});
    }
    return next;
  }

  // One set after another by whichever thread is free; the results do not depend on which.
  void describeAll(const ActiveSet* sets, std::vector<Described>& described) {
    std::atomic<std::size_t> next{0};
    const auto work = [&](Worker& worker) {
      for (std::size_t i = next++; i < described.size(); i = next++) {
        described[i] = describe(program_, worker, sets[i]);
      }
    };
    std::vector<std::thread> threads;
    if (described.size() > 1) {
      for (std::size_t k = 1; k < workers_.size(); ++k) threads.emplace_back(work, std::ref(*workers_[k]));
    }
    work(*workers_.front());
    for (std::thread& thread : threads) thread.join();
  }

  void merge(const ActiveSet& active, Described& described, std::vector<ActiveSet>& next) {
    if (described.status == BuildStatus::kFailed) partition_.status = ExploreStatus::kIncomplete;
    for (ActiveSet& set : described.neighbours) {
      if (seen_.insert(set).second) next.push_back(std::move(set));
    }
    if (described.status != BuildStatus::kRegion) return;
    partition_.stats.degenerate_facets += described.degenerate_facets;
    if (described.region.by_slack && described.region.tight.size() > active.size() &&
        !tight_.insert(described.region.tight).second) {
      return;  // the same rows are tight in a region that was found before: it is that region
    }
    unsettled_.insert(unsettled_.end(), described.unsettled.begin(), described.unsettled.end());
    partition_.regions.push_back(toRegion(program_, active, described.region));
  }

  bool limitReached() {
    if (options_.stop != nullptr && options_.stop->load()) {
      partition_.status = ExploreStatus::kInterrupted;
    } else if (partition_.regions.size() >= options_.region_limit) {
      partition_.status = ExploreStatus::kLimited;
    } else if (options_.time_limit > 0.0 &&
               std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count() >
                   options_.time_limit) {
      partition_.status = ExploreStatus::kLimited;
    } else {
      return false;
    }
    return true;
  }

  // A probe that none of its facet's own candidates holds must lie in some other region.
  void settleProbes() {
    const int p = program_.p;
    for (std::size_t i = 0; i + p <= unsettled_.size(); i += p) {
      const Eigen::VectorXd t = Eigen::Map<const Eigen::VectorXd>(unsettled_.data() + i, p);
      const Eigen::VectorXd theta = program_.centre + program_.half.cwiseProduct(t);
      const bool held = std::any_of(
          partition_.regions.begin(), partition_.regions.end(),
          [&](const CriticalRegion& r) { return (r.G * theta - r.g).maxCoeff() <= kProbeTolerance; });
      if (held) continue;
      const std::optional<double> slack = feasibleSlack(program_, t);
      if (slack && *slack <= kEdge) continue;  // the edge of the feasible set after all
      partition_.status = ExploreStatus::kIncomplete;
      partition_.witness = theta;
      return;
    }
  }

  const LeastDistance& program_;
  const Eigen::VectorXd& start_;
  const ExploreOptions& options_;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::chrono::steady_clock::time_point begin_;
  std::unordered_set<ActiveSet, ActiveSetHash> seen_;
  std::unordered_set<ActiveSet, ActiveSetHash> tight_;
  std::vector<double> unsettled_;
  Partition partition_;
};

}  // namespace

const char* toString(ExploreStatus status) {
  switch (status) {
    case ExploreStatus::kComplete:
      return "complete";
    case ExploreStatus::kIncomplete:
      return "incomplete";
    case ExploreStatus::kLimited:
      return "limited";
    case ExploreStatus::kInterrupted:
      return "interrupted";
    case ExploreStatus::kInfeasible:
      return "infeasible";
  }
  return "unknown";
}

Partition explore(const ParametricProgram& program, const ExploreOptions& options) {
  checkProgram(program);
  ParametricProgram explicit_equalities = program;
  const Margin margin = findMargin(explicit_equalities);
  if (!margin.feasible) return {};
  const LeastDistance scaled = toLeastDistance(explicit_equalities);
  if (scaled.domain_empty) return {};
  return Exploration(scaled, margin.t, options).run();
}

}  // namespace polyfly
