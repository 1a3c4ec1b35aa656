#pragma once

namespace polyfly {

/// Parts of NAME.c of 16-bit integers, with @key@ for what depends on the map.

/// The header's exponents are those of the tables. check_certificate reads them here.
inline constexpr char kFixedArithmetic[] =
    R"code(#if @exponents_differ@
#error "@name@: the header belongs to other tables"
#endif
)code";

inline constexpr char kFixedMacros[] =
    R"code(/* Distances count 2 to the power -PLANE_EXPONENT; all sums fit 32 bits for each theta in the box. */
#define PLANE_EXPONENT @plane_exponent@
#define PLANE_UNIT @plane_unit_value@
#define LAW_UNIT @law_unit_value@
#define GREATEST_INPUT 32767
)code";

inline constexpr char kFixedBoxTest[] =
    R"code(        if ((theta[i] < @NAME@_I16(@name@_box[i][0])) || (theta[i] > @NAME@_I16(@name@_box[i][1]))) {
            status = @NAME@_OUTSIDE;
        }
)code";

inline constexpr char kFixedLawShifts[] =
    R"code(/* Each sum is divided by 2 to this power. */
static const uint8_t @name@_law_shift[@law_rows@] @NAME@_TABLE = @law_shift@;
)code";

/// The bias makes the shifted number nonnegative, so that the shift is portable.
inline constexpr char kFixedRounding[] =
    R"code(/* The integer nearest to sum / 2^shift, limited to the range of an input; shift is 1 to 24. */
static int16_t @name@_rounded(int32_t sum, unsigned int shift)
{
    const uint32_t bias = 0x80000000u;
    const uint32_t half = ((uint32_t)1u << shift) >> 1u;
    const uint32_t biased = ((uint32_t)sum + bias) + half;
    const uint32_t shifted = biased >> shift;
    const uint32_t shifted_bias = bias >> shift;
    int32_t quotient = (int32_t)shifted - (int32_t)shifted_bias;

    if (quotient > GREATEST_INPUT) {
        quotient = GREATEST_INPUT;
    }
    if (quotient < -GREATEST_INPUT) {
        quotient = -GREATEST_INPUT;
    }
    return (int16_t)quotient;
}

)code";

inline constexpr char kFixedLawSum[] =
    R"code(            int32_t sum = (int32_t)@NAME@_I16(@name@_law[first + j][@p@]) * LAW_UNIT;

            for (i = 0u; i < @p@u; ++i) {
                sum += (int32_t)@NAME@_I16(@name@_law[first + j][i]) * theta[i];
            }
            u[j] = @name@_rounded(sum, @NAME@_U8(@name@_law_shift[first + j]));
)code";

}  // namespace polyfly
