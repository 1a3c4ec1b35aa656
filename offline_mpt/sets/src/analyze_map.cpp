#include "polytope_sets/analyze_map.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "cone.hpp"
#include "map_domain.hpp"
#include "polyfly_base/error.hpp"
#include "region_cover.hpp"
#include "region_maps/region_map.hpp"
#include "support/in_parallel.hpp"
#include "vertex_tests.hpp"

namespace polyfly {
namespace {

constexpr int kFirstBlend = 4;  // a witness is moved 2^-4 of the way to the region's middle, then less
constexpr int kLastBlend = 60;

/// theta+ = M theta + m + E d in one region.
struct RegionStep {
  RationalMatrix M;
  RationalVector m;
};

/// What was found of one region.
struct Finding {
  bool offends = false;
  // Greatest excess of the region itself over the domain.
  Rational out_of_domain;
  // Greatest excess of the region's successors.
  Rational excess;
  // Facet with the greatest excess.
  std::size_t facet = 0;
  // Vertex with the greatest excess.
  RationalVector vertex;
  RationalVector middle;
};

class Analysis {
 public:
  Analysis(const RegionMap& map, const ClosedLoopModel& model, const AnalyzeOptions& options)
      : map_(map),
        model_(model),
        options_(options),
        regions_(map, options.tolerance < 0.0 ? map.tolerance() : options.tolerance),
        tolerance_(regions_.tolerance()) {
    corners_ = vertices(model.D);
  }

  AnalyzeReport run() {
    AnalyzeReport report;
    report.tolerance = regions_.tolerance();
    report.regions = regions_.count();
    forEachRegion("corners of regions", [&](std::size_t r) { regions_.setShape(r, regions_.vertices(r)); });
    report.is_within = options_.within.has_value();
    domain_ = report.is_within ? scaledRows(*options_.within, map_) : domainRows(regions_);
    report.domain = domain_;
    proveCover(report);
    if (report.covered || report.is_within) testRegions(report);
    return report;
  }

 private:
  void forEachRegion(const char* phase, const std::function<void(std::size_t)>& work) const {
    inParallel(regions_.count(), options_.threads, nullptr, progressOf(phase),
               [&](std::size_t, std::uint64_t r) { work(static_cast<std::size_t>(r)); });
  }

  std::function<void(std::uint64_t, std::uint64_t)> progressOf(const char* phase) const {
    return [this, phase](std::uint64_t done, std::uint64_t total) {
      if (options_.progress) options_.progress(phase, done, total);
    };
  }

  ExactPolytope domainSet() const {
    ExactPolytope set;
    set.dimension = regions_.parameters();
    set.rows = domain_;
    return set;
  }

  void proveCover(AnalyzeReport& report) {
    const SetCover cover =
        coverSet(regions_, domainSet(), options_.threads, progressOf("cover of the domain"));
    report.covered = cover.covered;
    if (!report.covered) report.gap = cover.gap;
    slivers_.resize(regions_.count());
    for (const CoverSliver& sliver : cover.slivers) {
      auto& list = slivers_[sliver.region];
      list.insert(list.end(), sliver.vertices.begin(), sliver.vertices.end());
    }
    for (std::vector<std::vector<Integer>>& list : slivers_) {
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
    }
  }

  RegionStep stepOf(std::size_t region) const {
    const int p = regions_.parameters(), m = static_cast<int>(model_.G.cols());
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> law(
        map_.law(map_.region(region).law), m, p + 1);
    const RationalMatrix by_input = model_.G * exactly(law);
    RegionStep step{model_.F + by_input.leftCols(p), model_.c};
    for (int i = 0; i < p; ++i) step.m[static_cast<std::size_t>(i)] += by_input(i, p);
    return step;
  }

  /// The vertex of D that pushes farthest along a.
  const RationalVector& push(const RationalVector& a) const {
    const RationalVector direction = applyTransposed(model_.E, a);
    return *std::max_element(corners_.begin(), corners_.end(),
                             [&](const RationalVector& x, const RationalVector& y) {
                               return dot(direction, x) < dot(direction, y);
                             });
  }

  std::vector<std::vector<Integer>> verticesOf(std::size_t region) const {
    if (!options_.within) return regions_.vertices(region);
    return raysOf(PolytopeCone(intersect(regionPolytope(map_, region), domainSet())).cone);
  }

  Finding testRegion(std::size_t region) const {
    Finding finding;
    std::vector<std::vector<Integer>> corners = verticesOf(region);
    const std::vector<Integer>* where = nullptr;
    for (const ExactHalfSpace& row : domain_)
      finding.out_of_domain = std::max(finding.out_of_domain, worst(corners, row.a, row.b, &where));
    // Parts of P that only the tolerance gives to this region: its law answers there too.
    std::copy_if(slivers_[region].begin(), slivers_[region].end(), std::back_inserter(corners),
                 [&](const std::vector<Integer>& vertex) {
                   return !regions_.holds(static_cast<std::uint32_t>(region), vertex, false);
                 });
    if (corners.empty()) return finding;
    finding.middle = middleOf(corners);
    const RegionStep step = stepOf(region);
    for (std::size_t f = 0; f < domain_.size(); ++f) {
      const RationalVector& a = domain_[f].a;
      const Rational bound = domain_[f].b - dot(applyTransposed(model_.E, a), push(a)) - dot(a, step.m);
      const Rational excess = worst(corners, applyTransposed(step.M, a), bound, &where);
      if (excess <= finding.excess) continue;
      finding.excess = excess;
      finding.facet = f;
      finding.vertex = pointOf(*where);
    }
    finding.offends = finding.excess > tolerance_;
    return finding;
  }

  void testRegions(AnalyzeReport& report) {
    std::vector<Finding> findings(regions_.count());
    forEachRegion("successors", [&](std::size_t r) { findings[r] = testRegion(r); });
    std::size_t worst_region = findings.size();
    Rational out, excess;
    for (std::size_t r = 0; r < findings.size(); ++r) {
      const Finding& finding = findings[r];
      report.offending_regions += finding.offends ? 1 : 0;
      if (!report.is_within) out = std::max(out, finding.out_of_domain);
      if (finding.offends && (worst_region == findings.size() || finding.excess > excess)) worst_region = r;
      excess = std::max(excess, finding.excess);
    }
    report.region_excess = roundedUp(out);
    report.greatest_excess = roundedUp(excess);
    report.successors_inside = report.offending_regions == 0;
    if (report.successors_inside) return;
    report.witness = facetWitness(worst_region, findings[worst_region]);
  }

  // Evaluates one step from exactly these doubles; true when the map answers there.
  bool evaluate(AnalyzeWitness& witness) const {
    witness.u.assign(map_.inputs().size(), 0.0);
    const Lookup lookup = map_.evaluate(witness.theta.data(), witness.u.data());
    witness.answered = lookup.status == LookupStatus::kInside;
    if (!witness.answered) return false;
    const RationalVector theta(witness.theta.begin(), witness.theta.end());
    const RationalVector u(witness.u.begin(), witness.u.end());
    witness.successor = affine(model_.F, theta, model_.c);
    const RationalVector by_input = affine(model_.G, u), by_disturbance = affine(model_.E, witness.d);
    std::vector<double> rounded;
    for (std::size_t i = 0; i < witness.successor.size(); ++i) {
      witness.successor[i] += by_input[i] + by_disturbance[i];
      rounded.push_back(nearestDouble(witness.successor[i]));
    }
    witness.successor_outside = map_.locate(rounded.data()).status != LookupStatus::kInside;
    if (options_.within) {
      witness.successor_outside = witness.successor_outside || !contains(*options_.within, witness.successor);
    }
    return true;
  }

  AnalyzeWitness facetWitness(std::size_t region, const Finding& finding) const {
    AnalyzeWitness witness;
    witness.region = static_cast<std::uint32_t>(region);
    witness.facet = domain_[finding.facet];
    witness.d = push(witness.facet.a);
    for (int blend = kFirstBlend; blend <= kLastBlend && !witness.verified; ++blend) {
      const Rational share(std::ldexp(1.0, -blend));
      witness.theta.clear();
      for (std::size_t j = 0; j < finding.vertex.size(); ++j)
        witness.theta.push_back(
            nearestDouble(finding.vertex[j] + share * (finding.middle[j] - finding.vertex[j])));
      if (!evaluate(witness)) continue;
      const Rational excess = dot(witness.facet.a, witness.successor) - witness.facet.b;
      witness.excess = excess.get_d();
      witness.verified = excess > tolerance_ && 2 * excess > finding.excess;
      if (blend == kLastBlend) witness.verified = excess > tolerance_;
    }
    return witness;
  }

  const RegionMap& map_;
  const ClosedLoopModel& model_;
  const AnalyzeOptions& options_;
  MapRegions regions_;
  Rational tolerance_;
  // Vertices of D.
  std::vector<RationalVector> corners_;
  std::vector<ExactHalfSpace> domain_;
  // Vertices of slivers, by region.
  std::vector<std::vector<std::vector<Integer>>> slivers_;
};

}  // namespace

AnalyzeReport analyze(const RegionMap& map, const ClosedLoopModel& model, const AnalyzeOptions& options) {
  if (options.threads < 1 || options.threads > 256) throw Error("analyze: threads: must be 1 to 256");
  if (options.within) {
    requireDimension(*options.within, map.parameters().size(), "set of parameters");
    if (vertices(*options.within).empty()) throw Error("analyze: the set of parameters is empty");
  }
  return Analysis(map, model, options).run();
}

}  // namespace polyfly
