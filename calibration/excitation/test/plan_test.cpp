#include "excitation/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kStep = 0.01;

std::vector<double> sampled(const Manoeuvre& manoeuvre, double rest = 2.0) {
  std::vector<double> samples;
  for (double time = -rest; time < manoeuvre.duration() + rest; time += kStep)
    samples.push_back(manoeuvre.at(time));
  return samples;
}

Manoeuvre shaped(ExcitationShape shape) {
  Manoeuvre manoeuvre;
  manoeuvre.shape = shape;
  manoeuvre.amplitude = 0.2;
  return manoeuvre;
}

std::string errorOf(const std::string& text) {
  try {
    parsePlan(text, "plan.yaml");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// At a tone the sum over all samples grows with their number, beside it it does not.
TEST(Excitation, aMultisineIsTheSumOfItsTones) {
  Manoeuvre multisine = shaped(ExcitationShape::kMultisine);
  multisine.length = 100.0;
  multisine.frequency_from = 0.2;
  multisine.frequency_to = 3.2;
  multisine.tones = 5;  // 0.2 0.4 0.8 1.6 3.2
  const std::vector<double> samples = sampled(multisine);
  const auto amplitudeAt = [&samples](double frequency) {
    std::complex<double> sum = 0.0;
    for (std::size_t index = 0; index < samples.size(); ++index)
      sum += samples[index] * std::polar(1.0, -2.0 * kPi * frequency * kStep * static_cast<double>(index));
    return std::abs(sum);
  };
  for (const double tone : {0.2, 0.4, 0.8, 1.6, 3.2})
    EXPECT_GT(amplitudeAt(tone), 10.0 * amplitudeAt(1.2 * tone));
}

TEST(Excitation, pulsesAreTwoOneAndOne) {
  Manoeuvre manoeuvre = shaped(ExcitationShape::kTwoOneOne);
  manoeuvre.unit_time = 0.5;
  EXPECT_EQ(manoeuvre.duration(), 2.0);
  EXPECT_EQ(manoeuvre.at(-0.01), 0.0);
  EXPECT_EQ(manoeuvre.at(0.0), 0.2);
  EXPECT_EQ(manoeuvre.at(0.99), 0.2);
  EXPECT_EQ(manoeuvre.at(1.01), -0.2);
  EXPECT_EQ(manoeuvre.at(1.49), -0.2);
  EXPECT_EQ(manoeuvre.at(1.51), 0.2);
  EXPECT_EQ(manoeuvre.at(2.0), 0.0);
}

TEST(Excitation, neverGoesBeyondItsAmplitude) {
  const std::vector<double> samples = sampled(shaped(ExcitationShape::kMultisine));
  const auto [least, greatest] = std::minmax_element(samples.begin(), samples.end());
  EXPECT_LE(*greatest, 0.2);
  EXPECT_GE(*least, -0.2);
  EXPECT_GT(*greatest, 0.15);
}

TEST(Excitation, aPlanHasEveryChannelAmplitudeAndSignOneAfterTheOther) {
  const ExcitationPlan plan = parsePlan(
      "rest: 3\n"
      "manoeuvres:\n"
      "  - {shape: 2-1-1, channels: [roll, pitch], amplitudes: [0.1, 0.2], unit_time: 0.5}\n"
      "  - {shape: multisine, channels: thrust, amplitudes: 2, length: 10, both_signs: false, repeat: 2}\n",
      "plan.yaml");
  ASSERT_EQ(plan.manoeuvres.size(), 10u);
  EXPECT_DOUBLE_EQ(plan.duration(), 8 * (3.0 + 2.0) + 2 * (3.0 + 10.0) + 3.0);
  for (std::size_t index = 0; index < plan.manoeuvres.size(); ++index) {
    const Manoeuvre& manoeuvre = plan.manoeuvres[index];
    EXPECT_EQ(plan.running(manoeuvre.start - 0.01), -1);
    EXPECT_EQ(plan.running(manoeuvre.start + 0.01), static_cast<int>(index));
    if (index < 8) {
      EXPECT_EQ(manoeuvre.channel, index < 4 ? ExcitedChannel::kRoll : ExcitedChannel::kPitch);
      EXPECT_EQ(manoeuvre.amplitude, (index % 4 < 2 ? 0.1 : 0.2) * (index % 2 == 0 ? 1.0 : -1.0));
    }
  }
  const auto deviation = plan.at(plan.manoeuvres[5].start + 0.01);
  EXPECT_EQ(deviation[1], -0.1);
  EXPECT_EQ(deviation[0], 0.0);
  const std::string text = describe(plan);
  EXPECT_NE(text.find("10 manoeuvres, 69 s"), std::string::npos) << text;
}

TEST(Excitation, badPlansAreRefusedByFileFieldAndRule) {
  EXPECT_EQ(errorOf("rest: 3\n"), "plan.yaml:1: manoeuvres: missing");
  EXPECT_EQ(errorOf("pause: 3\nmanoeuvres: [{}]\n"),
            "plan.yaml:1: pause: unknown key; known are manoeuvres, rest");
  EXPECT_EQ(errorOf("manoeuvres: [{}]\n"), "plan.yaml:1: manoeuvres[0].shape: missing");
  EXPECT_EQ(errorOf("manoeuvres: [{shape: square, channels: roll, amplitudes: 0.1}]\n"),
            "plan.yaml:1: manoeuvres[0].shape: 'square' is none of 2-1-1, multisine");
  EXPECT_NE(errorOf("manoeuvres: [{shape: 2-1-1, channels: roll, amplitudes: 15}]\n")
                .find("amplitudes: must lie in [0, 0.8]"),
            std::string::npos);
  EXPECT_NE(errorOf("manoeuvres: [{shape: 2-1-1, channels: roll, amplitudes: 0}]").find("must be above 0"),
            std::string::npos);
  EXPECT_NE(errorOf("manoeuvres: [{shape: 2-1-1, channels: roll, amplitudes: .nan}]\n").find("must be a "),
            std::string::npos);
  EXPECT_NE(
      errorOf("manoeuvres: [{shape: 2-1-1, channels: yaw, amplitudes: 0.1}]\n").find("'yaw' is none of"),
      std::string::npos);
  EXPECT_NE(errorOf("manoeuvres: [{shape: 2-1-1, channels: roll, amplitudes: 0.1, length: 3}]\n")
                .find("length: unknown key"),
            std::string::npos);
  EXPECT_NE(errorOf("manoeuvres: [{shape: multisine, channels: roll, amplitudes: 0.1, frequency_to: 0.05}]\n")
                .find("must not be below"),
            std::string::npos);
  EXPECT_NE(errorOf("manoeuvres: [{shape: multisine, channels: roll, amplitudes: 0.1, tones: 2.5}]\n")
                .find("whole"),
            std::string::npos);
  EXPECT_NE(errorOf(": [").find("plan.yaml:1: file: is not valid YAML"), std::string::npos);
  EXPECT_THROW(loadPlan("/nowhere/plan.yaml"), Error);
}

}  // namespace
}  // namespace polyfly
