#include "reduction_mutation.hpp"

#include "reduction.hpp"
#include "refusal_of.hpp"

namespace polyfly {

std::string reductionRefusal(const std::string& certificate, const std::string& reduced,
                             const std::string& original) {
  return refusalOf([&] {
    const checker::Map reduced_map(reduced), original_map(original);
    checker::Reduction(certificate, reduced_map, original_map).check();
  });
}

std::vector<std::pair<std::string, MapContent>> wrongMaps(const MapContent& good) {
  std::vector<std::pair<std::string, MapContent>> result;
  const auto change = [&](const std::string& what) -> MapContent& {
    return result.emplace_back(what, good).second;
  };
  for (std::size_t i = 0; i < good.laws.size(); ++i) change("law entry " + std::to_string(i)).laws[i] += 1e-6;
  for (std::size_t i = 2; i < good.planes.size(); i += 3) {
    const bool is_box = good.planes[i] == 0.0 || good.planes[i] == 2.0;
    if (is_box) continue;
    for (const double shift : {1e-6, -1e-6}) change("plane " + std::to_string(i / 3)).planes[i] += shift;
  }
  for (std::size_t i = 0; i < good.leaves.size(); ++i) {
    for (std::uint32_t k = 0; k < good.leaves[i].count; ++k) {
      MapContent& changed = change("candidate " + std::to_string(k) + " of leaf " + std::to_string(i));
      auto& leaf = changed.leaves[i];
      const auto at = static_cast<std::ptrdiff_t>(leaf.first + k);
      changed.candidates.erase(changed.candidates.begin() + at);
      if (!changed.tests.empty()) changed.tests.erase(changed.tests.begin() + at);
      for (auto& other : changed.leaves) other.first -= other.first > leaf.first ? 1 : 0;
      --leaf.count;
    }
  }
  for (std::size_t k = 0; k < good.tests.size(); ++k) {
    for (std::uint32_t row = 0; row < 31; ++row) {
      if (!isTested(good.tests[k], row)) continue;
      change("row " + std::to_string(row) + " of candidate " + std::to_string(k)).tests[k] ^= 1u << row;
    }
  }
  for (std::size_t i = 0; i < good.regions.size(); ++i) {
    auto& law = change("law of region " + std::to_string(i)).regions[i].law;
    law = (law + 1) % 4;
    MapContent& whole = change("rows of region " + std::to_string(i));
    whole.regions[i].row_count = 0;  // claims the whole box
    for (std::size_t k = 0; k < whole.tests.size(); ++k) whole.tests[k] *= whole.candidates[k] == i ? 0 : 1;
  }
  return result;
}

}  // namespace polyfly
