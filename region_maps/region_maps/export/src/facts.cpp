#include <algorithm>

#include "code_tables.hpp"
#include "map_facts.hpp"

namespace polyfly {
namespace {

/// Of the ATmega328P. [bytes]
constexpr std::size_t kAtmega328pFlash = 32768;

std::size_t bytesOf(ExportType type) { return type == ExportType::kDouble ? sizeof(double) : sizeof(float); }

std::string errorList(const ExportBound& bound) {
  std::string text = "[";
  for (std::size_t j = 0; j < bound.error.size(); ++j)
    text += (j == 0 ? "" : ", ") + roundedUp(bound.error[j]);
  return text + "]";
}

/// Lines of a safety filter.
std::string allowanceFacts(const ExportBound& bound) {
  if (bound.allowed.empty()) return "";
  std::string text = ",\n  \"error_allowed\": [";
  for (std::size_t j = 0; j < bound.allowed.size(); ++j)
    text += (j == 0 ? "" : ", ") + roundedDown(bound.allowed[j]);
  return text + "],\n  \"is_allowed\": " + (bound.isAllowed() ? "true" : "false");
}

std::string workText(const RegionMap& map, const LookupWork& work) {
  const std::uint64_t multiply_adds = work.sums * map.parameters().size();
  return "{\"multiply_adds\": " + std::to_string(multiply_adds) +
         ", \"comparisons\": " + std::to_string(work.comparisons) + "}";
}

std::size_t tableBytes(const CodeTables& tables, ExportType type) {
  std::size_t bytes = bytesOf(type) * (tables.planes.size() + tables.laws.size() + tables.box.size() + 1);
  for (const std::vector<std::uint32_t>* table :
       {&tables.node_plane, &tables.node_child, &tables.leaf_first, &tables.candidate_region,
        &tables.candidate_first, &tables.rows, &tables.region_law}) {
    bytes += indexBytes(*table) * table->size();
  }
  return bytes;
}

/// Instructions of the look-up, which hardly depend on the map: the most of maps of 1 to 12 parameters and 1 to 3 inputs by
/// GCC 12.2 and AVR GCC 5.4, with -O2 and -Os, and a tenth more for other versions. [bytes]
struct CodeBytes {
  std::size_t cortex_m4f, atmega328p;
};

CodeBytes codeBytes(ExportType type) {
  switch (type) {
    case ExportType::kDouble:
      return {3250, 0};
    case ExportType::kFloat:
      return {830, 2400};
  }
  return {};
}

}  // namespace

std::size_t FlashBytes::total() const { return tables + std::max(cortex_m4f, atmega328p); }

FlashBytes exportFlashBytes(const RegionMap& map, const ExportOptions& options) {
  const CodeBytes code = codeBytes(options.type);
  FlashBytes flash = {tableBytes(codeTables(map, options), options.type), code.cortex_m4f, code.atmega328p};
  if (flash.tables + flash.atmega328p > kAtmega328pFlash) flash.atmega328p = 0;
  return flash;
}

std::size_t exportStackBytes(const RegionMap& map, const ExportOptions& options) {
  struct Frame {
    /// Addresses, indices and statuses; numbers of the type.
    std::size_t words, numbers;
  };
  const std::size_t terms = map.parameters().size() + 1;
  // evaluate, locate, violation or holds, distance: see kSourceTemplate.
  const std::vector<Frame> frames = options.type == ExportType::kDouble
                                        ? std::vector<Frame>{{8, 1}, {8, 3}, {5, 3}, {2, terms}}
                                        : std::vector<Frame>{{8, 1}, {8, 1}, {6, 2}, {2, terms}};
  constexpr std::size_t kWord = 4, kCall = 16;
  std::size_t bytes = 0;
  for (const Frame& frame : frames)
    bytes += kCall + kWord * frame.words + bytesOf(options.type) * frame.numbers;
  return bytes;
}

std::string exportFacts(const RegionMap& map, const ExportOptions& options, const ExportBound& bound) {
  const FlashBytes flash = exportFlashBytes(map, options);
  const Replacements keys = mapKeys(map, options);
  const auto number = [](std::uint64_t value) { return std::to_string(value); };
  return "{\n  \"name\": \"" + options.name + "\",\n  \"type\": \"" + std::string(toString(options.type)) +
         "\",\n  \"version\": \"" + keys.at("version") + "\",\n  \"map\": \"" + keys.at("checksum") +
         "\",\n  \"problem\": \"" + keys.at("problem_hash") + "\",\n  \"parameters\": " + keys.at("p") +
         ",\n  \"inputs\": " + keys.at("m") + ",\n  \"regions\": " + keys.at("regions") +
         ",\n  \"flash_bytes\": " + number(flash.total()) + ",\n  \"table_bytes\": " + number(flash.tables) +
         ",\n  \"code_bytes\": {\"cortex_m4f\": " + number(flash.cortex_m4f) +
         (flash.atmega328p == 0 ? "" : ", \"atmega328p\": " + number(flash.atmega328p)) + "}" +
         ",\n  \"stack_bytes\": " + number(exportStackBytes(map, options)) +
         ",\n  \"writable_bytes\": 0,\n  \"worst_case\": " + workText(map, bound.work) +
         ",\n  \"error_bound\": " + errorList(bound) + ",\n  \"margin\": " + roundedUp(bound.margin) +
         allowanceFacts(bound) + "\n}\n";
}

}  // namespace polyfly
