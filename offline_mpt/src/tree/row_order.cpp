#include "tree/row_order.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace polyfly {

void orderRows(MapContent& content) {
  constexpr std::uint32_t kMoved = 31;
  if (content.tests.empty()) return;
  std::vector<std::array<std::uint32_t, kMoved>> count(content.regions.size());
  for (std::size_t i = 0; i < content.tests.size(); ++i) {
    for (std::uint32_t row = 0; row < kMoved; ++row)
      count[content.candidates[i]][row] += content.tests[i] >> row & 1u;
  }
  std::vector<std::array<std::uint32_t, kMoved>> place(content.regions.size());  // of each row
  for (std::size_t r = 0; r < content.regions.size(); ++r) {
    const MapContent::Region& region = content.regions[r];
    std::vector<std::uint32_t> order(std::min(region.row_count, kMoved));
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return count[r][a] > count[r][b]; });
    const auto rows = content.rows.begin() + static_cast<std::ptrdiff_t>(region.first_row);
    const std::vector<std::int32_t> before(rows, rows + static_cast<std::ptrdiff_t>(order.size()));
    for (std::uint32_t k = 0; k < order.size(); ++k) {
      rows[k] = before[order[k]];
      place[r][order[k]] = k;
    }
  }
  for (std::size_t i = 0; i < content.tests.size(); ++i) {
    std::uint32_t moved = content.tests[i] & ~((1u << kMoved) - 1);
    for (std::uint32_t row = 0; row < kMoved; ++row)
      moved |= (content.tests[i] >> row & 1u) << place[content.candidates[i]][row];
    content.tests[i] = moved;
  }
}

}  // namespace polyfly
