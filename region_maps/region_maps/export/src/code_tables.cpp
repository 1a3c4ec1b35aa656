#include "code_tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

/// Tolerance in greatest rounding errors of a half-space.
constexpr double kFloatTolerance = 64.0;

double rounded(double value, ExportType type) {
  if (type == ExportType::kDouble) return value;
  const float number = static_cast<float>(value);
  if (!std::isfinite(number)) throw Error("--type float: the map has a number that exceeds float");
  return number;
}

std::vector<double> rounded(const double* values, std::size_t count, ExportType type) {
  std::vector<double> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = rounded(values[i], type);
  return result;
}

/// As RegionMap has it.
std::vector<double> widenedBox(const RegionMap& map) {
  std::vector<double> box;
  for (const Signal& parameter : map.parameters()) {
    const double slack = map.tolerance() * (0.5 * parameter.upper - 0.5 * parameter.lower);
    box.push_back(parameter.lower - slack);
    box.push_back(parameter.upper + slack);
  }
  return box;
}

/// Rounds each bound so that every number of the box, rounded to the type, lies within.
std::vector<double> roundedBox(std::vector<double> box, ExportType type) {
  if (type == ExportType::kDouble) return box;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < box.size(); ++i) {
    const auto number = static_cast<float>(rounded(box[i], type));
    const bool upper = i % 2 == 1;
    const bool cut = upper ? number < box[i] : number > box[i];
    box[i] = rounded(cut ? std::nextafter(number, upper ? kInfinity : -kInfinity) : number, type);
  }
  return box;
}

/// So many times the greatest rounding error of a plane's value. The proof says whether it suffices.
double floatTolerance(const RegionMap& map, const CodeTables& tables, double errors) {
  const std::size_t p = map.parameters().size();
  constexpr double kUnit = 0.5 * std::numeric_limits<float>::epsilon();
  double greatest = 0.0;
  for (std::size_t i = 0; i < map.planeCount(); ++i) {
    const double* const plane = map.plane(i);
    double sum = std::abs(plane[p]);
    for (std::size_t k = 0; k < p; ++k)
      sum += std::abs(plane[k]) * std::max(std::abs(tables.box[2 * k]), std::abs(tables.box[2 * k + 1]));
    greatest = std::max(greatest, sum * kUnit);
  }
  return rounded(map.tolerance() + errors * greatest, ExportType::kFloat);
}

std::uint32_t exportedChild(std::uint32_t child, std::size_t nodes) {
  const bool is_leaf = (child & MapContent::kLeaf) != 0;
  return is_leaf ? static_cast<std::uint32_t>(nodes) + (child & ~MapContent::kLeaf) : child;
}

/// A region and the rows that a leaf tests of it, see MapContent::tests.
struct Offer {
  std::uint32_t region = 0;
  std::uint32_t tests = MapContent::kAllRows;
};

/// `chosen` are those of the leaf.
std::vector<Offer> offersOf(const RegionMap& map, std::uint32_t number,
                            const std::vector<ChosenCandidate>& chosen) {
  const LeafView leaf = map.leaf(number);
  std::vector<Offer> offers;
  for (std::uint32_t i = 0; i < leaf.count; ++i) offers.push_back({leaf.candidates[i], leaf.testsOf(i)});
  for (auto own = chosen.begin(); own != chosen.end(); ++own) {
    const auto same = std::find_if(offers.begin(), offers.end(),
                                   [own](const Offer& offer) { return offer.region == own->region; });
    if (same == offers.end()) {
      offers.push_back({own->region, own->tests});
    } else {
      same->tests = own->tests;
    }
  }
  return offers;
}

void addTree(const RegionMap& map, const std::vector<ChosenCandidate>& chosen, CodeTables& tables) {
  std::vector<std::vector<ChosenCandidate>> of_leaf(map.leafCount());
  for (const ChosenCandidate& candidate : chosen) of_leaf[candidate.leaf].push_back(candidate);
  for (std::size_t i = 0; i < map.nodeCount(); ++i) {
    const MapContent::Node& node = map.node(i);
    tables.node_plane.push_back(node.plane);
    tables.node_child.push_back(exportedChild(node.below, map.nodeCount()));
    tables.node_child.push_back(exportedChild(node.above, map.nodeCount()));
  }
  for (std::uint32_t i = 0; i < map.leafCount(); ++i) {
    tables.leaf_first.push_back(static_cast<std::uint32_t>(tables.candidate_region.size()));
    for (const Offer& offer : offersOf(map, i, of_leaf[i])) {
      tables.candidate_region.push_back(offer.region);
      tables.candidate_first.push_back(static_cast<std::uint32_t>(tables.rows.size()));
      const RegionView region = map.region(offer.region);
      for (std::uint32_t row = 0; row < region.row_count; ++row) {
        if (isTested(offer.tests, row)) tables.rows.push_back(exportedRow(region.rows[row]));
      }
    }
  }
  tables.leaf_first.push_back(static_cast<std::uint32_t>(tables.candidate_region.size()));
  tables.candidate_first.push_back(static_cast<std::uint32_t>(tables.rows.size()));
}

/// Leaves out the planes that no node and no row refers to.
void dropUnusedPlanes(std::size_t width, CodeTables& tables) {
  std::vector<std::uint32_t> number(tables.planes.size() / width, 0);
  for (const std::uint32_t plane : tables.node_plane) number[plane] = 1;
  for (const std::uint32_t row : tables.rows) number[row / 2] = 1;
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] == 0) continue;
    std::copy_n(tables.planes.begin() + static_cast<std::ptrdiff_t>(i * width), width,
                tables.planes.begin() + static_cast<std::ptrdiff_t>(kept * width));
    number[i] = kept++;
  }
  // C has no empty arrays.
  tables.planes.resize(std::min(tables.planes.size(), std::max(kept, 1u) * width));
  for (std::uint32_t& plane : tables.node_plane) plane = number[plane];
  for (std::uint32_t& row : tables.rows) row = 2 * number[row / 2] + row % 2;
}

void fillReals(const RegionMap& map, const ExportOptions& options, CodeTables& tables) {
  const ExportType type = options.type;
  const std::size_t p = map.parameters().size();
  tables.planes = rounded(map.plane(0), map.planeCount() * (p + 1), type);
  tables.laws = rounded(map.law(0), map.lawCount() * map.inputs().size() * (p + 1), type);
  tables.box = roundedBox(widenedBox(map), type);
  if (type == ExportType::kDouble) {
    tables.tolerance = map.tolerance();
  } else {
    tables.tolerance = floatTolerance(map, tables, kFloatTolerance * options.tolerance);
  }
}

}  // namespace

const char* toString(ExportType type) {
  switch (type) {
    case ExportType::kDouble:
      return "double";
    case ExportType::kFloat:
      return "float";
  }
  return "";
}

CodeTables codeTables(const RegionMap& map, const ExportOptions& options) {
  CodeTables tables;
  fillReals(map, options, tables);
  addTree(map, options.chosen, tables);
  for (std::size_t i = 0; i < map.regionCount(); ++i) tables.region_law.push_back(map.region(i).law);
  dropUnusedPlanes(map.parameters().size() + 1, tables);
  return tables;
}

std::uint32_t indexBytes(const std::vector<std::uint32_t>& values) {
  const std::uint32_t greatest = values.empty() ? 0 : *std::max_element(values.begin(), values.end());
  if (greatest <= 0xffu) return 1;
  return greatest <= 0xffffu ? 2 : 4;
}

}  // namespace polyfly
