#include "reduce/minimum_cover.hpp"

#include <algorithm>

namespace polyfly {
namespace {

std::size_t bitsIn(std::uint64_t word) { return static_cast<std::size_t>(__builtin_popcountll(word)); }

class CoverSearch {
 public:
  CoverSearch(std::size_t size, const std::vector<BitSet>& sets, std::uint64_t node_limit)
      : size_(size), sets_(sets), nodes_left_(node_limit), holders_(size) {
    for (std::size_t s = 0; s < sets.size(); ++s) {
      for (std::size_t i = 0; i < size; ++i) {
        if (sets[s].test(i)) holders_[i].push_back(s);
      }
    }
  }

  MinimumCover run() {
    BitSet open(size_);
    for (std::size_t i = 0; i < size_; ++i) open.set(i);
    best_ = greedy(open);
    std::vector<std::size_t> chosen;
    branch(open, chosen);
    std::sort(best_.begin(), best_.end());
    return {best_, nodes_left_ > 0};
  }

 private:
  std::vector<std::size_t> greedy(BitSet open) const {
    std::vector<std::size_t> chosen;
    while (!open.empty()) {
      std::size_t best = 0, most = 0;
      for (std::size_t s = 0; s < sets_.size(); ++s) {
        const std::size_t count = sets_[s].countWith(open);
        if (count <= most) continue;
        most = count;
        best = s;
      }
      chosen.push_back(best);
      open.remove(sets_[best]);
    }
    return chosen;
  }

  /// Elements no two of which share a set, rarest first: each needs a set of its own.
  std::size_t lowerBound(const BitSet& open) const {
    std::vector<std::size_t> elements;
    for (std::size_t i = 0; i < size_; ++i) {
      if (open.test(i)) elements.push_back(i);
    }
    std::stable_sort(elements.begin(), elements.end(), [this](std::size_t a, std::size_t b) {
      return holders_[a].size() < holders_[b].size();
    });
    BitSet used(sets_.size());
    std::size_t bound = 0;
    for (const std::size_t i : elements) {
      if (std::any_of(holders_[i].begin(), holders_[i].end(), [&](std::size_t s) { return used.test(s); }))
        continue;
      for (const std::size_t s : holders_[i]) used.set(s);
      ++bound;
    }
    return bound;
  }

  void branch(const BitSet& open, std::vector<std::size_t>& chosen) {
    if (open.empty()) {
      if (chosen.size() < best_.size()) best_ = chosen;
      return;
    }
    if (nodes_left_ == 0 || chosen.size() + lowerBound(open) >= best_.size()) return;
    --nodes_left_;
    std::size_t rarest = size_;
    for (std::size_t i = 0; i < size_; ++i) {
      if (open.test(i) && (rarest == size_ || holders_[i].size() < holders_[rarest].size())) rarest = i;
    }
    std::vector<std::size_t> order = holders_[rarest];
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return sets_[a].countWith(open) > sets_[b].countWith(open);
    });
    for (const std::size_t s : order) {
      BitSet rest = open;
      rest.remove(sets_[s]);
      chosen.push_back(s);
      branch(rest, chosen);
      chosen.pop_back();
    }
  }

  std::size_t size_;
  const std::vector<BitSet>& sets_;
  std::uint64_t nodes_left_;
  std::vector<std::vector<std::size_t>> holders_;  // sets that hold each element
  std::vector<std::size_t> best_;
};

}  // namespace

bool BitSet::empty() const {
  return std::all_of(words_.begin(), words_.end(), [](std::uint64_t word) { return word == 0; });
}

std::size_t BitSet::count() const {
  std::size_t sum = 0;
  for (const std::uint64_t word : words_) sum += bitsIn(word);
  return sum;
}

std::size_t BitSet::countWith(const BitSet& other) const {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < words_.size(); ++i) sum += bitsIn(words_[i] & other.words_[i]);
  return sum;
}

bool BitSet::subsetOf(const BitSet& other) const {
  for (std::size_t i = 0; i < words_.size(); ++i) {
    if ((words_[i] & ~other.words_[i]) != 0) return false;
  }
  return true;
}

void BitSet::remove(const BitSet& other) {
  for (std::size_t i = 0; i < words_.size(); ++i) words_[i] &= ~other.words_[i];
}

MinimumCover minimumCover(std::size_t size, const std::vector<BitSet>& sets, std::uint64_t node_limit) {
  return CoverSearch(size, sets, node_limit).run();
}

}  // namespace polyfly
