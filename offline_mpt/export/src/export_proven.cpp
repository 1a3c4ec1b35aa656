#include "export_proven/export_proven.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "export_bound.hpp"
#include "leaf_rows.hpp"
#include "lookup_work.hpp"
#include "mpc_core/safety_filter.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/write_file.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

namespace {

/// The map's candidates with the rows that they need. Code of doubles tests what the map tests.
std::vector<ChosenCandidate> neededRows(const RegionMap& map, const LeafRows& rows) {
  std::vector<ChosenCandidate> chosen;
  for (std::uint32_t i = 0; i < map.leafCount(); ++i) {
    const LeafView leaf = map.leaf(i);
    for (std::uint32_t k = 0; k < leaf.count; ++k) {
      const std::uint32_t region = leaf.candidates[k];
      chosen.push_back({i, region, rows.testsOf(i, region, leaf.testsOf(k))});
    }
  }
  return chosen;
}

/// Adds regions to leaves, with the rows that they need, or without `rows` with all. False where all were there.
bool addCandidates(const std::set<checker::LeafRegion>& places, const LeafRows* rows,
                   std::vector<ChosenCandidate>& chosen) {
  std::set<checker::LeafRegion> known;
  for (const ChosenCandidate& candidate : chosen) known.emplace(candidate.leaf, candidate.region);
  const std::size_t before = chosen.size();
  for (const checker::LeafRegion& place : places) {
    const auto [leaf, region] = place;
    if (known.insert(place).second)
      chosen.push_back({leaf, region, rows ? rows->testsOf(leaf, region) : MapContent::kAllRows});
  }
  return chosen.size() != before;
}

enum class AddedRows { kNeeded, kAll };

/// What is proven of code, and the options that give it.
struct ProvenCode {
  ExportOptions options;
  checker::ExportedCode code;
  ExportBound bound;
};

/// Proves code with one tolerance. Leaves get the candidates that they lack. Nothing where the code may have no answer
/// though the map has one.
std::optional<ProvenCode> proveRepaired(const RegionMap& map, const checker::Map& checked,
                                        const checker::ProofWatch& watch, AddedRows added,
                                        ExportOptions options) {
  constexpr int kMostRepairs = 4;
  options.chosen.clear();
  const checker::LookupTables first =
      checker::withPlanesOf(checker::lookupOf(checked), checker::readCode(exportSource(map, options)).tables,
                            std::numeric_limits<double>::infinity());
  const LeafRows rows(checked, first);
  const LeafRows* const of_added = added == AddedRows::kNeeded ? &rows : nullptr;
  if (options.type != ExportType::kDouble) options.chosen = neededRows(map, rows);
  for (int repairs = 0;; ++repairs) {
    checker::ExportedCode code = checker::readCode(exportSource(map, options));
    const checker::ExportedAnswers proven = checker::exportedAnswers(checked, code, watch);
    bool lacks = false;
    if (repairs < kMostRepairs) {
      lacks = addCandidates(proven.missing, of_added, options.chosen);
    }
    if (lacks) continue;
    if (!proven.missing.empty()) return std::nullopt;
    return ProvenCode{std::move(options), std::move(code), {proven.error, proven.margin, {}, {}}};
  }
}

/// Whether an error is less than a half of another one, and none is greater.
bool isMuchBetter(const ExportBound& bound, const ExportBound& than) {
  constexpr double kMuch = 0.5;
  bool is_less = false;
  for (std::size_t j = 0; j < bound.error.size(); ++j) {
    if (bound.error[j] > than.error[j]) return false;
    is_less = is_less || bound.error[j] < kMuch * than.error[j];
  }
  return is_less;
}

/// The error of each input for which a safety filter's set is proven; of other maps, none.
std::vector<double> allowedErrors(const RegionMap& map) {
  const std::string text(map.problemText()), source = map.path() + ": problem text";
  if (map.problemKind() != "yaml" || text.empty() || !isSafetyFilter(text, source)) return {};
  const SafetyFilterProblem problem = parseSafetyFilter(text, source);
  return {problem.input_errors.data(), problem.input_errors.data() + problem.input_errors.size()};
}

ProvenExport withFacts(const RegionMap& map, ProvenCode proven) {
  ExportBound& bound = proven.bound;
  const checker::LookupWork work = checker::greatestWork(proven.code.tables);
  bound.allowed = allowedErrors(map);
  bound.work = {work.sums, work.comparisons};
  return {std::move(proven.options), std::move(bound)};
}

}  // namespace

// The checker proves the bound. It reads the code's text and shares nothing with what wrote it. Where the code may
// have no answer though the map has one, its leaves get more candidates; failing that, it gets a greater tolerance.
ProvenExport proveExport(const RegionMap& map, ExportOptions options, const ExportProofOptions& proof) {
  constexpr int kRounds = 4;
  constexpr double kGrowth = 4.0;
  try {
    const checker::Map checked{std::string(map.file())};
    for (int round = 0; round < kRounds; ++round, options.tolerance *= kGrowth) {
      const checker::ProofWatch watch = {proof.stop, proof.progress};
      std::optional<ProvenCode> code = proveRepaired(map, checked, watch, AddedRows::kNeeded, options);
      if (!code) continue;
      if (options.type != ExportType::kDouble) {
        // A candidate that was added for a steep law may differ much where its rows hold by the tolerance only.
        std::optional<ProvenCode> whole = proveRepaired(map, checked, watch, AddedRows::kAll, options);
        if (whole && isMuchBetter(whole->bound, code->bound)) code = std::move(whole);
      }
      return withFacts(map, std::move(*code));
    }
  } catch (const checker::Stopped&) {
    throw Error(map.path() + ": the proof of its code was interrupted");
  } catch (const checker::Refused& refused) {
    throw Error(map.path() + ": its code could not be proven: " + refused.what());
  }
  throw Error(map.path() +
              ": its code could not be proven: rounding may find no region where the map has one");
}

void checkExportOutputs(const std::string& folder, const std::string& name,
                        const std::vector<std::string>& inputs) {
  checkExportName(name);
  if (folder.empty()) throw Error("the folder to write to must have a name");
  const std::string stem = folder + "/" + name;
  const Output::Folder made = Output::Folder::kIsMade;
  checkOutputs({{stem + ".c", Output::Kind::kText, made},
                {stem + ".h", Output::Kind::kText, made},
                {stem + "_test.c", Output::Kind::kText, made},
                {stem + ".json", Output::Kind::kText, made}},
               inputs);
}

void writeExport(const RegionMap& map, const ProvenExport& proven, const std::string& folder) {
  const auto& [options, bound] = proven;
  const std::string stem = folder + "/" + options.name;
  makeFolder(folder);
  writeFileAtomically(stem + ".c", exportSource(map, options));
  writeFileAtomically(stem + ".h", exportHeader(map, options, bound));
  writeFileAtomically(stem + "_test.c", exportTest(map, options, bound));
  writeFileAtomically(stem + ".json", exportFacts(map, options, bound));
}

}  // namespace polyfly
