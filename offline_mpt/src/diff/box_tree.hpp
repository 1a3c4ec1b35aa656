#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace polyfly {

/// An axis-aligned box.
struct Box {
  std::vector<double> lower, upper;
};

/// Whether the interiors of two boxes meet.
bool boxesMeet(const Box& first, const Box& second);

/// A tree of boxes that finds those that meet another one. The boxes must outlive the object.
class BoxTree {
 public:
  explicit BoxTree(std::vector<const Box*> boxes);

  /// Indices, ascending, of the boxes whose interiors meet that of `box`.
  std::vector<std::uint32_t> meeting(const Box& box) const;

 private:
  /// A node bounds the boxes order_[first .. end). Its children halve that range; the second one follows the whole
  /// subtree of the first. A node of few boxes is a leaf.
  struct Node {
    Box bounds;
    std::size_t first = 0, end = 0;
    // Second child. 0: a leaf.
    std::size_t second = 0;
  };

  std::size_t build(std::size_t first, std::size_t end);
  void collect(std::size_t node, const Box& box, std::vector<std::uint32_t>& found) const;

  std::vector<const Box*> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace polyfly
