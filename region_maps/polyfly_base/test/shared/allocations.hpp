#pragma once

namespace polyfly_test {

/// Heap allocations of this thread so far: whatever C or C++ asks the heap for, hence also Eigen's own. Under a
/// sanitizer, which owns malloc, every new. For tests that name ALLOCATIONS in polyfly_test().
long allocationCount() noexcept;

}  // namespace polyfly_test
