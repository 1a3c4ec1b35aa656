#pragma once

#include <string_view>

namespace polyfly {

/// Whether `text` is well-formed UTF-8 (RFC 3629: no overlong form, no surrogate).
bool isUtf8(std::string_view text) noexcept;

}  // namespace polyfly
