#include "core/map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "checksum.hpp"
#include "core/rows.hpp"

namespace checker {
namespace {

// Greatest tolerance of a map, see region_maps/FORMAT.md.
constexpr double kMaxTolerance = 1e-8;
// By how much the length of a plane may differ from 1.
constexpr double kMaxLengthError = 0x1p-40;

template <typename T>
T load(const std::string& bytes, std::size_t at) {
  T value;
  require(at + sizeof(T) <= bytes.size(), "the map is cut off");
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

template <typename T>
std::vector<T> section(const std::string& bytes, std::size_t index, std::size_t per_element) {
  const auto offset = load<std::uint64_t>(bytes, 96 + 16 * index);
  const auto count = load<std::uint64_t>(bytes, 104 + 16 * index);
  require(offset <= bytes.size() && count <= (bytes.size() - offset) / (per_element * sizeof(T)),
          "a section of the map lies outside of it");
  std::vector<T> result(count * per_element);
  if (!result.empty()) std::memcpy(result.data(), bytes.data() + offset, result.size() * sizeof(T));
  return result;
}

}  // namespace

Map::Map(const std::string& file) {
  require(file.size() >= 256 && file.compare(0, 8, "PFLYMAP\n") == 0, "not a region map");
  require(load<std::uint32_t>(file, 8) == 0x01020304u, "the byte order of the map is not this machine's");
  const auto version = load<std::uint32_t>(file, 12);
  require(version == 1 || version == 2, "the version of the map is unknown");
  require(version == 1 || file.size() >= 272, "the map is cut off");
  size = load<std::uint64_t>(file, 16);
  checksum = load<std::uint64_t>(file, 24);
  require(size == file.size(), "the map is cut off");
  std::string blank = file;
  blank.replace(24, 8, 8, '\0');
  require(xxh64(blank) == checksum, "the map is damaged: its checksum does not match");
  p = load<std::uint32_t>(file, 32);
  q = load<std::uint32_t>(file, 36);
  root = load<std::uint32_t>(file, 40);
  period = load<double>(file, 48);
  tolerance = load<double>(file, 56);
  reduced_from = load<std::uint64_t>(file, 80);
  require(tolerance >= 0.0 && tolerance <= kMaxTolerance, "the map's tolerance is out of range");
  require(load<std::uint32_t>(file, 88) == 0, "the map has fallback regions: reduce the original map again");
  require(load<std::uint32_t>(file, 92) == 0, "the reserved bytes of the map are not zero");
  require(p >= 1 && p <= 256 && q >= 1 && q <= 256, "the map's sizes are out of range");
  readText(file);
  bounds = section<double>(file, 1, 2);
  require(bounds.size() == 2 * std::size_t{p + q}, "the map's bounds are not as they must be");
  planes = section<double>(file, 2, p + 1);
  laws = section<double>(file, 3, q * (p + 1));
  regions = section<Region>(file, 4, 1);
  rows = section<std::int32_t>(file, 5, 1);
  active = section<std::int32_t>(file, 6, 1);
  nodes = section<Node>(file, 7, 1);
  leaves = section<Leaf>(file, 8, 1);
  candidates = section<std::uint32_t>(file, 9, 1);
  if (version == 2) tests = section<std::uint32_t>(file, 10, 1);
  checkTables();
  checkLengths();
  checkTree();
}

void Map::readText(const std::string& file) {
  const std::vector<char> text = section<char>(file, 0, 1);
  for (auto at = text.begin(); at != text.end();) {
    const auto end = std::find(at, text.end(), '\0');
    require(end != text.end(), "the map's text is not as it must be");
    words.emplace_back(at, end);
    at = end + 1;
  }
  require(words.size() == 5 + 2 * (std::size_t{p} + q), "the map's text is not as it must be");
  problem = words[1];
}

void Map::checkTables() const {
  for (const std::int32_t row : rows)
    require(row != 0 && row != INT32_MIN && std::size_t(std::abs(row)) * (p + 1) <= planes.size(),
            "a row of the map names no plane");
  for (const Region& region : regions) {
    require(std::uint64_t{region.first_row} + region.row_count <= rows.size() &&
                std::uint64_t{region.first_active} + region.active_count <= active.size() &&
                (std::uint64_t{region.law} + 1) * q * (p + 1) <= laws.size(),
            "a region of the map reaches beyond its tables");
  }
  for (const auto* table : {&planes, &laws, &bounds}) {
    const std::size_t finite =
        table == &bounds ? 2 * std::size_t{p} : table->size();  // inputs may have no bounds
    for (std::size_t k = 0; k < finite; ++k)
      require(std::isfinite((*table)[k]), "the map has an entry that is no number");
  }
}

/// Tolerances are distances only where every plane has the length 1 in scaled parameters.
void Map::checkLengths() const {
  const Fraction most = 1 + Fraction(kMaxLengthError), least = 1 - Fraction(kMaxLengthError);
  std::vector<Fraction> half;
  for (std::size_t j = 0; j < p; ++j)
    half.emplace_back((Fraction(bounds[2 * j + 1]) - Fraction(bounds[2 * j])) / 2);
  for (std::size_t at = 0; at < planes.size(); at += p + 1) {
    Fraction squared;
    for (std::size_t j = 0; j < p; ++j) {
      const Fraction scaled = half[j] * Fraction(planes[at + j]);
      squared += scaled * scaled;
    }
    require(least * least <= squared && squared <= most * most,
            "a plane of the map has another length than 1 in scaled parameters");
  }
}

void Map::checkTree() const {
  const auto require_child = [&](std::uint32_t child) {
    require((child & kLeaf) != 0 ? (child & ~kLeaf) < leaves.size() : child < nodes.size(),
            "the map's tree leads to no leaf");
  };
  require_child(root);
  for (const Node& node : nodes) {
    require((std::size_t{node.plane} + 1) * (p + 1) <= planes.size(), "a node of the map names no plane");
    require_child(node.below);
    require_child(node.above);
  }
  for (const Leaf& leaf : leaves)
    require(std::uint64_t{leaf.first} + leaf.count <= candidates.size(), "a leaf reaches beyond its table");
  for (const std::uint32_t candidate : candidates)
    require(candidate < regions.size(), "a candidate of the map is no region");
  require(tests.empty() || tests.size() == candidates.size(),
          "the map's tests are not one for each candidate");
}

}  // namespace checker
