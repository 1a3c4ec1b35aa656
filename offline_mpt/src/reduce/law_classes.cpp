#include "reduce/law_classes.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

/// A law in scaled parameters, each input divided by its scale: (gains, value at the centre of the box).
std::vector<double> scaledLaw(const RegionMap& map, std::uint32_t law, const std::vector<double>& scales) {
  const std::size_t p = map.parameters().size();
  const double* const source = map.law(law);
  std::vector<double> result;
  for (std::size_t i = 0; i < scales.size(); ++i) {
    const double* const row = source + i * (p + 1);
    double centre = row[p];
    for (std::size_t j = 0; j < p; ++j) {
      const Signal& signal = map.parameters()[j];
      result.push_back(row[j] * 0.5 * (signal.upper - signal.lower) / scales[i]);
      centre += row[j] * 0.5 * (signal.upper + signal.lower);
    }
    result.push_back(centre / scales[i]);
  }
  return result;
}

/// Greatest difference of an input anywhere in the box.
double difference(const std::vector<double>& a, const std::vector<double>& b, std::size_t p) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); i += p + 1) {
    double sum = 0.0;
    for (std::size_t j = 0; j <= p; ++j) sum += std::abs(a[i + j] - b[i + j]);
    worst = std::max(worst, sum);
  }
  return worst;
}

}  // namespace

std::vector<double> lawScales(const RegionMap& map) {
  const std::size_t p = map.parameters().size(), q = map.inputs().size();
  std::vector<double> scales, greatest(q, 0.0);
  for (std::uint32_t law = 0; law < map.lawCount(); ++law) {
    const std::vector<double> entries = scaledLaw(map, law, std::vector<double>(q, 1.0));
    for (std::size_t i = 0; i < q; ++i) {
      double sum = 0.0;
      for (std::size_t j = 0; j <= p; ++j) sum += std::abs(entries[i * (p + 1) + j]);
      greatest[i] = std::max(greatest[i], sum);
    }
  }
  for (std::size_t i = 0; i < q; ++i) {
    double scale = 0.0;
    for (const double bound : {map.inputs()[i].lower, map.inputs()[i].upper}) {
      if (std::isfinite(bound)) scale = std::max(scale, std::abs(bound));
    }
    if (scale == 0.0) scale = std::min(1.0, greatest[i]);
    scales.push_back(scale > 0.0 ? scale : 1.0);
  }
  return scales;
}

std::vector<std::uint32_t> lawClasses(const RegionMap& map, double tolerance) {
  const std::size_t p = map.parameters().size();
  const std::vector<double> scales = lawScales(map);
  std::vector<std::vector<double>> laws;
  // First law of each class, by the first input at the centre of the box.
  std::multimap<double, std::uint32_t> heads;
  std::vector<std::uint32_t> result;
  for (std::uint32_t law = 0; law < map.lawCount(); ++law) {
    laws.push_back(scaledLaw(map, law, scales));
    const double key = laws.back()[p];
    std::uint32_t head = law;
    for (auto it = heads.lower_bound(key - tolerance); it != heads.end() && it->first <= key + tolerance;
         ++it) {
      if (it->second < head && difference(laws[law], laws[it->second], p) <= tolerance) head = it->second;
    }
    if (head == law) heads.emplace(key, law);
    result.push_back(head);
  }
  return result;
}

}  // namespace polyfly
