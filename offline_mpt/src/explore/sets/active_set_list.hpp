#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "explore/sets/active_set_pool.hpp"

namespace polyfly {

/// Row indices of a NormalisedProgram, ascending.
using ActiveSet = std::vector<std::uint16_t>;

/// Active sets, their rows one after the other: lists that are filled again and again allocate nothing.
class ActiveSetList {
 public:
  std::size_t size() const { return ends_.size(); }
  bool empty() const { return ends_.empty(); }

  /// Valid until the list is changed.
  RowSpan operator[](std::size_t k) const {
    const std::size_t begin = k == 0 ? 0 : ends_[k - 1];
    return {rows_.data() + begin, ends_[k] - begin};
  }

  void clear() {
    rows_.clear();
    ends_.clear();
  }

  /// The set, which is not of this list, with `entering` in the place of `leaving`; kNone: without either.
  void push(RowSpan set, int leaving = kNone, int entering = kNone) {
    bool entered = entering == kNone;
    for (const std::uint16_t row : set) {
      if (row == leaving) continue;
      if (!entered && row > entering) {
        rows_.push_back(static_cast<std::uint16_t>(entering));
        entered = true;
      }
      rows_.push_back(row);
    }
    if (!entered) rows_.push_back(static_cast<std::uint16_t>(entering));
    ends_.push_back(rows_.size());
  }

  static constexpr int kNone = -1;

 private:
  std::vector<std::uint16_t> rows_;
  std::vector<std::size_t> ends_;
};

}  // namespace polyfly
