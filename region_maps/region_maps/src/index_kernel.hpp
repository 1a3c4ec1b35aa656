#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "lanes.hpp"
#include "search_index.hpp"

namespace polyfly {

/// What the index says of a region.
enum class Verdict { kInside, kOutside, kUnsure };

/// The arithmetic of SearchIndex for kParameters parameters.
template <std::uint32_t kParameters>
struct IndexKernel {
  using Index = SearchIndex;
  static constexpr std::uint32_t kPairs = Index::pairs(kParameters);
  static constexpr std::size_t kBlockWords = Index::blockWords(kParameters);
  static constexpr std::size_t kGroupWords = Index::groupWords(kParameters);
  static constexpr std::uint32_t kNoChild = Index::kChildren;

  /// A parameter of the box in 16 bits, two in each word, that word in every lane.
  using Theta = std::array<Lanes::Type, kPairs>;

  static Theta prepare(const Index::View& index, const double* theta) noexcept {
    std::array<std::uint32_t, 2 * std::size_t{kPairs}> halves{};
    for (std::size_t i = 0; i < kParameters; ++i) {
      // Shifted so that cutting off the fraction rounds to the nearest in any rounding mode.
      const double shifted = (theta[i] - index.centre[i]) * index.gain[i] + (0x1p15 + 0.5);
      halves[i] = (static_cast<std::uint32_t>(static_cast<std::int32_t>(shifted)) ^ 0x8000u) & 0xffffu;
    }
    Theta prepared;
    for (std::size_t k = 0; k < kPairs; ++k) {
      prepared[k] = Lanes::all(static_cast<std::int32_t>(halves[2 * k] | halves[2 * k + 1] << 16));
    }
    return prepared;
  }

  static const std::int32_t* block(const Index::View& index, std::uint32_t reference) noexcept {
    return index.blocks + reference * kBlockWords;
  }

  static std::uint32_t child(const std::int32_t* block, std::uint32_t number) noexcept {
    return static_cast<std::uint32_t>(block[(kPairs + 1) * Index::kChildren + number]);
  }

  /// Bit i: plane i of the block is that of a node; a path that ended goes on below.
  static unsigned nodes(const std::int32_t* block) noexcept {
    return static_cast<unsigned>(block[Index::kChildren - 1]);
  }

  /// The node of the file that the block begins with.
  static std::uint32_t node(const std::int32_t* block) noexcept {
    return static_cast<std::uint32_t>(block[kPairs * Index::kChildren + Index::kChildren - 1]);
  }

  /// Of a candidate.
  static const std::int32_t* record(const Index::View& index, std::uint32_t candidate) noexcept {
    return index.records + std::size_t{candidate} * Index::kHead;
  }

  /// On which sides of a block's planes theta lies, bit i: above plane i.
  struct Sides {
    unsigned perhaps = 0;
    unsigned surely = 0;
  };

  static Sides sides(const std::int32_t* block, const Theta& theta,
                     const Lanes::Type& twice_margin) noexcept {
    constexpr std::size_t kHalf = Index::kChildren / 2;
    const Lanes::Type first = sum<Index::kChildren>(block, theta);
    const Lanes::Type second = sum<Index::kChildren>(block + kHalf, theta);
    const auto both = [](const Lanes::Type& low, const Lanes::Type& high) {
      return (Lanes::negative(low) | Lanes::negative(high) << kHalf) & 0x7fu;
    };
    return {both(first, second), both(Lanes::add(first, twice_margin), Lanes::add(second, twice_margin))};
  }

  /// Number of the child that theta belongs to, or kNoChild when rounding may have decided.
  static std::uint32_t childNumber(const Sides& sides) noexcept {
    const std::uint32_t number = kNumbers[sides.perhaps];
    return number == kNumbers[sides.surely] ? number : kNoChild;
  }

  /// Of the region with that record, by the rows that `tests` names.
  static Verdict verdict(const std::int32_t* record, std::uint32_t tests, const Theta& theta,
                         const Lanes::Type& twice_margin) noexcept {
    const auto groups = static_cast<std::uint32_t>(record[2]);
    unsigned unsure = 0;
    for (std::uint32_t g = 0; g < groups; ++g) {
      const unsigned tested = Index::testedLanes(tests, g);
      if (tested == 0) continue;
      const Lanes::Type rows = sum<Index::kRowLanes>(group(record, g), theta);
      if ((Lanes::negative(Lanes::add(rows, twice_margin)) & tested) != 0) return Verdict::kOutside;
      unsure |= Lanes::negative(rows) & tested;
    }
    return unsure == 0 ? Verdict::kInside : Verdict::kUnsure;
  }

  /// Which rows of group g it is not sure that theta holds, bit i: row i.
  static unsigned unsureRows(const std::int32_t* record, std::uint32_t g, const Theta& theta) noexcept {
    return Lanes::negative(sum<Index::kRowLanes>(group(record, g), theta));
  }

 private:
  static const std::int32_t* group(const std::int32_t* record, std::uint32_t g) noexcept {
    return record + Index::kHead + g * kGroupWords;
  }

  /// Of four of kCount lanes.
  template <std::size_t kCount>
  static Lanes::Type sum(const std::int32_t* lanes, const Theta& theta) noexcept {
    Lanes::Type sum = Lanes::load(lanes + kPairs * kCount);
    for (std::size_t k = 0; k < kPairs; ++k) {
      sum = Lanes::addProducts(sum, Lanes::load(lanes + k * kCount), theta[k]);
    }
    return sum;
  }

  /// Where the sides of the seven planes of a block lead.
  static constexpr std::array<std::uint8_t, 128> numbers() noexcept {
    std::array<std::uint8_t, 128> table{};
    for (std::uint32_t signs = 0; signs < table.size(); ++signs) {
      std::uint32_t lane = 0;
      for (std::uint32_t level = 0; level < Index::kLevels; ++level)
        lane = 2 * lane + 1 + ((signs >> lane) & 1u);
      table[signs] = static_cast<std::uint8_t>(lane - (Index::kChildren - 1));
    }
    return table;
  }
  static constexpr std::array<std::uint8_t, 128> kNumbers = numbers();
};

}  // namespace polyfly
