// Flies for long while everything goes wrong at random, and leaves summary.json and the report.
#include "polyfly_test/soak.hpp"

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command_line/command_line.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/write_file.hpp"
#include "region_maps/region_map.hpp"

namespace {

using namespace polyfly_test;

constexpr const char* kAxes[] = {"longitudinal", "lateral", "vertical"};

/// Resident memory of this process [kB].
long residentMemory() {
  std::ifstream file("/proc/self/status");
  for (std::string word; file >> word;) {
    long value = 0;
    if (word == "VmRSS:" && file >> value) return value;
  }
  return 0;
}

nlohmann::json toJson(const SoakResult& result, const SoakOptions& options, long grown) {
  const long faults = result.silences + result.not_numbers + result.jumps + result.out_of_order +
                      result.wrong_frames + result.huge;
  nlohmann::json json = {{"seed", options.seed},
                         {"simulated_s", options.duration},
                         {"samples", result.samples},
                         {"commands", result.commands},
                         {"silences", result.silences},
                         {"not_numbers", result.not_numbers},
                         {"jumps", result.jumps},
                         {"out_of_order", result.out_of_order},
                         {"wrong_frames", result.wrong_frames},
                         {"huge", result.huge},
                         {"reconfigurations", result.reconfigurations},
                         {"map_swaps", result.swaps},
                         {"law_selections", result.selections},
                         {"references", result.references},
                         {"samples_without_answer", result.failsafe},
                         {"recoveries", result.recoveries},
                         {"slowest_recovery_s", result.slowest},
                         {"greatest_error_m", result.greatest_error},
                         {"allocated_growth_bytes", result.allocated_growth},
                         {"resident_growth_kb", grown},
                         {"violations", result.violations}};
  json["headline"] = {{"simulated time", options.duration, "s"},
                      {"faults of odometry", faults, ""},
                      {"reconfigurations, map swaps and law changes",
                       result.reconfigurations + result.swaps + result.selections, ""},
                      {"violated bounds and faults not recovered from", result.violations.size(), ""},
                      {"slowest recovery", result.slowest, "s"},
                      {"greatest error once recovered", result.greatest_error, "m"},
                      {"growth of the memory in use", result.allocated_growth, "bytes"},
                      {"growth of the resident memory", grown, "kB"}};
  return json;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Flies for long in simulated time while everything goes wrong at random.", "soak");
  std::vector<std::string> folders;
  std::string problems, output;
  SoakOptions options;
  app.add_option("--maps", folders,
                 "folders of multirotor_AXIS.map and aslquad_AXIS.map, which are swapped for each other")
      ->required();
  app.add_option("--problems", problems, "folder of the problem files of the linear law")->required();
  app.add_option("--duration", options.duration, "simulated time [s]")->check(polyfly::numberAbove(0.0));
  app.add_option("--seed", options.seed, "the same seed, the same flight")
      ->check(polyfly::wholeNumber<std::uint32_t>());
  app.add_option("-o,--output", output, "folder for summary.json")->required();
  return polyfly::runTool(app, argc, argv, [&] {
    using polyfly::Output;
    const std::string page = output + "/summary.json";
    polyfly::checkOutputs({{page, Output::Kind::kText, Output::Folder::kIsMade}}, {});
    SoakLaws laws;
    std::vector<polyfly::RegionMap> maps;
    maps.reserve(6 * folders.size());
    for (const std::string& folder : folders) {
      for (const char* vehicle : {"/multirotor_", "/aslquad_"})
        for (const char* axis : kAxes)
          maps.push_back(polyfly::RegionMap::open(folder + vehicle + axis + ".map"));
      const polyfly::RegionMap* first = &maps[maps.size() - 6];
      laws.maps.push_back({first, first + 1, first + 2});
      laws.robust_maps.push_back({first + 3, first + 4, first + 5});
    }
    options.laws.emplace_back("robust_explicit");
    for (std::size_t i = 0; i < 3; ++i)
      laws.problems[i] = polyfly::loadProblem(problems + "/multirotor_" + kAxes[i] + ".yaml");
    long resident = 0;
    const SoakResult result = soak(laws, options, [&](double now) {
      if (now < 0.2 * options.duration) resident = residentMemory();
      std::fprintf(stderr, "[%ld/%ld] s\n", static_cast<long>(now), static_cast<long>(options.duration));
    });
    const nlohmann::json json = toJson(result, options, residentMemory() - resident);
    polyfly::makeFolder(output);
    polyfly::writeFileAtomically(page, json.dump(2) + '\n');
    return result.violations.empty() ? 0 : 1;
  });
}
