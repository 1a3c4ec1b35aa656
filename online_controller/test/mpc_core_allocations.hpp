#pragma once

namespace polyfly_test {

/// Heap allocations of the program so far: every malloc, calloc and realloc, hence also new and Eigen's own.
/// Under a sanitizer, which owns malloc, every new.
long allocationCount() noexcept;

}  // namespace polyfly_test
