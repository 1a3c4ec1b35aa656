// Counts heap allocations. Apart from the test, so that no compiler sees through the replaced functions.
#include "allocations.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LATERAL_TEST_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define LATERAL_TEST_SANITIZED 1
#endif
#endif

namespace {
std::atomic<long> counted{0};
}

#ifdef LATERAL_TEST_SANITIZED

// malloc belongs to the sanitizer: what comes through new is counted.
void* operator new(std::size_t size) {
  ++counted;
  void* memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

#else

// new and Eigen both end in malloc, and glibc leaves its own under this name.
extern "C" {
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the C library's name
void* __libc_malloc(std::size_t size);

void* malloc(std::size_t size) {
  ++counted;
  return __libc_malloc(size);
}
}

#endif

namespace lateral_test {

long allocations() noexcept { return counted; }

}  // namespace lateral_test
