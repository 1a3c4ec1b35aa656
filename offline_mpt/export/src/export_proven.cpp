#include "export_proven/export_proven.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <utility>

#include "export_bound.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/write_file.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

namespace {

/// Adds pairs to the candidates. False where all were there.
bool addCandidates(const std::set<checker::LeafRegion>& places, std::vector<ExtraCandidate>& extra) {
  const std::size_t before = extra.size();
  for (const auto& [leaf, region] : places) {
    const auto is_same = [leaf = leaf, region = region](const ExtraCandidate& candidate) {
      return candidate.leaf == leaf && candidate.region == region;
    };
    if (std::none_of(extra.begin(), extra.end(), is_same)) extra.push_back({leaf, region});
  }
  return extra.size() != before;
}

/// Proves code with one tolerance. Leaves get the candidates that they lack. Nothing where the code may have no answer
/// though the map has one.
std::optional<ExportBound> proveRepaired(const RegionMap& map, const checker::Map& checked,
                                         ExportOptions& options) {
  constexpr int kMostRepairs = 4;
  options.extra.clear();
  for (int repairs = 0;; ++repairs) {
    const checker::ExportedAnswers proven =
        checker::exportedAnswers(checked, checker::readCode(exportSource(map, options)));
    const bool has_more = repairs < kMostRepairs;
    const bool lacks = has_more && (addCandidates(proven.missing, options.extra) |
                                    addCandidates(proven.jumps, options.extra));
    if (!lacks && proven.missing.empty()) return ExportBound{proven.error, proven.margin};
    if (!lacks) return std::nullopt;
  }
}

}  // namespace

// The checker proves the bound. It reads the code's text and shares nothing with what wrote it. Where the code may
// have no answer though the map has one, its leaves get more candidates; failing that, it gets a greater tolerance.
ProvenExport proveExport(const RegionMap& map, ExportOptions options) {
  constexpr int kRounds = 4;
  constexpr double kGrowth = 4.0;
  try {
    const checker::Map checked{std::string(map.file())};
    for (int round = 0; round < kRounds; ++round, options.tolerance *= kGrowth) {
      const std::optional<ExportBound> bound = proveRepaired(map, checked, options);
      if (bound) return {std::move(options), *bound};
    }
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
