#include "export_proven/export_proven.hpp"

#include <utility>

#include "export_bound.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/write_file.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

// The checker proves the bound. It reads the code's text and shares nothing with what wrote it. Where the code may
// have no answer though the map has one, its leaves get more candidates; failing that, it gets a greater tolerance.
ProvenExport proveExport(const RegionMap& map, ExportOptions options) {
  constexpr int kRounds = 4;
  constexpr double kGrowth = 4.0;
  try {
    const checker::Map checked{std::string(map.file())};
    for (int round = 0; round < kRounds; ++round, options.tolerance *= kGrowth) {
      options.extra.clear();
      for (const bool is_repaired : {false, true}) {
        const checker::ExportedAnswers proven =
            checker::exportedAnswers(checked, checker::readCode(exportSource(map, options)));
        if (proven.missing.empty()) return {std::move(options), {proven.error, proven.margin}};
        if (is_repaired) break;
        for (const auto& [leaf, region] : proven.missing) options.extra.push_back({leaf, region});
      }
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
