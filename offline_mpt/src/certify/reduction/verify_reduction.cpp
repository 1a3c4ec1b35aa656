#include "offline_mpt/verify_reduction.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "arithmetic/exact_numbers.hpp"
#include "certify/certificate.hpp"
#include "certify/reduction/reduced_answers.hpp"
#include "certify/reduction/tree_partition.hpp"
#include "certify/tolerances.hpp"
#include "polyfly_base/error.hpp"
#include "reduce/law_classes.hpp"
#include "region_maps/region_map.hpp"
#include "support/certificate_text.hpp"
#include "support/in_parallel.hpp"
#include "support/region_distance.hpp"

namespace polyfly {
namespace {

// Up to this number, all regions are tried, and the tree is not asked which ones matter.
constexpr std::size_t kFew = 16;
// Number of parts of a region that are reported at most.
constexpr std::size_t kMostLost = 100;
constexpr double kAnywhere = std::numeric_limits<double>::infinity();

/// Which laws of two maps count as one.
class LawTable {
 public:
  LawTable(const RegionMap& a, const RegionMap& b, double tolerance)
      : width_(b.lawCount()), same_(a.lawCount() * b.lawCount(), 0), tolerance_(tolerance) {
    const std::vector<double> scales = lawScales(b);
    for (std::size_t i = 0; i < a.lawCount(); ++i) {
      for (std::size_t j = 0; j < width_; ++j) {
        const double difference = compare(a, a.law(i), b.law(j), scales);
        if (difference > tolerance) continue;
        same_[i * width_ + j] = 1;
        error_ = std::max(error_, difference);
      }
    }
  }

  bool same(std::uint32_t a, std::uint32_t b) const { return same_[a * width_ + b] != 0; }
  double error() const { return error_; }

 private:
  /// Greatest difference in the box, rounded up; any greater number where it is far above the tolerance.
  double compare(const RegionMap& map, const double* a, const double* b,
                 const std::vector<double>& scales) const {
    const std::size_t p = map.parameters().size();
    const ExactRanges ranges(map.parameters());
    double worst = 0.0;
    for (std::size_t i = 0; i < scales.size(); ++i, a += p + 1, b += p + 1) {
      if (std::equal(a, a + p + 1, b)) continue;
      Rational sum;
      double rounded = 0.0;
      for (std::size_t j = 0; j < p; ++j) {
        const Signal& signal = map.parameters()[j];
        rounded += std::abs(a[j] - b[j]) * (signal.upper - signal.lower) / 2.0;
      }
      if (rounded > 4.0 * tolerance_ * scales[i]) return rounded / scales[i];
      const std::vector<Rational> one = ranges.inBox(a, a[p]), other = ranges.inBox(b, b[p]);
      for (std::size_t j = 0; j <= p; ++j) sum += abs(one[j] - other[j]);
      worst = std::max(worst, above(sum / Rational(scales[i])));
    }
    return worst;
  }

  std::size_t width_;
  std::vector<char> same_;
  double tolerance_;
  double error_ = 0.0;
};

/// What came of one region.
struct Finding {
  std::vector<ReductionDefect> defects;
  ProofWriter log;
  bool flat = false;
};

class ReductionProof {
 public:
  ReductionProof(const RegionMap& reduced, const RegionMap& original, const ReductionOptions& options,
                 double slack)
      : original_(original, slack),
        reduced_(reduced, slack, &original_),
        laws_(reduced, original, options.law_tolerance),
        wants_certificate_(options.certificate) {}

  double lawError() const { return laws_.error(); }

  /// Every part of a region of the original is answered, with its law or, in slivers that the tree leaves to
  /// a neighbour, with the law of a region that holds it within the slack too.
  Finding checkOriginal(std::uint32_t region) const {
    Finding finding = checkOriginal(region, tolerance::kNearSliver);
    return finding.defects.empty() ? finding : checkOriginal(region, kAnywhere);
  }

  /// What a region of the reduced map claims belongs to its law.
  Finding checkReduced(std::uint32_t region) const {
    Finding finding = checkReduced(region, tolerance::kNearSliver);
    return finding.defects.empty() ? finding : checkReduced(region, kAnywhere);
  }

 private:
  /// `near`: slivers, which may be long, are looked for in regions of the original no farther from their
  /// point.
  Finding checkOriginal(std::uint32_t region, double near) const {
    Finding finding = started(original_, region);
    ExactCell cell;
    if (!cellOf(original_, region, cell)) return flat(cell, std::move(finding));
    const std::uint32_t law = original_.map().region(region).law;
    const auto check = [&](std::uint32_t index, const ExactCell& part) {
      const LeafView leaf = reduced_.map().leaf(index);
      std::vector<std::uint32_t> own, others;
      for (std::uint32_t i = 0; i < leaf.count; ++i) {
        const std::uint32_t candidate = leaf.candidates[i];
        (laws_.same(reduced_.map().region(candidate).law, law) ? own : others).push_back(candidate);
      }
      const auto rest = [&](const ExactCell& sliver) {
        ExactCell settled = sliver;
        if (isEmpty(settled, finding) || leftToOthers(settled, others, 0, near, finding)) return true;
        report(finding, ReductionDefect::Kind::kLost, region, settled);
        finding.defects.back().leaf = static_cast<int>(index);
        finding.defects.back().missing = holdersOf(law, settled);
        return finding.defects.size() < kMostLost;
      };
      return subtract(reduced_, part, own, CutBy::kCandidate, rest, finding.log);
    };
    dissect(reduced_, cell, check, finding.log);
    return finding;
  }

  Finding checkReduced(std::uint32_t region, double near) const {
    Finding finding = started(reduced_, region);
    ExactCell cell;
    if (!cellOf(reduced_, region, cell)) return flat(cell, std::move(finding));
    belongs(region, cell, near, finding);
    return finding;
  }

  Finding started(const ExactMap& map, std::uint32_t region) const {
    Finding finding;
    if (wants_certificate_)
      finding.log = ProofWriter(map.map().path() + ": region " + std::to_string(region));
    return finding;
  }

  Finding flat(const ExactCell& cell, Finding finding) const {
    finding.flat = true;
    finding.log.empty('e', cell.rows, original_.p());
    return finding;
  }

  /// Whether the cell has no interior; then the log says why.
  bool isEmpty(ExactCell& cell, Finding& finding) const {
    if (makeCertain(original_, cell)) return false;
    finding.log.empty('e', cell.rows, original_.p());
    return true;
  }

  /// Regions of the reduced map with a law of the original that hold the cell's point within the slack.
  std::vector<std::uint32_t> holdersOf(std::uint32_t law, const ExactCell& cell) const {
    std::vector<std::uint32_t> result;
    const RegionMap& map = reduced_.map();
    for (std::uint32_t r = 0; r < map.regionCount(); ++r) {
      const RegionView region = map.region(r);
      const auto holds = [&](std::int32_t row) { return valueAt(reduced_.relaxed(row), cell.point) >= 0; };
      if (laws_.same(region.law, law) && std::all_of(region.rows, region.rows + region.row_count, holds))
        result.push_back(r);
    }
    return result;
  }

  /// Whether the cell lies in the union of what each candidate, from `next` on, has in common with regions of
  /// the original with its law.
  bool leftToOthers(const ExactCell& cell, const std::vector<std::uint32_t>& candidates, std::size_t next,
                    double near, Finding& finding) const {
    if (next == candidates.size()) {
      ExactCell rest = cell;
      return isEmpty(rest, finding);
    }
    const RestVisit rest = [&](const ExactCell& part) {
      return leftToOthers(part, candidates, next + 1, near, finding);
    };
    const std::vector<std::uint32_t> owners =
        nearRegions(reduced_.map().region(candidates[next]).law, cell, near);
    finding.log.word('B', candidates[next]);
    return subtract(reduced_, cell, {candidates[next]}, CutBy::kCandidate, rest, finding.log) &&
           subtract(original_, cell, owners, CutBy::kOriginal, rest, finding.log);
  }

  /// Regions of the original with a law of the reduced map that are not farther than `near` from the cell's
  /// point.
  std::vector<std::uint32_t> nearRegions(std::uint32_t law, const ExactCell& cell, double near) const {
    const RegionMap& map = original_.map();
    const Eigen::VectorXd theta = original_.theta(cell.point);
    std::vector<std::uint32_t> result;
    for (std::uint32_t r = 0; r < map.regionCount(); ++r) {
      if (laws_.same(law, map.region(r).law) && isWithin(map, r, theta, near)) result.push_back(r);
    }
    return result;
  }

  /// The original's tree tells which regions matter where; slivers that it leaves to a neighbour are looked
  /// for in all regions about.
  bool belongs(std::uint32_t region, const ExactCell& cell, double near, Finding& finding) const {
    const std::uint32_t law = reduced_.map().region(region).law;
    RestVisit sliver;
    const RestVisit foreign = [&](const ExactCell& rest) {
      if (!rest.certain) {
        ExactCell settled = rest;
        return isEmpty(settled, finding) || sliver(settled);
      }
      report(finding, ReductionDefect::Kind::kClaim, region, rest);
      return false;
    };
    sliver = [&](const ExactCell& rest) {
      return subtract(original_, rest, nearRegions(law, rest, near), CutBy::kOriginal, foreign, finding.log);
    };
    const auto check = [&](std::uint32_t index, const ExactCell& part) {
      const LeafView leaf = original_.map().leaf(index);
      std::vector<std::uint32_t> owners;
      for (std::uint32_t i = 0; i < leaf.count; ++i) {
        if (laws_.same(law, original_.map().region(leaf.candidates[i]).law))
          owners.push_back(leaf.candidates[i]);
      }
      return subtract(original_, part, owners, CutBy::kOriginal, sliver, finding.log);
    };
    const std::vector<std::uint32_t> all = regionsWithLaw(law);
    if (all.size() <= kFew) return subtract(original_, cell, all, CutBy::kOriginal, sliver, finding.log);
    return dissect(original_, cell, check, finding.log);
  }

  /// Regions of the original with a law of the reduced map.
  std::vector<std::uint32_t> regionsWithLaw(std::uint32_t law) const {
    std::vector<std::uint32_t> result;
    for (std::uint32_t r = 0; r < original_.map().regionCount(); ++r) {
      if (laws_.same(law, original_.map().region(r).law)) result.push_back(r);
    }
    return result;
  }

  void report(Finding& finding, ReductionDefect::Kind kind, std::uint32_t region,
              const ExactCell& rest) const {
    ReductionDefect defect;
    defect.kind = kind;
    defect.region = region;
    defect.witness = original_.theta(rest.point);
    defect.text = kind == ReductionDefect::Kind::kLost
                      ? "region " + std::to_string(region) +
                            " of the original: a part of it is not answered as it should be"
                      : "region " + std::to_string(region) +
                            " of the reduced map: claims what no region with its law holds";
    finding.defects.push_back(std::move(defect));
  }

  const ExactMap original_, reduced_;
  const LawTable laws_;
  const bool wants_certificate_;
};

void requireSameMaps(const RegionMap& reduced, const RegionMap& original) {
  const auto fail = [&](const std::string& rule) { throw Error(reduced.path() + ": " + rule); };
  if (reduced.reducedFrom() == 0) fail("was not reduced from another map");
  if (original.reducedFrom() != 0) fail(original.path() + " was itself reduced from another map");
  if (reduced.reducedFrom() != original.checksum()) {
    char text[96];
    std::snprintf(text, sizeof text, "was reduced from the map with checksum %016llx, not from ",
                  static_cast<unsigned long long>(reduced.reducedFrom()));
    fail(text + original.path());
  }
  const auto same = [](const std::vector<Signal>& a, const std::vector<Signal>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Signal& x, const Signal& y) {
      return x.name == y.name && x.unit == y.unit && x.lower == y.lower && x.upper == y.upper;
    });
  };
  if (!same(reduced.parameters(), original.parameters()) || !same(reduced.inputs(), original.inputs()))
    fail("parameters or inputs are not those of " + original.path());
  if (reduced.problemText() != original.problemText() || reduced.problemKind() != original.problemKind())
    fail("the problem is not that of " + original.path());
  if (reduced.solverStatus() != original.solverStatus()) fail("the status is not that of " + original.path());
  if (reduced.tolerance() != original.tolerance() || reduced.period() != original.period())
    fail("tolerance or period are not those of " + original.path());
  for (const Signal& signal : original.parameters()) {
    if (!(signal.lower < signal.upper)) fail("parameter " + signal.name + " has no range");
  }
}

/// Lines of dropped rows, then a proof for each region of the original, then of the reduced map.
std::string reductionCertificate(const RegionMap& reduced, const RegionMap& original,
                                 const ReductionReport& report, const std::string& drops,
                                 const std::vector<std::string>& proofs) {
  std::string text = "polyfly reduction certificate 1\n";
  text += mapLine("reduced", reduced) + mapLine("original", original);
  text += "tolerances " + hex(report.law_tolerance) + " " + hex(report.slack) + "\n" + drops;
  for (std::size_t i = 0; i < proofs.size(); ++i) {
    const bool is_original = i < original.regionCount();
    const std::size_t region = is_original ? i : i - original.regionCount();
    text += (is_original ? "O " : "R ") + std::to_string(region) + proofs[i] + "\n";
  }
  return text + certificateEnd(text);
}

}  // namespace

void writeCertificate(const ReductionReport& report, const std::string& path) {
  writeProof(report.certificate, "the reduction", path);
}

const char* toString(ReductionDefect::Kind kind) {
  switch (kind) {
    case ReductionDefect::Kind::kLost:
      return "lost";
    case ReductionDefect::Kind::kClaim:
      return "claim";
    case ReductionDefect::Kind::kAnswer:
      return "answer";
  }
  return "unknown";
}

ReductionReport verifyReduction(const RegionMap& reduced, const RegionMap& original,
                                const ReductionOptions& options) {
  requireSameMaps(reduced, original);
  ReductionReport report;
  report.original_regions = original.regionCount();
  report.reduced_regions = reduced.regionCount();
  report.slack = tolerance::kReductionShare * original.tolerance();
  report.law_tolerance = options.law_tolerance;
  const ReductionProof proof(reduced, original, options, report.slack);
  report.law_error = proof.lawError();
  const std::uint64_t count = report.original_regions + report.reduced_regions;
  std::vector<Finding> findings(count);
  report.interrupted =
      !inParallel(count, options.threads, options.stop, options.progress, [&](std::size_t, std::uint64_t i) {
        const bool is_original = i < report.original_regions;
        const auto region = static_cast<std::uint32_t>(is_original ? i : i - report.original_regions);
        findings[i] = is_original ? proof.checkOriginal(region) : proof.checkReduced(region);
      });
  for (Finding& finding : findings) {
    report.cells += finding.log.parts();
    report.flat_regions += finding.flat ? 1 : 0;
    for (ReductionDefect& defect : finding.defects) report.defects.push_back(std::move(defect));
  }
  std::string drops;
  if (!report.interrupted) report.interrupted = !proveAnswers(reduced, options, drops, report.defects);
  if (options.certificate && report.passed()) {
    std::vector<std::string> proofs;
    for (Finding& finding : findings) proofs.push_back(finding.log.takeText());
    report.certificate = reductionCertificate(reduced, original, report, drops, proofs);
  }
  return report;
}

}  // namespace polyfly
