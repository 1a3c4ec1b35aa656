#include "diff/map_cells.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "diff/linear_maximum.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"
#include "support/in_parallel.hpp"

namespace polyfly {
namespace {

void requireSameNames(const std::vector<Signal>& first, const std::vector<Signal>& second,
                      const std::string& where, const std::string& what) {
  if (first.size() != second.size())
    throw Error(where + std::to_string(second.size()) + " " + what + "s, not " +
                std::to_string(first.size()));
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i].name == second[i].name && first[i].unit == second[i].unit) continue;
    throw Error(where + what + " " + std::to_string(i) + " " + second[i].name + " [" + second[i].unit +
                "], not " + first[i].name + " [" + first[i].unit + "]");
  }
}

bool boxesMeet(const Box& first, const Box& second) {
  for (std::size_t j = 0; j < first.lower.size(); ++j) {
    if (first.lower[j] >= second.upper[j] || second.lower[j] >= first.upper[j]) return false;
  }
  return true;
}

void findBox(int p, MapCell& cell) {
  std::vector<double> direction(static_cast<std::size_t>(p));
  for (double& entry : direction) {
    entry = 1.0;
    cell.box.upper.push_back(upperBound(cell.cell.rows, direction));
    entry = -1.0;
    cell.box.lower.push_back(-upperBound(cell.cell.rows, direction));
    entry = 0.0;
  }
}

}  // namespace

std::vector<Signal> commonRanges(const RegionMap& first, const RegionMap& second) {
  const std::string where = second.path() + " and " + first.path() + " cannot be compared: it has ";
  requireSameNames(first.parameters(), second.parameters(), where, "parameter");
  requireSameNames(first.inputs(), second.inputs(), where, "input");
  std::vector<Signal> ranges = first.parameters();
  for (std::size_t j = 0; j < ranges.size(); ++j) {
    for (const RegionMap* map : {&first, &second}) {
      const Signal& signal = map->parameters()[j];
      if (!(signal.lower < signal.upper))
        throw Error(map->path() + ": parameter " + signal.name + " has no range");
      ranges[j].lower = std::min(ranges[j].lower, signal.lower);
      ranges[j].upper = std::max(ranges[j].upper, signal.upper);
    }
  }
  return ranges;
}

MapCells::MapCells(const RegionMap& map, const std::vector<Signal>& ranges, const MapCells* other,
                   int threads)
    : exact_(map, map.tolerance(), ranges, other != nullptr ? &other->exact_ : nullptr) {
  addSides(ranges);
  addRegions(threads);
}

void MapCells::addSides(const std::vector<Signal>& ranges) {
  for (std::size_t j = 0; j < ranges.size(); ++j) {
    const Signal& own = exact_.map().parameters()[j];
    const Rational centre = (Rational(ranges[j].lower) + Rational(ranges[j].upper)) / 2;
    const Rational half = (Rational(ranges[j].upper) - Rational(ranges[j].lower)) / 2;
    std::vector<Rational> row(ranges.size() + 1);
    if (own.upper < ranges[j].upper) {
      row[j] = -1;
      row.back() = (Rational(own.upper) - centre) / half;
      sides_.push_back(wholeRow(row));
    }
    if (own.lower > ranges[j].lower) {
      row[j] = 1;
      row.back() = (centre - Rational(own.lower)) / half;
      sides_.push_back(wholeRow(row));
    }
  }
}

void MapCells::addRegions(int threads) {
  std::vector<MapCell> all(exact_.map().regionCount());
  inParallel(all.size(), threads, nullptr, {}, [&](std::size_t, std::uint64_t i) {
    MapCell& region = all[i];
    region.region = static_cast<std::uint32_t>(i);
    if (cellOf(exact_, region.region, region.cell, sides_)) findBox(exact_.p(), region);
  });
  for (MapCell& region : all) {
    if (!region.box.upper.empty()) regions_.push_back(std::move(region));
  }
}

std::vector<std::uint32_t> meeting(const std::vector<MapCell>& cells, const Box& box) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    if (boxesMeet(cells[i].box, box)) found.push_back(i);
  }
  return found;
}

}  // namespace polyfly
