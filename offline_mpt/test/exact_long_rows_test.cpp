// Rows whose whole numbers are beyond the range of a double: those of a horizon of 16 steps already are.
#include <cmath>
#include <limits>

#include "arithmetic/exact_numbers.hpp"
#include "certify/farkas_proof.hpp"
#include "certify/multipliers.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mutation.hpp"

namespace polyfly {
namespace {

constexpr unsigned kLong = 1500;  // bits; a double ends at 1024

/// (a, b) with the given numbers, the gradient times 2^gradient_bits, the constant times 2^constant_bits.
ExactRow rowOf(const std::vector<long>& numbers, unsigned gradient_bits, unsigned constant_bits) {
  ExactRow row;
  for (const long number : numbers) row.value.push_back(Integer(number) << gradient_bits);
  row.value.back() = Integer(numbers.back()) << constant_bits;
  row.value.front() += 1;  // an odd number, so that no common factor shortens the row
  finishRow(row);
  return row;
}

TEST(LongRows, NumbersBecomeWholeForAnyPowerOfTwo) {
  EXPECT_EQ(toInteger(0.75, 2), 3);
  EXPECT_EQ(toInteger(0.75, 1), 1);
  EXPECT_EQ(toInteger(0.75, -3), 0);
  EXPECT_EQ(toInteger(0.0, 5000), 0);
  EXPECT_EQ(toInteger(1.5, 5000), Integer(3) << 4999u);
  EXPECT_EQ(toInteger(std::ldexp(1.0, -1074), 5000), Integer(1) << 3926u);
  EXPECT_EQ(toInteger(std::numeric_limits<double>::max(), 100) >> 1123u, 1);
}

TEST(LongRows, FractionsBeyondDoublesAreRoundedUpToInfinity) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Rational huge(Integer(1) << kLong);
  EXPECT_EQ(above(huge), kInfinity);
  EXPECT_EQ(above(-huge), std::numeric_limits<double>::lowest());
  EXPECT_EQ(above(Rational(1) / huge), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(above(Rational(1)), 1.0);
}

TEST(LongRows, AGradientThatIsFarSmallerThanItsConstantKeepsItsDirection) {
  const ExactRow row = rowOf({3, 4, 1}, 1, 2 * kLong);
  EXPECT_NEAR(row.unit[0], -7.0 / std::hypot(7.0, 8.0), 1e-15);
  EXPECT_NEAR(row.unit[1], -8.0 / std::hypot(7.0, 8.0), 1e-15);
  EXPECT_EQ(row.unit[2], std::numeric_limits<double>::infinity());
  EXPECT_GT(row.length, 0.0);
}

// t_0 >= 0 and t_0 <= 0 but for one part in 2^1500: no double tells whether anything lies between them.
TEST(LongRows, InteriorsAreDecidedWithoutRounding) {
  for (const int between : {-1, 0, 1}) {
    ExactRow low = rowOf({1, 0, 0}, kLong, 0), high = rowOf({-1, 0, 0}, kLong, 0);
    low.value.back() = between;
    high.value.back() = between;
    finishRow(low);
    finishRow(high);
    const Interior interior = findInterior({&low, &high}, nullptr, 2);
    EXPECT_EQ(interior.exists, between == 1) << between;
    if (!interior.exists) {
      EXPECT_TRUE(provesEmpty(interior.proof, {&low, &high}, nullptr)) << between;
    }
  }
}

TEST(LongRows, ConstantsBeyondDoublesAreDecidedWithoutRounding) {
  const ExactRow slack = rowOf({1, 1, 1}, 1, 2 * kLong), broken = rowOf({1, 1, -1}, 1, 2 * kLong);
  const ExactRow side = rowOf({1, 0, 0}, kLong, 0);
  EXPECT_TRUE(findInterior({&slack, &side}, nullptr, 2).exists);
  const Interior none = findInterior({&broken, &side}, nullptr, 2);
  EXPECT_FALSE(none.exists);
  EXPECT_TRUE(provesEmpty(none.proof, {&broken, &side}, nullptr));
  FloatLp solver(2);
  EXPECT_TRUE(implies({&side}, slack, solver).holds);
  EXPECT_FALSE(implies({&side}, broken, solver).holds);
}

TEST(LongRows, NoPointLiesOnAConstantRow) {
  const ExactRow side = rowOf({1, 0, 0}, 1, 0);
  ExactRow constant = side;
  constant.value = {0, 0, 1};
  finishRow(constant);
  EXPECT_FALSE(findInterior({&side}, &constant, 2).exists);
}

// More parameters than the guess in doubles holds.
TEST(LongRows, ManyParametersAreDecidedWithoutAGuess) {
  constexpr int kMany = 20;
  std::vector<long> numbers(kMany + 1, 1);
  const ExactRow row = rowOf(numbers, 1, 1);
  EXPECT_TRUE(findInterior({&row}, nullptr, kMany).exists);
}

/// A rover's heading, as a problem file states it; its condensed rows take 100 bits and more for each step.
std::string roverProblem(int horizon) {
  return R"(polyfly_problem: 1
name: rover_heading
type: tracking_mpc
model:
  states: [{name: psi, unit: rad}, {name: yaw_rate, unit: rad/s, range: [-1, 1]}]
  inputs: [{name: steer, unit: rad, range: [-0.5, 0.5]}]
  disturbances: []
  A: [[0, 1], [0, -2]]
  B: [[0], [4]]
  C: [[1, 0]]
sampling_time: 0.1
horizon: )" +
         std::to_string(horizon) +
         R"(
weights: {Q: [10, 1], R: [1], R_delta: [0]}
parameters:
  - {name: e_psi, role: error, of: psi, unit: rad, range: [-1, 1]}
  - {name: e_yaw_rate, role: error, of: yaw_rate, unit: rad/s, range: [-1, 1]}
  - {name: steer_ref, role: input_reference, of: steer, unit: rad, range: [-0.2, 0.2]}
)";
}

TEST(LongRows, OfAnOrdinaryHorizonAreProven) {
  const std::string text = roverProblem(16);
  proven(parseProgram(text, "yaml", "rover"), text);
}

}  // namespace
}  // namespace polyfly
