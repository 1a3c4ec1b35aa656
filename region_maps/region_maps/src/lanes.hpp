#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace polyfly {

/// Four whole numbers of 32 bits that are worked on at once, in two's complement: what overflows wraps
/// around. This one runs on any processor, and is the reference of the other.
struct PortableLanes {
  using Type = std::array<std::uint32_t, 4>;

  static Type load(const std::int32_t* words) noexcept {
    Type lanes;
    std::memcpy(lanes.data(), words, sizeof lanes);
    return lanes;
  }

  static Type all(std::int32_t word) noexcept {
    const auto bits = static_cast<std::uint32_t>(word);
    return {bits, bits, bits, bits};
  }

  static Type add(const Type& a, const Type& b) noexcept {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]};
  }

  static Type either(const Type& a, const Type& b) noexcept {
    return {a[0] | b[0], a[1] | b[1], a[2] | b[2], a[3] | b[3]};
  }

  /// sum + the products of both halves, signed numbers of 16 bits.
  static Type addProducts(const Type& sum, const Type& a, const Type& b) noexcept {
    Type result = sum;
    for (std::size_t i = 0; i < 4; ++i) {
      result[i] += static_cast<std::uint32_t>(low(a[i]) * low(b[i]));
      result[i] += static_cast<std::uint32_t>(low(a[i] >> 16) * low(b[i] >> 16));
    }
    return result;
  }

  /// Bit i: lane i is negative.
  static unsigned negative(const Type& a) noexcept {
    return (a[0] >> 31) | (a[1] >> 31) << 1 | (a[2] >> 31) << 2 | (a[3] >> 31) << 3;
  }

 private:
  static std::int32_t low(std::uint32_t word) noexcept {
    return static_cast<std::int32_t>((word & 0xffffu) ^ 0x8000u) - 0x8000;
  }
};

#if defined(__SSE2__)
/// The same on every x86-64. `words` must be aligned to 16 bytes.
struct Sse2Lanes {
  struct Type {
    __m128i lanes;
  };

  static Type load(const std::int32_t* words) noexcept {
    return {_mm_load_si128(reinterpret_cast<const __m128i*>(words))};
  }
  static Type all(std::int32_t word) noexcept { return {_mm_set1_epi32(word)}; }
  static Type add(Type a, Type b) noexcept { return {_mm_add_epi32(a.lanes, b.lanes)}; }
  static Type either(Type a, Type b) noexcept { return {_mm_or_si128(a.lanes, b.lanes)}; }
  static Type addProducts(Type sum, Type a, Type b) noexcept {
    return {_mm_add_epi32(sum.lanes, _mm_madd_epi16(a.lanes, b.lanes))};
  }
  static unsigned negative(Type a) noexcept {
    return static_cast<unsigned>(_mm_movemask_ps(_mm_castsi128_ps(a.lanes)));
  }
};
using Lanes = Sse2Lanes;
#else
using Lanes = PortableLanes;
#endif

}  // namespace polyfly
