#pragma once

#include <cstdint>
#include <vector>

#include "region_maps/region_map.hpp"

namespace polyfly {

/// A region that is a candidate at leaves below a node, and the rows that some of them test, as in MapContent::tests.
struct TreeMember {
  std::uint32_t region = 0;
  std::uint32_t tests = 0;
};

/// The search tree of a map in the order of descents: a node, what lies below its plane, what lies above.
class LookupTree {
 public:
  explicit LookupTree(const RegionMap& map);

  std::size_t size() const { return visits_.size(); }
  bool isLeaf(std::size_t visit) const { return (visits_[visit].child & MapContent::kLeaf) != 0; }
  std::uint32_t leaf(std::size_t visit) const { return visits_[visit].child & ~MapContent::kLeaf; }
  /// What follows a node below its plane, and above.
  std::size_t below(std::size_t visit) const { return visit + 1; }
  std::size_t above(std::size_t visit) const { return visits_[visit].above; }
  /// The root is its own parent.
  std::size_t parent(std::size_t visit) const { return visits_[visit].parent; }
  /// The row that holds on the way from the parent.
  std::int32_t row(std::size_t visit) const { return visits_[visit].row; }
  /// Rows that hold on the way to a node or leaf, from the root on.
  std::vector<std::int32_t> path(std::size_t visit) const;
  /// Whether a leaf names a region twice. Then the rows that the tests of both name count, and nothing is proven of it.
  bool namesTwice(std::size_t visit) const { return visits_[visit].names_twice; }
  /// Ascending by region. A region that a leaf names twice is there once.
  const std::vector<TreeMember>& members(std::size_t visit) const { return visits_[visit].members; }
  /// The member of a region, nullptr where it is none.
  const TreeMember* member(std::size_t visit, std::uint32_t region) const;

 private:
  struct Visit {
    std::uint32_t child = 0;
    std::size_t parent = 0;
    std::size_t above = 0;
    /// The row that leads here from the parent.
    std::int32_t row = 0;
    std::vector<TreeMember> members;
    bool names_twice = false;
  };

  void addLeafMembers(const RegionMap& map, Visit& visit) const;

  std::vector<Visit> visits_;
};

}  // namespace polyfly
