#include "mpc_core/qp_kernels.hpp"

#include <cmath>

// The same text is compiled for each instruction set. Vectors of four doubles are an extension of GCC and
// clang; where the processor has none, the compiler makes two of two.
#define POLYFLY_QP_KERNELS "qp_kernels.inc"

namespace polyfly {
namespace {

// `aligned(8)`: columns of a Gram matrix need not start on a pack.
typedef double Pack __attribute__((vector_size(32), aligned(8), may_alias));

namespace plain {
#include POLYFLY_QP_KERNELS
}  // namespace plain

#if defined(__x86_64__)
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif
namespace avx2 {
#include POLYFLY_QP_KERNELS
}  // namespace avx2
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif

}  // namespace

const QpKernels& plainQpKernels() noexcept { return plain::kKernels; }

const QpKernels& qpKernels() noexcept {
#if defined(__x86_64__)
  static const bool kHasAvx2 = __builtin_cpu_supports("avx2") != 0;
  if (kHasAvx2) return avx2::kKernels;
#endif
  return plain::kKernels;
}

}  // namespace polyfly
