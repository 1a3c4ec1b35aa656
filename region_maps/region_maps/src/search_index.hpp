#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace polyfly {

class RegionMap;

/// What makes look-ups fast: a copy of a map's tree and half-spaces in 16 bits, made in memory when the map
/// opens.
///
/// Three levels of the tree lie in one block of a few cache lines, with their planes, and the rows of a
/// region side by side; four planes or rows at once are tried by whole numbers. The value c - a . theta of a
/// plane, in units of 2^-28 of its norm where each parameter's range is [-1, 1], is then off by less than
/// View::margin: beyond it the sign is certain; within it the half-spaces of the file are asked, in double.
/// So the answer is that of FORMAT.md, "Point location", bit for bit, and a look-up costs at most what the
/// map's cost() says and multiplyAdds() of 16 bits.
class SearchIndex {
 public:
  static constexpr std::uint32_t kMostParameters = 8;
  /// Greatest size of an index. Larger ones are not made.
  static constexpr std::size_t kMostBytes = std::size_t{256} << 20;  ///< [bytes]
  /// Greatest size of an index for each byte of the file. Larger ones are not made.
  static constexpr std::size_t kMostBytesPerByte = 16;  ///< [bytes]

  // Layout. Lanes are words of 32 bits side by side, one for each plane of a block or row of a group: first
  // those of parameters 0 and 1, both coefficients in one word, negated; then those of 2 and 3, ..; last the
  // constants.

  /// Levels of the tree in a block.
  static constexpr std::uint32_t kLevels = 3;
  /// Children of a block, and its lanes. No plane uses the last lane.
  static constexpr std::uint32_t kChildren = 1 << kLevels;
  /// Lanes of a group of rows.
  static constexpr std::uint32_t kRowLanes = 4;
  /// Words before the groups of a region.
  static constexpr std::uint32_t kHead = 4;
  /// Flag of a reference to a leaf. The rest is its first candidate, not a block.
  static constexpr std::uint32_t kLeaf = 0x80000000u;
  /// Flag of the last candidate of a leaf, in Candidate::record.
  static constexpr std::uint32_t kLast = 0x80000000u;

  struct Candidate {
    /// Where the region's record begins [kHead words], with the flag kLast.
    std::uint32_t record = 0;
    /// Rows to test, see MapContent::tests.
    std::uint32_t tests = 0;
  };

  /// Which rows of group g are tested, bit i: row i of the group.
  static constexpr std::uint32_t testedLanes(std::uint32_t tests, std::uint32_t g) noexcept {
    // The last group whose rows have bits of their own.
    constexpr std::uint32_t kLastGroup = 31 / kRowLanes;
    constexpr std::uint32_t kAllLanes = (1u << kRowLanes) - 1;
    if (g <= kLastGroup) return tests >> kRowLanes * g & kAllLanes;
    return (tests >> 31) != 0 ? kAllLanes : 0u;
  }

  /// Words for two parameters each, for p parameters.
  static constexpr std::uint32_t pairs(std::uint32_t p) noexcept { return (p + 1) / 2; }
  static constexpr std::uint32_t blockWords(std::uint32_t p) noexcept { return (pairs(p) + 2) * kChildren; }
  static constexpr std::uint32_t groupWords(std::uint32_t p) noexcept { return (pairs(p) + 1) * kRowLanes; }

  SearchIndex() = default;

  /// Of a map that was checked. Stays empty, and look-ups read the file alone, where there are more than
  /// kMostParameters, or the index would be too large.
  explicit SearchIndex(const RegionMap& map);

  bool empty() const noexcept { return records_.empty(); }
  std::size_t bytes() const noexcept;
  std::size_t blockCount() const noexcept { return block_count_; }

  /// Greatest number of multiply-adds of 16 bits in a look-up.
  std::uint64_t multiplyAdds() const noexcept { return multiply_adds_; }

  /// What a look-up reads. Valid as long as the index, also when that moves.
  struct View {
    /// Lanes of planes, a plane's children 2 i + 1 (below) and 2 i + 2 (above) after it; in the last lane
    /// which planes are those of nodes (bits), and as its constant the node of the file that the block begins
    /// with. Then a reference for each child, from below to above.
    const std::int32_t* blocks = nullptr;
    const Candidate* candidates = nullptr;
    /// Of each region: its index, law, number of groups, first row, then the groups.
    const std::int32_t* records = nullptr;
    /// Reference to the root.
    std::uint32_t root = 0;
    /// Margin subtracted from all constants.
    std::int32_t margin = 0;
    /// Centre of each range.
    std::array<double, kMostParameters> centre{};
    /// 2^14 over half of each range. 0: the range is a point.
    std::array<double, kMostParameters> gain{};
  };
  const View& view() const noexcept { return view_; }

 private:
  class Builder;
  struct alignas(64) Line {
    std::int32_t words[16];
  };

  std::vector<Line> blocks_;
  std::vector<Candidate> candidates_;
  std::vector<Line> records_;
  std::size_t block_count_ = 0;
  std::uint64_t multiply_adds_ = 0;
  View view_;
};

}  // namespace polyfly
