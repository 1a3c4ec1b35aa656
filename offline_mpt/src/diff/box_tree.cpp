#include "diff/box_tree.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace polyfly {
namespace {

constexpr std::size_t kLeafBoxes = 8;

void extend(Box& bounds, const Box& box) {
  for (std::size_t j = 0; j < box.lower.size(); ++j) {
    bounds.lower[j] = std::min(bounds.lower[j], box.lower[j]);
    bounds.upper[j] = std::max(bounds.upper[j], box.upper[j]);
  }
}

std::size_t widestAxis(const Box& bounds) {
  std::size_t widest = 0;
  for (std::size_t j = 1; j < bounds.lower.size(); ++j) {
    if (bounds.upper[j] - bounds.lower[j] > bounds.upper[widest] - bounds.lower[widest]) widest = j;
  }
  return widest;
}

}  // namespace

bool boxesMeet(const Box& first, const Box& second) {
  for (std::size_t j = 0; j < first.lower.size(); ++j) {
    if (first.lower[j] >= second.upper[j] || second.lower[j] >= first.upper[j]) return false;
  }
  return true;
}

BoxTree::BoxTree(std::vector<const Box*> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), std::uint32_t{0});
  if (!boxes_.empty()) build(0, boxes_.size());
}

std::size_t BoxTree::build(std::size_t first, std::size_t end) {
  const std::size_t index = nodes_.size();
  Node node;
  node.first = first;
  node.end = end;
  node.bounds = *boxes_[order_[first]];
  for (std::size_t i = first + 1; i < end; ++i) extend(node.bounds, *boxes_[order_[i]]);
  const std::size_t axis = widestAxis(node.bounds);
  nodes_.push_back(std::move(node));
  if (end - first <= kLeafBoxes) return index;
  const std::size_t middle = first + (end - first) / 2;
  const auto place = [&](std::uint32_t i) { return boxes_[i]->lower[axis] + boxes_[i]->upper[axis]; };
  const auto begin = order_.begin();
  std::nth_element(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(middle),
                   begin + static_cast<std::ptrdiff_t>(end),
                   [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
  build(first, middle);
  const std::size_t second = build(middle, end);
  nodes_[index].second = second;
  return index;
}

std::vector<std::uint32_t> BoxTree::meeting(const Box& box) const {
  std::vector<std::uint32_t> found;
  if (!nodes_.empty()) collect(0, box, found);
  std::sort(found.begin(), found.end());
  return found;
}

void BoxTree::collect(std::size_t node, const Box& box, std::vector<std::uint32_t>& found) const {
  const Node& at = nodes_[node];
  if (!boxesMeet(at.bounds, box)) return;
  if (at.second != 0) {
    collect(node + 1, box, found);
    collect(at.second, box, found);
    return;
  }
  for (std::size_t i = at.first; i < at.end; ++i) {
    if (boxesMeet(*boxes_[order_[i]], box)) found.push_back(order_[i]);
  }
}

}  // namespace polyfly
