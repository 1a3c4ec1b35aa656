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
  static constexpr std::size_t kMostBytes = std::size_t{256} << 20;  ///< larger ones are not made,
  static constexpr std::size_t kMostBytesPerByte = 16;  ///< nor larger ones for a byte of the file

  // Layout. Lanes are words of 32 bits side by side, one for each plane of a block or row of a group: first
  // those of parameters 0 and 1, both coefficients in one word, negated; then those of 2 and 3, ..; last the
  // constants.
  static constexpr std::uint32_t kLevels = 3;               ///< of the tree in a block
  static constexpr std::uint32_t kChildren = 1 << kLevels;  ///< of a block, and its lanes, the last unused
  static constexpr std::uint32_t kRowLanes = 4;             ///< of a group of rows
  static constexpr std::uint32_t kHead = 4;                 ///< words before the groups of a region
  /// Of a reference: the rest is its first candidate, not a block.
  static constexpr std::uint32_t kLeaf = 0x80000000u;
  static constexpr std::uint32_t kLast = 0x80000000u;  ///< In Candidate::record: it is the leaf's last.

  struct Candidate {
    std::uint32_t record = 0;  ///< Where its region's record begins [kHead words], and kLast.
    std::uint32_t tests = 0;   ///< Rows to test, see MapContent::tests.
  };

  /// Which rows of group g are tested, bit i: row i of the group.
  static constexpr std::uint32_t testedLanes(std::uint32_t tests, std::uint32_t g) noexcept {
    constexpr std::uint32_t kLastGroup = 31 / kRowLanes;  // that the bits tell apart
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
    /// Of a region: its index, law, number of groups, first row; groups.
    const std::int32_t* records = nullptr;
    std::uint32_t root = 0;                        ///< a reference
    std::int32_t margin = 0;                       ///< taken off all constants
    std::array<double, kMostParameters> centre{};  ///< of each range
    std::array<double, kMostParameters> gain{};    ///< 2^14 over half of it; 0: the range is a point
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
