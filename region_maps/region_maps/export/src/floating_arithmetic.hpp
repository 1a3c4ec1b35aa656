#pragma once

namespace polyfly {

/// What code of floating-point numbers demands of the compiler, with @key@ for name and type.
inline constexpr char kFloatingArithmetic[] =
    R"code(#include <float.h>

#if (FLT_RADIX != 2) || (@prefix@_MANT_DIG != @digits@)
#error "@name@: @real@ must be IEEE 754 with @digits@ bits"
#endif
@constants@#if !defined(FLT_EVAL_METHOD) || (FLT_EVAL_METHOD != 0)
#error "@name@: excess precision changes the answers; use the type's own precision (x86: -msse2 -mfpmath=sse)"
#endif
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__)
#error "@name@: fast-math changes the answers and drops the test for NaN"
#endif
#if defined(__FINITE_MATH_ONLY__)
#if __FINITE_MATH_ONLY__ > 0
#error "@name@: -ffinite-math-only drops the test for NaN"
#endif
#endif
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#if __clang_major__ > 10
/* -funsafe-math-optimizations defines no macro. */
#pragma clang fp reassociate(off)
#endif
#endif
)code";

/// Of doubles: MISRA's rule 2.3 would have the type used.
inline constexpr char kDoubleConstants[] =
    R"code(/* No array has -1 elements: -fsingle-precision-constant makes the constants of the tables floats. */
typedef char @name@_constants[(sizeof(1.0) == sizeof(double)) ? 1 : -1];
)code";

}  // namespace polyfly
