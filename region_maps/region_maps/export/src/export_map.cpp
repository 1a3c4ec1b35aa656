#include "map_export/export_map.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <limits>

#include "code_tables.hpp"
#include "floating_arithmetic.hpp"
#include "header_template.hpp"
#include "map_facts.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/provenance.hpp"
#include "polyfly_base/version.hpp"
#include "region_maps/format.hpp"
#include "source_template.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kMaxName = 24;
/// Up to so many parameters, RegionMap adds by halves.
constexpr std::size_t kMaxWrittenOut = 8;

/// Terms [first, end) of a . theta - c, added by halves as RegionMap adds them.
std::string sumTerms(std::size_t first, std::size_t end, std::size_t p, const std::string& names) {
  const auto entry = [&names](std::size_t i) { return names + "[plane][" + std::to_string(i) + "])"; };
  if (end - first == 1) return "(" + entry(first) + " * theta[" + std::to_string(first) + "])";
  const std::size_t middle = (first + end + 1) / 2;
  const std::string left = sumTerms(first, middle, p, names);
  if (end - middle == 1 && middle == p) return "(" + left + " - " + entry(p) + ")";
  return "(" + left + "\n            + " + sumTerms(middle, end, p, names) + ")";
}

std::string readerOf(const std::vector<std::uint32_t>& values, const std::string& upper) {
  return upper + "_U" + std::to_string(8 * indexBytes(values));
}

std::string indexType(const std::vector<std::uint32_t>& values) {
  return "uint" + std::to_string(8 * indexBytes(values)) + "_t";
}

/// The type of local indices: it holds each element of a table, and each product that the code forms.
std::string localIndex(const RegionMap& map, const CodeTables& tables) {
  const std::uint64_t greatest =
      std::max({std::uint64_t{2} * map.planeCount(), std::uint64_t{map.nodeCount()} + map.leafCount(),
                std::uint64_t{map.lawCount()} * map.inputs().size(), std::uint64_t{tables.rows.size()},
                std::uint64_t{tables.candidate_region.size()} + 1, std::uint64_t{map.regionCount()}});
  if (greatest > std::numeric_limits<std::uint32_t>::max())
    throw Error("MAP: has more table entries than 32-bit indices reach");
  return greatest <= std::numeric_limits<std::uint16_t>::max() ? "unsigned int" : "uint32_t";
}

std::string boundText(const ExportOptions& options, const RegionMap& map, const ExportBound& bound) {
  if (options.type == ExportType::kDouble) {
    return " * Answers are those of the map's look-up, bit for bit, where the code is compiled with\n"
           " * -ffp-contract=off.\n";
  }
  std::string text =
      " * Proven: where the map has an answer at a parameter, the code given that parameter rounded to the "
      "nearest\n"
      " * number answers OK, with inputs that differ from the map's by at most\n";
  for (std::size_t j = 0; j < bound.error.size(); ++j) {
    text += " *   " + commentText(map.inputs()[j].name) + ": " + roundedUp(bound.error[j]) + " " +
            commentText(map.inputs()[j].unit) + "\n";
  }
  text += " * Where the code answers OK, the parameter violates no half-space of the region by more than " +
          roundedUp(bound.margin) +
          ",\n"
          " * as a distance when each parameter's range is [-1, 1].\n";
  return text;
}

/// What a safety filter's proof says of this code.
std::string filterText(const RegionMap& map, const ExportBound& bound) {
  if (bound.allowed.empty()) return "";
  std::string text =
      " *\n * Safety filter: its set is proven for inputs that differ from the optimum by at most\n";
  for (std::size_t j = 0; j < bound.allowed.size(); ++j) {
    text += " *   " + commentText(map.inputs()[j].name) + ": " + roundedDown(bound.allowed[j]) + " " +
            commentText(map.inputs()[j].unit) + "\n";
  }
  return text + (bound.isAllowed()
                     ? " * The answers of this code, limited to the ranges of u, are within that.\n"
                     : " * The answers of this code are NOT within that: the set is not proven for them.\n");
}

void addTable(Replacements& keys, const std::string& name, const std::vector<std::uint32_t>& values,
              std::size_t width = 0) {
  keys[name] = initialiser(values, width);
  keys[name + "_type"] = indexType(values);
  keys[name + "_read"] = readerOf(values, keys.at("NAME"));
}

void addTables(Replacements& keys, const RegionMap& map, const CodeTables& tables, ExportType type) {
  const std::size_t p1 = map.parameters().size() + 1;
  keys["box"] = initialiser(tables.box, 2, type);
  keys["planes"] = initialiser(tables.planes, p1, type);
  keys["plane_rows"] = std::to_string(rowCount(tables.planes.size(), p1));
  keys["laws"] = initialiser(tables.laws, p1, type);
  keys["law_rows"] = std::to_string(rowCount(tables.laws.size(), p1));
  addTable(keys, "node_plane", tables.node_plane);
  addTable(keys, "node_child", tables.node_child, 2);
  addTable(keys, "leaf_first", tables.leaf_first);
  keys["leaf_rows"] = std::to_string(tables.leaf_first.size());
  addTable(keys, "candidate_region", tables.candidate_region);
  keys["candidate_rows"] = std::to_string(rowCount(tables.candidate_region.size(), 1));
  addTable(keys, "candidate_first", tables.candidate_first);
  keys["candidate_ends"] = std::to_string(tables.candidate_first.size());
  addTable(keys, "row", tables.rows);
  keys["rows"] = keys["row"];
  keys["row_rows"] = std::to_string(rowCount(tables.rows.size(), 1));
  addTable(keys, "region_law", tables.region_law);
  keys["region_rows"] = std::to_string(tables.region_law.size());
}

/// The parts of NAME.c that search a leaf.
void addSearch(Replacements& keys, ExportType type) {
  const bool is_double = type == ExportType::kDouble;
  const std::string most = keys["most"];
  keys["test_comment"] = is_double ? "Greatest violation of the rows of a candidate; " + most +
                                         " where one exceeds the tolerance."
                                   : "Whether all rows of a candidate hold within the tolerance.";
  keys["test_type"] = is_double ? keys["real"] : "int";
  keys["test_name"] = is_double ? "violation" : "holds";
  keys["test_result"] = is_double ? "greatest" : "holds";
  keys["test_start"] = is_double ? "-" + most : "1";
  keys["test_broken"] = is_double ? most : "0";
  keys["test_held"] = is_double ? kGreatestViolation : "";
  keys["candidate_test"] = replaced(kCandidateTest, keys);
  keys["least"] = is_double ? replaced("        @real@ least = @most@;\n", keys) : "";
  keys["search"] = replaced(is_double ? kLeastSearch : kFirstSearch, keys);
}

}  // namespace

void checkExportName(const std::string& name) {
  bool valid =
      !name.empty() && name.size() <= kMaxName && std::isalpha(static_cast<unsigned char>(name[0])) != 0;
  for (const char letter : name)
    valid = valid && (std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_');
  if (!valid) {
    throw Error("--name: must be 1 to 24 letters, digits and underscores that begin with a letter, got '" +
                name + "'");
  }
}

bool ExportBound::isAllowed() const {
  for (std::size_t j = 0; j < allowed.size(); ++j) {
    if (!(error[j] <= allowed[j])) return false;
  }
  return true;
}

Replacements sharedKeys(const CodeKind& code) {
  const bool is_double = code.type == ExportType::kDouble;
  Replacements keys = {{"name", code.name},
                       {"NAME", upperCase(code.name)},
                       {"version", kVersion},
                       {"problem_hash", checksumOf(code.problem_text)},
                       {"p", std::to_string(code.parameters)},
                       {"p1", std::to_string(code.parameters + 1)},
                       {"m", std::to_string(code.inputs)},
                       {"real", toString(code.type)},
                       {"most", is_double ? "DBL_MAX" : "FLT_MAX"},
                       {"prefix", is_double ? "DBL" : "FLT"},
                       {"digits", is_double ? "53" : "24"},
                       {"zero", constant(0.0, code.type)},
                       {"one", constant(1.0, code.type)}};
  keys["constants"] = is_double ? replaced(kDoubleConstants, keys) : "";
  return keys;
}

Replacements mapKeys(const RegionMap& map, const ExportOptions& options) {
  Replacements keys = sharedKeys({options.name, options.type, std::string(map.problemText()),
                                  map.parameters().size(), map.inputs().size()});
  keys["checksum"] = "xxh64:" + hexDigits(map.checksum());
  keys["map_name"] = commentText(std::string(map.name()));
  keys["regions"] = std::to_string(map.regionCount());
  return keys;
}

std::string exportSource(const RegionMap& map, const ExportOptions& options) {
  checkExportName(options.name);
  const CodeTables tables = codeTables(map, options);
  Replacements keys = mapKeys(map, options);
  addTables(keys, map, tables, options.type);
  const std::size_t p = map.parameters().size();
  keys["index"] = localIndex(map, tables);
  keys["nodes"] = std::to_string(map.nodeCount());
  const std::uint32_t root = map.root();
  // A map without nodes has a leaf as its root, and leaves are counted from the number of nodes on.
  keys["root"] = std::to_string(root & ~MapContent::kLeaf);
  keys["tolerance"] = constant(tables.tolerance, options.type);
  keys["arithmetic"] = replaced(kFloatingArithmetic, keys);
  const std::string plane = keys["NAME"] + "_REAL(" + options.name + "_plane";
  keys["distance"] = p > kMaxWrittenOut ? replaced(kDistanceLoop, keys)
                                        : "    return " + sumTerms(0, p + 1, p, plane) + ";\n";
  const bool has_nodes = map.nodeCount() != 0;
  keys["tree"] = has_nodes ? replaced(kTreeTemplate, keys) : "";
  keys["node_count"] = has_nodes ? "#define NODE_COUNT " + keys["nodes"] + "u\n" : "";
  keys["descent"] = has_nodes ? replaced(kDescentTemplate, keys) : "";
  addSearch(keys, options.type);
  return replaced(kSourceTemplate, keys);
}

std::string exportHeader(const RegionMap& map, const ExportOptions& options, const ExportBound& bound) {
  checkExportName(options.name);
  Replacements keys = mapKeys(map, options);
  keys["signals"] = signalLines("theta", map.parameters()) + signalLines("u", map.inputs());
  keys["bound"] = boundText(options, map, bound) + filterText(map, bound);
  return replaced(kHeaderTemplate, keys);
}

}  // namespace polyfly
