#pragma once

#include <string_view>

namespace polyfly {

/// Length of the UTF-8 sequence at the beginning of `text`, which is not empty; 0 if there is none.
std::size_t sequenceLength(std::string_view text) noexcept;

/// Whether `text` is well-formed UTF-8 (RFC 3629: no overlong form, no surrogate).
bool isUtf8(std::string_view text) noexcept;

}  // namespace polyfly
