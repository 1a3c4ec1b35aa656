#include "offline_mpt/certify.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>

#include "certify/certificate.hpp"
#include "certify/certify_exactly.hpp"
#include "certify/facet_cover_proof.hpp"
#include "certify/lookup/lookup_proof.hpp"
#include "certify/result_bytes.hpp"
#include "certify/shared_loop.hpp"
#include "certify/slivers.hpp"
#include "certify/tolerances.hpp"
#include "certify/unbounded.hpp"
#include "explore/parallel/group_exchange.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/options_text.hpp"
#include "polyfly_base/provenance.hpp"
#include "region_maps/region_map.hpp"
#include "verify/same_signals.hpp"

namespace polyfly {
namespace {

/// Progress from `done_before` to `total`.
std::function<void(std::uint64_t, std::uint64_t)> progressFrom(std::uint64_t done_before, std::uint64_t total,
                                                               const CertifyOptions& options) {
  if (!options.progress) return {};
  return [&options, done_before, total](std::uint64_t done, std::uint64_t) {
    options.progress(std::min(done_before + done, total), total);
  };
}

void requireSameProblem(const RegionMap& map, const ParametricProgram& program) {
  if (map.reducedFrom() != 0) {
    throw Error(
        map.path() +
        ": is a reduced map: prove it by --reduced-from, and the map that it was reduced from by --exact");
  }
  requireSameSignals(map, program);
  if (map.problemText() != program.text)
    throw Error(map.path() + ": the problem text that it carries is not that of the problem " + program.name);
}

/// Results of one map say nothing of another: all processes of a group must prove the same.
void requireSameTask(const RegionMap& map, const CertifyOptions& options) {
  GroupExchange(options.group)
      .requireSame("map " + hexDigits(map.checksum()) + ", tolerances " + exactNumber(options.law_tolerance) +
                   " and " + exactNumber(options.plane_tolerance));
}

/// Rows that no region of the map counts as active.
std::vector<char> rowsNeverActive(const RegionMap& map, int rows) {
  std::vector<char> result(static_cast<std::size_t>(rows), 1);
  for (std::size_t r = 0; r < map.regionCount(); ++r) {
    const RegionView region = map.region(r);
    for (std::uint32_t k = 0; k < region.active_count; ++k) {
      if (region.active[k] >= 0 && region.active[k] < rows)
        result[static_cast<std::size_t>(region.active[k])] = 0;
    }
  }
  return result;
}

constexpr std::uint64_t kMostWidened = 3000;  // regions of a map that is also tried with all moved outwards

struct Closed {
  std::string text;
  std::vector<Defect> defects;
  std::vector<FacetBehind> behind;

  std::uint64_t count(FacetCoverKind kind) const {
    return static_cast<std::uint64_t>(std::count_if(
        behind.begin(), behind.end(), [kind](const FacetBehind& facet) { return facet.kind == kind; }));
  }
};

template <typename Archive>
void members(Archive& archive, Closed& closed) {
  archive(closed.text, closed.defects, closed.behind);
}

/// The check of a set that is missing, if it is a sliver.
struct Missing {
  bool is_sliver = false;
  RegionCheck check;
};

template <typename Archive>
void members(Archive& archive, Missing& missing) {
  archive(missing.is_sliver, missing.check);
}

Closed closeRegion(const FacetCoverProof& cover_proof, const std::vector<RegionCheck>& checks,
                   std::uint32_t region) {
  Closed closed;
  const RegionCheck& check = checks[region];
  if (!check.described) return closed;
  if (cover_proof.find(check.active) != static_cast<int>(region)) {
    closed.defects.push_back(
        regionDefect(Defect::Kind::kRepeated, region, -1,
                     "has the active set of region " + std::to_string(cover_proof.find(check.active))));
    return closed;
  }
  if (check.point.empty()) return closed;
  for (std::uint32_t row = 0; row < check.facets.size() && !cover_proof.stopped(); ++row)
    closed.behind.push_back(cover_proof.close(region, row, closed.text, closed.defects));
  return closed;
}

void add(CertifyReport& report, const RegionCheck& check, const Closed& closed) {
  if (check.is_sliver) ++report.slivers;
  report.left_out_rows += check.left_out;
  report.rows += check.rows;
  report.forgiven_rows += check.forgiven;
  report.implied_rows += check.implied;
  report.facets += check.facets.size();
  report.law_error = std::max(report.law_error, check.law_error);
  report.plane_error = std::max(report.plane_error, check.plane_error);
  report.domain_facets += closed.count(FacetCoverKind::kDomain);
  report.edge_facets += closed.count(FacetCoverKind::kEdge);
  report.matched_facets += closed.count(FacetCoverKind::kMatched);
  report.covered_facets += closed.count(FacetCoverKind::kCovered);
  report.defects.insert(report.defects.end(), check.defects.begin(), check.defects.end());
  report.defects.insert(report.defects.end(), closed.defects.begin(), closed.defects.end());
}

void describePerturbation(const ParametricProgram& source, const ExactProgram& program,
                          const ProgramPerturbation& adjustment, CertifyReport& report) {
  report.linear = program.linear;
  for (const int row : adjustment.dropped)
    (program.is_equality[static_cast<std::size_t>(row)] != 0 ? report.dropped_equalities
                                                             : report.dropped_rows)
        .push_back(row);
  for (const ZeroCombination& proof : adjustment.implied) {
    for (const auto& [row, weight] : proof) {
      const bool given =
          std::find(source.equalities.begin(), source.equalities.end(), row) != source.equalities.end();
      if (!given) report.implied_equalities.push_back(row);
    }
  }
}

/// Closes the facets of all regions; where something is missing that proves to be a sliver, that joins the
/// checks and is closed too, until nothing more is found. `widened`: of the regions moved outwards, without
/// slivers. False when stopped.
bool closeAll(const CheckContext& context, bool widened, std::vector<RegionCheck>& checks,
              std::vector<Closed>& closed) {
  const std::uint64_t count = checks.size();
  std::set<std::vector<int>> tried;
  for (const RegionCheck& check : checks) tried.insert(check.active);
  std::vector<std::uint32_t> open(count);
  std::iota(open.begin(), open.end(), 0u);
  while (!open.empty()) {
    closed.resize(checks.size());
    {
      const FacetCoverProof cover_proof(context, checks, widened);
      const std::uint64_t done_before = 2 * count - std::min<std::uint64_t>(count, open.size());
      std::vector<Closed> now(open.size());
      if (!fillShared<Closed>(now, context.options, progressFrom(done_before, 3 * count, context.options),
                              [&](std::uint32_t k) { return closeRegion(cover_proof, checks, open[k]); }))
        return false;
      for (std::size_t k = 0; k < open.size(); ++k) closed[open[k]] = std::move(now[k]);
    }
    if (widened) break;
    // Regions with a gap, and the sets that may be missing there, sorted. No row may be the right one, too.
    std::vector<std::uint32_t> again;
    std::set<std::vector<int>> sets;
    for (const std::uint32_t r : open) {
      bool has_gap = false;
      for (const Defect& defect : closed[r].defects) {
        if (defect.kind != Defect::Kind::kGap) continue;
        has_gap = true;
        if (tried.insert(defect.missing).second) sets.insert(defect.missing);
      }
      if (has_gap) again.push_back(r);
    }
    const std::vector<std::vector<int>> candidates(sets.begin(), sets.end());
    std::vector<Missing> missing(candidates.size());
    if (!fillShared<Missing>(missing, context.options, progressFrom(2 * count, 3 * count, context.options),
                             [&](std::uint32_t k) {
                               Missing one;
                               one.is_sliver = checkSliver(context, checks, candidates[k], one.check);
                               return one;
                             }))
      return false;
    open.clear();
    for (Missing& one : missing) {
      if (!one.is_sliver) continue;
      open.push_back(static_cast<std::uint32_t>(checks.size()));
      checks.push_back(std::move(one.check));
    }
    if (!open.empty()) std::copy(again.begin(), again.end(), std::back_inserter(open));
  }
  return true;
}

bool checkAllRegions(const CheckContext& context, std::vector<RegionCheck>& checks) {
  const std::uint64_t count = context.map.regionCount();
  checks.assign(count, {});
  return fillShared<RegionCheck>(checks, context.options, progressFrom(0, 3 * count, context.options),
                                 [&](std::uint32_t r) { return checkRegion(context, r); });
}

StatedTolerances statedTolerances(const std::vector<RegionCheck>& checks, const CertifyOptions& options) {
  const bool is_tight = std::all_of(checks.begin(), checks.end(), [](const RegionCheck& check) {
    return check.law_error <= tolerance::kTightLaw;
  });
  const double law = options.law_tolerance;
  return {is_tight ? std::min(tolerance::kTightLaw, law) : law, options.plane_tolerance};
}

/// CertifyReport::beyond_facet: a look-up answers within 9 tolerances of the plane on which two laws agree.
double greatestDifferenceBeyondFacets(const CheckContext& context, double law_tolerance) {
  const RegionMap& map = context.map;
  const auto p = static_cast<std::size_t>(context.program.p), q = static_cast<std::size_t>(context.program.q);
  double greatest_u = 0.0, greatest_change = 0.0;
  for (std::size_t k = 0; k < map.lawCount() * q; ++k) {
    const double* const row = map.law(k / q) + k % q * (p + 1);
    double change = 0.0;
    for (std::size_t j = 0; j < p; ++j) change += std::abs(row[j]) * context.program.half[j].get_d();
    greatest_change = std::max(greatest_change, change);
    greatest_u = std::max(greatest_u, context.lawScale(k % q, row).get_d());
  }
  return 18.0 * map.tolerance() * greatest_change + 2.0 * law_tolerance * greatest_u;
}

/// What is proven of a program, and how its certificate begins.
struct Statement {
  bool widened = false;
  std::string head;
};

/// Closes the facets and proves the look-ups of regions that are checked. `report` is described already.
void finish(const CheckContext& context, const Statement& statement, std::vector<RegionCheck>& checks,
            CertifyReport& report) {
  report.regions = context.map.regionCount();
  report.plane_tolerance = context.options.plane_tolerance;
  report.widened = statement.widened;
  std::vector<Closed> closed;
  report.interrupted = report.interrupted || !closeAll(context, statement.widened, checks, closed);
  closed.resize(checks.size());
  for (std::size_t r = 0; r < checks.size(); ++r) add(report, checks[r], closed[r]);
  std::string lookups;
  if (report.passed()) {
    std::vector<std::vector<FacetBehind>> behind;
    for (Closed& region : closed) behind.push_back(std::move(region.behind));
    report.interrupted = !proveLookups(context, checks, behind, statement.widened, lookups, report.defects);
  }
  if (!report.passed()) {
    markUnboundedDefects(context, report.defects);
    return;
  }
  // What a map leaves out has laws and half-spaces that the bound does not know.
  const bool is_whole = report.slivers == 0 && report.left_out_rows == 0;
  if (!report.linear && !report.widened && is_whole)
    report.beyond_facet =
        greatestDifferenceBeyondFacets(context, statedTolerances(checks, context.options).law);
  report.certificate = statement.head;
  for (std::size_t r = 0; r < checks.size(); ++r) {
    if (r < report.regions) report.certificate += "region " + std::to_string(r) + "\n";
    report.certificate += checks[r].text + closed[r].text;
    checks[r].text.clear();
  }
  report.certificate += lookups;
  report.certificate += certificateEnd(report.certificate);
}

CertifyReport finish(const CheckContext& context, const ProgramPerturbation& adjustment, bool widened,
                     std::vector<RegionCheck>& checks, bool interrupted) {
  CertifyReport report;
  report.interrupted = interrupted;
  describePerturbation(context.source, context.program, adjustment, report);
  const std::string head = certificateHead(context.map, context.source, adjustment, widened,
                                           statedTolerances(checks, context.options));
  finish(context, {widened, head}, checks, report);
  return report;
}

/// Whether all regions are right, and the search tree is not.
bool onlyLookups(const std::vector<Defect>& defects) {
  return std::all_of(defects.begin(), defects.end(),
                     [](const Defect& defect) { return defect.kind == Defect::Kind::kLookup; });
}

}  // namespace

CertifyReport certifyExactly(const CheckContext& context,
                             const std::function<std::string(const StatedTolerances&)>& head) {
  CertifyReport report;
  report.linear = context.program.linear;
  std::vector<RegionCheck> checks;
  report.interrupted = !checkAllRegions(context, checks);
  finish(context, {false, head(statedTolerances(checks, context.options))}, checks, report);
  return report;
}

CertifyReport certify(const RegionMap& map, const ParametricProgram& program, const CertifyOptions& options) {
  checkProgram(program);
  requireSameProblem(map, program);
  requireSameTask(map, options);
  const ProgramPerturbation adjustment = adjust(program, rowsNeverActive(map, program.rowCount()));
  const ExactProgram exact(program, adjustment);
  const CheckContext context{map, program, exact, options};
  std::vector<RegionCheck> checks;
  const bool finished = checkAllRegions(context, checks);
  CertifyReport as_given = finish(context, adjustment, false, checks, !finished);
  if (as_given.passed() || as_given.interrupted || map.regionCount() > kMostWidened ||
      onlyLookups(as_given.defects))
    return as_given;
  // Where coincidences hold up to rounding only, slivers between regions may be too many or too thin to be described: the
  // regions moved outwards then cover all.
  std::vector<RegionCheck> again;
  ExactProgram forgiving = exact;
  forgiving.forgiving = true;
  const CheckContext second{map, program, forgiving, options};
  if (!checkAllRegions(second, again)) return as_given;
  CertifyReport widened = finish(second, adjustment, true, again, false);
  if (widened.passed() || widened.interrupted) return widened;
  return as_given;
}

void runCertifyProcess(const RegionMap& map, const ParametricProgram& program,
                       const CertifyOptions& options) {
  try {
    certify(map, program, options);
  } catch (const GroupExchange::Ended&) {  // process 0 has said why
  } catch (const std::exception& error) {
    reportFailure(error.what(), *options.group);
  }
}

}  // namespace polyfly
