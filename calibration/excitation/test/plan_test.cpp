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

// The sum as its definition has it, one term after the other.
double naiveSpectrum(const std::vector<double>& samples, double dt, double frequency) {
  std::complex<double> sum = 0.0;
  for (std::size_t index = 0; index < samples.size(); ++index) {
    sum += samples[index] * std::polar(1.0, -2.0 * kPi * frequency * dt * static_cast<double>(index));
  }
  return dt * std::abs(sum);
}

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

TEST(ExcitationSpectrum, equalsTheNaiveTransform) {
  const std::vector<double> frequencies = {0.05, 0.1, 0.37, 0.6125, 1.0, 2.5, 7.9, 20.0, 49.0};
  for (const ExcitationShape shape : {ExcitationShape::kTwoOneOne, ExcitationShape::kDoublet,
                                      ExcitationShape::kMultisine, ExcitationShape::kChirp}) {
    const std::vector<double> samples = sampled(shaped(shape));
    const std::vector<double> spectrum = amplitudeSpectrum(samples, kStep, frequencies);
    for (std::size_t index = 0; index < frequencies.size(); ++index) {
      EXPECT_NEAR(spectrum[index], naiveSpectrum(samples, kStep, frequencies[index]), 1e-9)
          << nameOf(shape) << " at " << frequencies[index] << " Hz";
    }
  }
}

TEST(ExcitationSpectrum, ofADoubletIsTheOneOfTheBooks) {
  // |U(f)| = 2 a sin^2(pi f T) / (pi f) for pulses of length T
  Manoeuvre doublet = shaped(ExcitationShape::kDoublet);
  doublet.unit_time = 0.5;
  const std::vector<double> samples = sampled(doublet);
  for (const double frequency : {0.2, 0.5, 0.8, 1.3}) {
    const double wave = std::sin(kPi * frequency * doublet.unit_time);
    const double expected = 2.0 * doublet.amplitude * wave * wave / (kPi * frequency);
    EXPECT_NEAR(amplitudeSpectrum(samples, kStep, {frequency})[0], expected, 0.01 * doublet.amplitude);
  }
}

TEST(ExcitationSpectrum, ofAMultisineStandsAtItsTones) {
  Manoeuvre multisine = shaped(ExcitationShape::kMultisine);
  multisine.length = 100.0;
  multisine.frequency_from = 0.2;
  multisine.frequency_to = 3.2;
  multisine.tones = 5;  // 0.2 0.4 0.8 1.6 3.2
  const std::vector<double> samples = sampled(multisine);
  for (const double tone : {0.2, 0.4, 0.8, 1.6, 3.2}) {
    EXPECT_GT(amplitudeSpectrum(samples, kStep, {tone})[0],
              10.0 * amplitudeSpectrum(samples, kStep, {1.2 * tone})[0]);
  }
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
  for (const ExcitationShape shape : {ExcitationShape::kMultisine, ExcitationShape::kChirp}) {
    const std::vector<double> samples = sampled(shaped(shape));
    const auto [least, greatest] = std::minmax_element(samples.begin(), samples.end());
    EXPECT_LE(*greatest, 0.2);
    EXPECT_GE(*least, -0.2);
    EXPECT_GT(*greatest, 0.15);
  }
}

TEST(Excitation, aChirpRunsFromOneFrequencyToTheOther) {
  Manoeuvre chirp = shaped(ExcitationShape::kChirp);
  chirp.length = 40.0;
  chirp.frequency_from = 0.5;
  chirp.frequency_to = 2.0;
  int crossings = 0;
  double before = chirp.at(1e-6);
  for (double time = 0.001; time < chirp.length; time += 0.001) {
    const double now = chirp.at(time);
    crossings += now * before < 0.0 ? 1 : 0;
    if (now != 0.0) before = now;
  }
  // half turns: twice the integral of the frequency
  const double turns = chirp.length * (2.0 - 0.5) / std::log(4.0);
  EXPECT_NEAR(crossings, 2.0 * turns, 2.0);
}

TEST(Excitation, aPlanHasEveryChannelAmplitudeAndSignOneAfterTheOther) {
  const ExcitationPlan plan = parsePlan(
      "rest: 3\n"
      "manoeuvres:\n"
      "  - {shape: 2-1-1, channels: [roll, pitch], amplitudes: [0.1, 0.2], unit_time: 0.5}\n"
      "  - {shape: chirp, channels: thrust, amplitudes: 2, length: 10, both_signs: false, repeat: 2}\n",
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
  EXPECT_NE(text.find("pitch: spectrum"), std::string::npos);
  EXPECT_EQ(text.find("yaw_rate: spectrum"), std::string::npos);
}

TEST(Excitation, badPlansAreRefusedByFileFieldAndRule) {
  EXPECT_EQ(errorOf("rest: 3\n"), "plan.yaml:1: manoeuvres: missing");
  EXPECT_EQ(errorOf("pause: 3\nmanoeuvres: [{}]\n"),
            "plan.yaml:1: pause: unknown key; known are manoeuvres, rest");
  EXPECT_EQ(errorOf("manoeuvres: [{}]\n"), "plan.yaml:1: manoeuvres[0].shape: missing");
  EXPECT_EQ(errorOf("manoeuvres: [{shape: square, channels: roll, amplitudes: 0.1}]\n"),
            "plan.yaml:1: manoeuvres[0].shape: 'square' is none of 2-1-1, doublet, multisine, chirp");
  EXPECT_NE(errorOf("manoeuvres: [{shape: doublet, channels: roll, amplitudes: 15}]\n")
                .find("amplitudes: must lie in"),
            std::string::npos);
  EXPECT_NE(errorOf("manoeuvres: [{shape: doublet, channels: roll, amplitudes: 5}]\n").find("up to 0.8 rad"),
            std::string::npos);
  EXPECT_NE(errorOf("manoeuvres: [{shape: doublet, channels: roll, amplitudes: .nan}]\n").find("must be a "),
            std::string::npos);
  EXPECT_NE(
      errorOf("manoeuvres: [{shape: doublet, channels: yaw, amplitudes: 0.1}]\n").find("'yaw' is none of"),
      std::string::npos);
  EXPECT_NE(errorOf("manoeuvres: [{shape: doublet, channels: roll, amplitudes: 0.1, length: 3}]\n")
                .find("length: unknown key"),
            std::string::npos);
  EXPECT_NE(errorOf("manoeuvres: [{shape: chirp, channels: roll, amplitudes: 0.1, frequency_to: 0.05}]\n")
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
