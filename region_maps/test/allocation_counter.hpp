#pragma once

#include <cstdint>

namespace polyfly {

/// Calls of operator new by this thread since it started. Linking allocation_counter.cpp replaces operator
/// new.
std::uint64_t allocationCount() noexcept;

}  // namespace polyfly
