#pragma once

namespace lateral_test {

/// Allocations of this program so far: every malloc; under a sanitizer every new.
long allocations() noexcept;

}  // namespace lateral_test
