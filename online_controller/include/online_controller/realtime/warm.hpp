#pragma once

#include <cstddef>

namespace polyfly {

/// Reads memory, so that it lies in the caches of this processor.
inline void warm(const void* begin, std::size_t bytes) noexcept {
  constexpr std::size_t kLine = 64;
  const auto* from = static_cast<const volatile unsigned char*>(begin);
  for (std::size_t i = 0; i < bytes; i += kLine) static_cast<void>(from[i]);
}

}  // namespace polyfly
