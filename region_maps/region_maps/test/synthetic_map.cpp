#include "synthetic_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <random>

#include "region_maps/format.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double lower, double upper) {
  return std::uniform_real_distribution<double>(lower, upper)(random);
}

Signal makeSignal(const std::string& name, std::uint32_t index, double lower, double upper) {
  return {name + "_" + std::to_string(index), "m", lower, upper};
}

std::int32_t addPlane(MapContent& map, const std::vector<double>& a, double c) {
  map.planes.insert(map.planes.end(), a.begin(), a.end());
  map.planes.push_back(c);
  return static_cast<std::int32_t>(map.planes.size() / (a.size() + 1));
}

std::uint32_t addLeaf(MapContent& map, const std::vector<std::uint32_t>& candidates) {
  map.leaves.push_back(
      {static_cast<std::uint32_t>(map.candidates.size()), static_cast<std::uint32_t>(candidates.size())});
  map.candidates.insert(map.candidates.end(), candidates.begin(), candidates.end());
  return static_cast<std::uint32_t>(map.leaves.size() - 1) | MapContent::kLeaf;
}

void addRegion(MapContent& map, const std::vector<std::int32_t>& rows, std::uint32_t law) {
  MapContent::Region region;
  region.first_row = static_cast<std::uint32_t>(map.rows.size());
  region.row_count = static_cast<std::uint32_t>(rows.size());
  region.law = law;
  region.first_active = static_cast<std::uint32_t>(map.active.size());
  region.active_count = law % 3;
  for (std::uint32_t i = 0; i < region.active_count; ++i)
    map.active.push_back(static_cast<std::int32_t>(law + i));
  map.rows.insert(map.rows.end(), rows.begin(), rows.end());
  map.regions.push_back(region);
}

/// Faces of the box as rows; a plane for each side.
std::vector<std::int32_t> addBoxRows(MapContent& map) {
  std::vector<std::int32_t> rows;
  const std::size_t p = map.parameters.size();
  for (std::size_t i = 0; i < p; ++i) {
    const double half = 0.5 * (map.parameters[i].upper - map.parameters[i].lower);
    std::vector<double> a(p, 0.0);
    a[i] = 1.0 / half;
    rows.push_back(addPlane(map, a, map.parameters[i].upper / half));
    rows.push_back(-addPlane(map, a, map.parameters[i].lower / half));
  }
  return rows;
}

class TreeMaker {
 public:
  explicit TreeMaker(const TreeRecipe& recipe) : recipe_(recipe), random_(recipe.seed) {}

  MapContent make() {
    map_.name = "made_tree";
    map_.problem_kind = "yaml";
    map_.solver_status = "complete";
    map_.period = 0.1;
    map_.tolerance = recipe_.tolerance;
    for (std::uint32_t i = 0; i < recipe_.parameters; ++i) {
      const double centre = uniform(random_, -2.0, 2.0);
      const double half = uniform(random_, 0.3, 4.0);
      map_.parameters.push_back(makeSignal("theta", i, centre - half, centre + half));
    }
    for (std::uint32_t i = 0; i < recipe_.inputs; ++i) map_.inputs.push_back(makeSignal("u", i, -1.0, 1.0));
    for (std::size_t i = 0; i < recipe_.laws * recipe_.inputs * (recipe_.parameters + 1); ++i) {
      map_.laws.push_back(uniform(random_, -1.0, 1.0));
    }
    box_rows_ = addBoxRows(map_);
    map_.root = grow(recipe_.regions, {});
    shuffleRegions();
    return std::move(map_);
  }

 private:
  /// A plane through a random place of the box, scaled as the format wants it.
  std::int32_t randomPlane() {
    const std::size_t p = map_.parameters.size();
    std::vector<double> a(p);
    std::normal_distribution<double> normal;
    double norm = 0.0;
    for (double& entry : a) {
      entry = normal(random_);
      norm += entry * entry;
    }
    double c = 0.0;
    for (std::size_t i = 0; i < p; ++i) {
      const Signal& range = map_.parameters[i];
      a[i] /= std::sqrt(norm) * 0.5 * (range.upper - range.lower);
      c += a[i] *
           uniform(random_, 0.7 * range.lower + 0.3 * range.upper, 0.3 * range.lower + 0.7 * range.upper);
    }
    return addPlane(map_, a, c);
  }

  /// Regions of the part of the box that `path` describes; returns the child that leads there.
  std::uint32_t grow(std::uint32_t regions, const std::vector<std::int32_t>& path) {
    if (regions <= recipe_.leaf_regions) {
      std::vector<std::uint32_t> candidates;
      fill(regions, path, candidates);
      // A region lists the box, then its path: the rows behind those are tested.
      const std::size_t implied = std::min<std::size_t>(31, box_rows_.size() + path.size());
      for (const std::uint32_t candidate : candidates) {
        const std::uint32_t rows = map_.regions[candidate].row_count;
        const std::uint32_t all = testsOfAll(rows);
        if (recipe_.names_tests) map_.tests.push_back(all & ~((1u << implied) - 1));
      }
      return addLeaf(map_, candidates);
    }
    const std::int32_t row = randomPlane();
    const std::size_t node = map_.nodes.size();
    map_.nodes.push_back({static_cast<std::uint32_t>(row - 1), 0, 0});
    const std::uint32_t below = grow(regions / 2, with(path, row));
    const std::uint32_t above = grow(regions - regions / 2, with(path, -row));
    map_.nodes[node].below = below;
    map_.nodes[node].above = above;
    return static_cast<std::uint32_t>(node);
  }

  /// Like grow, without nodes: the regions of one leaf.
  void fill(std::uint32_t regions, const std::vector<std::int32_t>& path,
            std::vector<std::uint32_t>& candidates) {
    if (regions > 1) {
      const std::int32_t row = randomPlane();
      fill(regions / 2, with(path, row), candidates);
      fill(regions - regions / 2, with(path, -row), candidates);
      return;
    }
    const bool hole = recipe_.holes_one_in != 0 && cells_ % recipe_.holes_one_in == 0;
    ++cells_;
    if (hole) return;
    std::vector<std::int32_t> rows = box_rows_;
    rows.insert(rows.end(), path.begin(), path.end());
    candidates.push_back(static_cast<std::uint32_t>(map_.regions.size()));
    addRegion(map_, rows, static_cast<std::uint32_t>(map_.regions.size()) % recipe_.laws);
  }

  static std::vector<std::int32_t> with(std::vector<std::int32_t> path, std::int32_t row) {
    path.push_back(row);
    return path;
  }

  void shuffleRegions() {
    std::vector<std::uint32_t> number(map_.regions.size());
    std::iota(number.begin(), number.end(), 0u);
    std::shuffle(number.begin(), number.end(), random_);
    std::vector<MapContent::Region> regions(number.size());
    for (std::size_t i = 0; i < number.size(); ++i) regions[number[i]] = map_.regions[i];
    map_.regions = regions;
    for (std::uint32_t& candidate : map_.candidates) candidate = number[candidate];
    for (const MapContent::Leaf& leaf : map_.leaves) sortLeaf(leaf);
  }

  void sortLeaf(const MapContent::Leaf& leaf) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sorted;
    for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i)
      sorted.emplace_back(map_.candidates[i], recipe_.names_tests ? map_.tests[i] : 0);
    std::sort(sorted.begin(), sorted.end());
    for (std::uint32_t i = 0; i < leaf.count; ++i) {
      map_.candidates[leaf.first + i] = sorted[i].first;
      if (recipe_.names_tests) map_.tests[leaf.first + i] = sorted[i].second;
    }
  }

  const TreeRecipe recipe_;
  Random random_;
  MapContent map_;
  std::vector<std::int32_t> box_rows_;
  std::uint32_t cells_ = 0;
};

/// Adds nodes that tell the cubes apart: along parameter 0, then 1, ..
class GridMaker {
 public:
  GridMaker(MapContent& map, std::uint32_t cells) : map_(map), cells_(cells) {}

  std::uint32_t grow(std::size_t axis, std::uint32_t first, std::uint32_t end, std::uint32_t region,
                     std::uint32_t stride) {
    if (axis == map_.parameters.size()) return addLeaf(map_, {region});
    if (end - first == 1) return grow(axis + 1, 0, cells_, region + first * stride, stride * cells_);
    const std::uint32_t middle = (first + end) / 2;
    const std::size_t node = map_.nodes.size();
    map_.nodes.push_back({static_cast<std::uint32_t>(axis * (cells_ + 1)) + middle, 0, 0});
    const std::uint32_t below = grow(axis, first, middle, region, stride);
    const std::uint32_t above = grow(axis, middle, end, region, stride);
    map_.nodes[node].below = below;
    map_.nodes[node].above = above;
    return static_cast<std::uint32_t>(node);
  }

 private:
  MapContent& map_;
  const std::uint32_t cells_;
};

}  // namespace

MapContent makeTreeMap(const TreeRecipe& recipe) { return TreeMaker(recipe).make(); }

MapContent makeGridMap(std::uint32_t parameters, std::uint32_t cells) {
  MapContent map;
  map.name = "made_grid";
  map.problem_kind = "json";
  map.solver_status = "complete";
  std::uint32_t regions = 1;
  for (std::uint32_t i = 0; i < parameters; ++i) {
    map.parameters.push_back(makeSignal("theta", i, 0.0, cells));
    // Plane i (cells + 1) + j is theta_i <= j.
    for (std::uint32_t j = 0; j <= cells; ++j) {
      std::vector<double> a(parameters, 0.0);
      a[i] = 2.0 / cells;
      addPlane(map, a, a[i] * j);
    }
    regions *= cells;
  }
  map.inputs.push_back(makeSignal("u", 0, 0.0, regions));
  for (std::uint32_t region = 0; region < regions; ++region) {
    std::vector<std::int32_t> rows;
    for (std::uint32_t i = 0, rest = region; i < parameters; ++i, rest /= cells) {
      const auto lower = static_cast<std::int32_t>(i * (cells + 1) + rest % cells);
      rows.push_back(lower + 2);
      rows.push_back(-(lower + 1));
    }
    addRegion(map, rows, region);
    map.laws.insert(map.laws.end(), parameters, 0.0);
    map.laws.push_back(region);
  }
  map.root = GridMaker(map, cells).grow(0, 0, cells, 0, 1);
  return map;
}

MapContent makeSmallMap() {
  MapContent map = makeGridMap(2, 2);
  map.name = "small";
  map.problem_text = "name: small\nhorizon: 2  # \xc2\xb5\n";
  map.problem_kind = "yaml";
  map.solver_notes = "regions: 4\nradius: 0.5\n";
  map.period = 0.125;
  map.tolerance = 1e-8;
  map.parameters[1].unit = "m/s";
  map.inputs[0].unit = "rad";
  map.tests.assign(map.candidates.size(), 0xf);
  return map;
}

std::vector<std::byte> layOutVersion1(const MapContent& content) {
  const std::vector<std::byte> bytes = layOut(content);
  format::Header header = format::readHeader(bytes.data());
  const std::uint64_t first = header.sections[format::kText].offset;
  const std::uint64_t saved = first - format::kFirstHeader;
  header.version = format::kFirstVersion;
  header.section_count = static_cast<std::uint32_t>(format::sectionCount(header.version));
  header.file_size -= saved;
  for (format::SectionEntry& section : header.sections) section.offset -= saved;
  std::vector<std::byte> old(bytes.size() - saved);
  std::copy(bytes.begin() + static_cast<std::ptrdiff_t>(first), bytes.end(),
            old.begin() + static_cast<std::ptrdiff_t>(format::kFirstHeader));
  std::memcpy(old.data(), &header, format::kFirstHeader);
  header.checksum = format::checksum(old.data(), old.size());
  std::memcpy(old.data(), &header, format::kFirstHeader);
  return old;
}

MadeMap::MadeMap(MapContent made)
    : content(std::move(made)),
      bytes(layOut(content)),
      map(RegionMap::view(bytes.data(), bytes.size(), "made")) {}

std::vector<double> randomPoint(const MapContent& content, Random& random, double part_of_range) {
  std::vector<double> theta;
  for (const Signal& signal : content.parameters) {
    const double centre = 0.5 * (signal.lower + signal.upper);
    const double half = 0.5 * part_of_range * (signal.upper - signal.lower);
    theta.push_back(uniform(random, centre - half, centre + half));
  }
  return theta;
}

}  // namespace polyfly
