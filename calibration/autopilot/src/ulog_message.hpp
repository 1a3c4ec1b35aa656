#pragma once

#include <cstddef>
#include <cstdint>

namespace polyfly {

/// Whether type, size and content are those of a message of a ULog, by the format's description. Not for data messages:
/// their size stands in their subscription.
bool isULogMessage(char type, const std::uint8_t* data, std::size_t size);

}  // namespace polyfly
