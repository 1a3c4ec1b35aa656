#include <cstdio>

#include "code_tables.hpp"
#include "map_facts.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kDoubleBytes = 8;
constexpr std::size_t kFloatBytes = 4;

std::string errorList(const ExportBound& bound) {
  std::string text = "[";
  for (std::size_t j = 0; j < bound.error.size(); ++j)
    text += (j == 0 ? "" : ", ") + roundedUp(bound.error[j]);
  return text + "]";
}

std::size_t bytesOf(const CodeTables& tables, ExportType type) {
  const std::size_t real = type == ExportType::kDouble ? kDoubleBytes : kFloatBytes;
  std::size_t bytes = real * (tables.planes.size() + tables.laws.size() + tables.box.size() + 1);
  for (const std::vector<std::uint32_t>* table :
       {&tables.node_plane, &tables.node_child, &tables.leaf_first, &tables.candidate_region,
        &tables.candidate_first, &tables.rows, &tables.region_law}) {
    bytes += indexBytes(*table) * table->size();
  }
  return bytes;
}

}  // namespace

std::size_t exportTableBytes(const RegionMap& map, const ExportOptions& options) {
  return bytesOf(codeTables(map, options), options.type);
}

std::string exportFacts(const RegionMap& map, const ExportOptions& options, const ExportBound& bound) {
  const CodeTables tables = codeTables(map, options);
  const CodeCost cost = codeCost(map, tables);
  const Replacements keys = sharedKeys(map, options);
  const auto number = [](std::uint64_t value) { return std::to_string(value); };
  return "{\n  \"name\": \"" + options.name + "\",\n  \"type\": \"" + keys.at("real") +
         "\",\n  \"version\": \"" + keys.at("version") + "\",\n  \"map\": \"" + keys.at("checksum") +
         "\",\n  \"problem\": \"" + keys.at("problem_hash") + "\",\n  \"parameters\": " + keys.at("p") +
         ",\n  \"inputs\": " + keys.at("m") + ",\n  \"regions\": " + keys.at("regions") +
         ",\n  \"table_bytes\": " + number(bytesOf(tables, options.type)) +
         ",\n  \"writable_bytes\": 0,\n  \"worst_case\": {\"nodes\": " + number(cost.nodes) +
         ", \"rows\": " + number(cost.rows) + ", \"multiply_adds\": " + number(cost.multiply_adds) +
         ", \"comparisons\": " + number(cost.comparisons) + "},\n  \"error_bound\": " + errorList(bound) +
         ",\n  \"margin\": " + roundedUp(bound.margin) + "\n}\n";
}

}  // namespace polyfly
