#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "polyfly_base/provenance.hpp"
#include "polyfly_base/visible.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

const char kInfoFooter[] =
    R"(The command checks the whole file before it prints anything.

Examples:
  offline_mpt info lateral.map
  offline_mpt info lateral.map --json)";

struct InfoArguments {
  std::string map;
  bool json = false;
};

nlohmann::ordered_json signalsJson(const std::vector<Signal>& signals) {
  auto list = nlohmann::ordered_json::array();
  for (const Signal& signal : signals) {
    // JSON has no infinity: a missing bound is null.
    nlohmann::ordered_json entry = {
        {"name", signal.name}, {"unit", signal.unit}, {"lower", nullptr}, {"upper", nullptr}};
    if (std::isfinite(signal.lower)) entry["lower"] = signal.lower;
    if (std::isfinite(signal.upper)) entry["upper"] = signal.upper;
    list.push_back(entry);
  }
  return list;
}

/// As hexadecimal digits; empty for none.
std::string checksumText(std::uint64_t checksum) { return checksum != 0 ? hexDigits(checksum) : ""; }

// What the problem's text tells of where its numbers are from: the lines under `provenance`, which
// `calibrate` writes and which stand at its end.
std::string_view originOf(const RegionMap& map) {
  constexpr std::string_view kKey = "\nprovenance:\n";
  const std::string_view text = map.problemText();
  const std::size_t place = text.find(kKey);
  if (place == std::string_view::npos) return {};
  const std::string_view rest = text.substr(place + kKey.size());
  std::size_t end = 0;
  while (end < rest.size() && rest[end] == ' ') end = std::min(rest.find('\n', end), rest.size() - 1) + 1;
  return rest.substr(0, end);
}

void printJson(const RegionMap& map) {
  nlohmann::ordered_json json;
  json["file"] = map.path();
  json["name"] = map.name();
  json["problem_kind"] = map.problemKind();
  json["status"] = map.solverStatus();
  json["period"] = map.period();
  json["tolerance"] = map.tolerance();
  json["parameters"] = signalsJson(map.parameters());
  json["inputs"] = signalsJson(map.inputs());
  json["regions"] = map.regionCount();
  json["laws"] = map.lawCount();
  json["planes"] = map.planeCount();
  json["reduced_from"] = checksumText(map.reducedFrom());
  json["checksum"] = checksumText(map.checksum());
  json["nodes"] = map.nodeCount();
  json["leaves"] = map.leafCount();
  json["depth"] = map.cost().depth;
  json["region_checks"] = map.cost().region_checks;
  json["multiply_adds"] = map.cost().multiply_adds;
  json["format_version"] = map.formatVersion();
  json["bytes"] = map.bytes();
  json["notes"] = map.solverNotes();
  json["provenance"] = originOf(map);
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
}

void printSignals(const char* title, const std::vector<Signal>& signals) {
  std::printf("%s\n", title);
  std::size_t width = 4;
  for (const Signal& signal : signals) width = std::max(width, signal.name.size());
  for (const Signal& signal : signals) {
    std::printf("  %-*s  %.10g .. %.10g %s\n", static_cast<int>(width), signal.name.c_str(), signal.lower,
                signal.upper, signal.unit.c_str());
  }
}

void printNotes(std::string_view notes) {
  while (!notes.empty()) {
    const std::size_t end = std::min(notes.find('\n'), notes.size());
    std::printf("  %s\n", visible(notes.substr(0, end)).c_str());
    notes.remove_prefix(std::min(end + 1, notes.size()));
  }
}

void printText(const RegionMap& map) {
  std::printf("%s: %.*s, %.*s\n", map.path().c_str(), static_cast<int>(map.name().size()), map.name().data(),
              static_cast<int>(map.solverStatus().size()), map.solverStatus().data());
  printSignals("parameters", map.parameters());
  printSignals("inputs", map.inputs());
  if (map.period() > 0.0) {
    std::printf("period      %.10g s\n", map.period());
  } else {
    std::printf("period      none\n");
  }
  std::printf("tolerance   %.3g of half a range\n", map.tolerance());
  std::printf("regions     %zu\nlaws        %zu\nplanes      %zu\nnodes       %zu\nleaves      %zu\n",
              map.regionCount(), map.lawCount(), map.planeCount(), map.nodeCount(), map.leafCount());
  std::printf("format      version %u\n", map.formatVersion());
  std::printf("bytes       %zu\nchecksum    %s\n", map.bytes(), checksumText(map.checksum()).c_str());
  if (map.reducedFrom() != 0) {
    std::printf("reduced     from the map with checksum %s\n", checksumText(map.reducedFrom()).c_str());
  }
  std::printf("worst case  depth %u, %u half-spaces at a leaf, %llu multiply-adds\n", map.cost().depth,
              map.cost().region_checks, static_cast<unsigned long long>(map.cost().multiply_adds));
  std::printf("problem     %.*s, %zu bytes of text\n", static_cast<int>(map.problemKind().size()),
              map.problemKind().data(), map.problemText().size());
  if (!originOf(map).empty()) {
    std::printf("provenance\n");
    printNotes(originOf(map));
  }
  if (!map.solverNotes().empty()) {
    std::printf("notes\n");
    printNotes(map.solverNotes());
  }
}

ExitCode info(const InfoArguments& options) {
  const RegionMap map = RegionMap::open(options.map);
  if (options.json) {
    printJson(map);
  } else {
    printText(map);
  }
  return ExitCode::kDone;
}

}  // namespace

void addInfo(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<InfoArguments>();
  CLI::App* command = app.add_subcommand("info", "Show the content of a map and the cost of a look-up.");
  command->footer(kInfoFooter);
  command->add_option("MAP", options->map, "Map file.")->required();
  command->add_flag("--json", options->json, "Print JSON.");
  command->callback([options, &exit_code] { exit_code = info(*options); });
}

}  // namespace polyfly
