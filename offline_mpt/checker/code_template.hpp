#pragma once

/// The text of exported code, token by token. Between @ stands what the checker fills in, behind $ a number or a table that
/// the code may choose.
namespace checker {

inline constexpr char kHeaderText[] = R"code(
#ifndef POLYFLY_@N@_H
#define POLYFLY_@N@_H
#include <stdint.h>
#define @N@_VERSION "@version@"
#define @N@_MAP "@map@"
#define @N@_PROBLEM "@problem@"
#define @N@_PARAMETERS @p@
#define @N@_INPUTS @q@
#define @N@_REGIONS @regions@
#ifdef __cplusplus
extern "C" {
#endif
typedef enum { @N@_OK = 0, @N@_OUTSIDE = 1, @N@_NOT_FINITE = 2 } @n@_status;
@n@_status @n@_evaluate(const @real@ theta[@p@], @real@ u[@q@]);
@n@_status @n@_locate(const @real@ theta[@p@], uint32_t *region);
#ifdef __cplusplus
}
#endif
#endif
)code";

inline constexpr char kSourceText[] = R"code(
#include "@n@.h"
#include <float.h>
#if (FLT_RADIX != 2) || (@prefix@_MANT_DIG != @digits@)
#error "@n@: @real@ must be IEEE 754 with @digits@ bits"
#endif
@constants@
#if !defined(FLT_EVAL_METHOD) || (FLT_EVAL_METHOD != 0)
#error "@n@: excess precision changes the answers; use the type's own precision (x86: -msse2 -mfpmath=sse)"
#endif
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__)
#error "@n@: fast-math changes the answers and drops the test for NaN"
#endif
#if defined(__FINITE_MATH_ONLY__)
#if __FINITE_MATH_ONLY__ > 0
#error "@n@: -ffinite-math-only drops the test for NaN"
#endif
#endif
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#if __clang_major__ > 10
#pragma clang fp reassociate(off)
#endif
#endif
#if !defined(@N@_TABLE) && defined(__AVR__)
#include <avr/pgmspace.h>
#define @N@_TABLE PROGMEM
#define @N@_U8(element) pgm_read_byte(&(element))
#define @N@_U16(element) pgm_read_word(&(element))
#define @N@_U32(element) pgm_read_dword(&(element))
#define @N@_REAL(element) pgm_read_float(&(element))
#endif
#if !defined(@N@_TABLE)
#define @N@_TABLE
#define @N@_U8(element) (element)
#define @N@_U16(element) (element)
#define @N@_U32(element) (element)
#define @N@_REAL(element) (element)
#endif
#define INPUT_COUNT @q@u
#define REGION_COUNT $REGION_COUNT
#define ROOT $ROOT
@node_count@
static const @real@ @n@_tolerance = $tolerance;
static const @real@ @n@_box[@p@][2] @N@_TABLE = $box;
static const @real@ @n@_plane[$plane_rows][@p1@] @N@_TABLE = $plane;
static const @real@ @n@_law[$law_rows][@p1@] @N@_TABLE = $law;
@tree@
static const uint@leaf_first@_t @n@_leaf_first[$leaf_first_rows] @N@_TABLE = $leaf_first;
static const uint@candidate_region@_t @n@_candidate_region[$candidate_region_rows] @N@_TABLE = $candidate_region;
static const uint@candidate_first@_t @n@_candidate_first[$candidate_first_rows] @N@_TABLE = $candidate_first;
static const uint@row@_t @n@_row[$row_rows] @N@_TABLE = $row;
static const uint@region_law@_t @n@_region_law[$region_law_rows] @N@_TABLE = $region_law;
static @real@ @n@_distance(const @real@ theta[@p@], @index@ plane) { @distance@ }
@test@
static @n@_status @n@_test_box(const @real@ theta[@p@]) {
  @n@_status status = @N@_OK;
  unsigned int i;
  for (i = 0u; i < @p@u; ++i) {
    if (!((theta[i] >= -@prefix@_MAX) && (theta[i] <= @prefix@_MAX))) {
      status = @N@_NOT_FINITE;
    } else if ((status == @N@_OK) && ((theta[i] < @N@_REAL(@n@_box[i][0])) || (theta[i] > @N@_REAL(@n@_box[i][1])))) {
      status = @N@_OUTSIDE;
    } else {
    }
  }
  return status;
}
@n@_status @n@_locate(const @real@ theta[@p@], uint32_t *region) {
  @n@_status status = @n@_test_box(theta);
  if (status == @N@_OK) {
    @index@ child = ROOT;
    @index@ i;
    @index@ end;
    @least@
    @descent@
    status = @N@_OUTSIDE;
    end = @N@_U@leaf_first@(@n@_leaf_first[child + 1u]);
    for (i = @N@_U@leaf_first@(@n@_leaf_first[child]); i < end; ++i) { @search@ }
  }
  return status;
}
@n@_status @n@_evaluate(const @real@ theta[@p@], @real@ u[@q@]) {
  uint32_t region = 0u;
  const @n@_status status = @n@_locate(theta, &region);
  if (status == @N@_OK) {
    const @index@ law = @N@_U@region_law@(@n@_region_law[region]);
    const @index@ first = law * INPUT_COUNT;
    unsigned int i;
    unsigned int j;
    for (j = 0u; j < INPUT_COUNT; ++j) {
      @real@ sum = @N@_REAL(@n@_law[first + j][@p@]);
      for (i = 0u; i < @p@u; ++i) {
        sum += @N@_REAL(@n@_law[first + j][i]) * theta[i];
      }
      u[j] = sum;
    }
  }
  return status;
}
)code";

inline constexpr char kTreeText[] = R"code(
static const uint@node_plane@_t @n@_node_plane[$node_plane_rows] @N@_TABLE = $node_plane;
static const uint@node_child@_t @n@_node_child[$node_child_rows][2] @N@_TABLE = $node_child;
)code";

inline constexpr char kDescentText[] = R"code(
while (child < NODE_COUNT) {
  const @real@ distance = @n@_distance(theta, @N@_U@node_plane@(@n@_node_plane[child]));
  unsigned int side = 1u;
  if (distance <= @zero@) { side = 0u; }
  child = @N@_U@node_child@(@n@_node_child[child][side]);
}
child -= NODE_COUNT;
)code";

/// The rows of a candidate, with what each type does where one is violated or held.
inline constexpr char kTestText[] = R"code(
static @result@ @n@_@tests@(const @real@ theta[@p@], @index@ candidate) {
  const @index@ end = @N@_U@candidate_first@(@n@_candidate_first[candidate + 1u]);
  @start@
  @index@ i;
  for (i = @N@_U@candidate_first@(@n@_candidate_first[candidate]); i < end; ++i) {
    const @index@ row = @N@_U@row@(@n@_row[i]);
    const @real@ distance = @n@_distance(theta, row >> 1u);
    const @real@ violation = ((row & 1u) != 0u) ? -distance : distance;
    if (!(violation <= @n@_tolerance)) { @violated@ break; }
    @held@
  }
  @finish@
}
)code";

inline constexpr char kLeastSearchText[] = R"code(
const @index@ number = @N@_U@candidate_region@(@n@_candidate_region[i]);
const double violation = @n@_violation(theta, i);
if (violation < least) {
  least = violation;
  *region = (uint32_t)number;
  status = @N@_OK;
}
if (least <= @zero@) { break; }
)code";

inline constexpr char kFirstSearchText[] = R"code(
if (@n@_holds(theta, i) != 0) {
  const @index@ number = @N@_U@candidate_region@(@n@_candidate_region[i]);
  *region = (uint32_t)number;
  status = @N@_OK;
  break;
}
)code";

inline constexpr char kDistanceLoopText[] = R"code(
@real@ sum = @zero@;
unsigned int i;
for (i = 0u; i < @p@u; ++i) {
  sum += @N@_REAL(@n@_plane[plane][i]) * theta[i];
}
return sum - @N@_REAL(@n@_plane[plane][@p@]);
)code";

}  // namespace checker
