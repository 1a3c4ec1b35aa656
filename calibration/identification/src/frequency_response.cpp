#include "identification/frequency_response.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "identification/excitation.hpp"

namespace polyfly {
namespace {

using Complex = std::complex<double>;

constexpr double kPi = 3.14159265358979323846;
constexpr double kSamplesPerBlock = 256.0;
constexpr std::size_t kLeastBlocks = 2;  // with one alone, coherence is always 1

struct Spectra {
  std::vector<double> command;
  std::vector<double> response;
  std::vector<Complex> cross;
  std::size_t blocks = 0;
};

double linearValue(const std::vector<double>& time, const std::vector<double>& value, double at) {
  const auto after = std::upper_bound(time.begin(), time.end(), at);
  if (after == time.begin()) return value.front();
  if (after == time.end()) return value.back();
  const auto i = static_cast<std::size_t>(after - time.begin());
  const double share = (at - time[i - 1]) / (time[i] - time[i - 1]);
  return value[i - 1] + share * (value[i] - value[i - 1]);
}

void removeMean(std::vector<double>* values) {
  double mean = 0.0;
  for (const double value : *values) mean += value;
  mean /= static_cast<double>(values->size());
  for (double& value : *values) value -= mean;
}

Complex transformAt(const std::vector<double>& values, double angle_per_sample) {
  const auto size = static_cast<double>(values.size());
  Complex sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto at = static_cast<double>(i);
    const double hann = 0.5 - 0.5 * std::cos(2.0 * kPi * (at + 0.5) / size);
    sum += hann * values[i] * std::polar(1.0, -angle_per_sample * at);
  }
  return sum;
}

void addBlock(const LoopSegment& segment, double from, double block, const std::vector<double>& frequencies,
              Spectra* spectra) {
  const double step = block / kSamplesPerBlock;
  std::vector<double> command;
  std::vector<double> response;
  for (double i = 0.0; i < kSamplesPerBlock; ++i) {
    command.push_back(heldValue(segment.command, from + i * step));
    response.push_back(linearValue(segment.time, segment.response, from + i * step));
  }
  removeMean(&command);
  removeMean(&response);
  for (std::size_t k = 0; k < frequencies.size(); ++k) {
    const double angle = 2.0 * kPi * frequencies[k] * step;
    const Complex input = transformAt(command, angle);
    const Complex output = transformAt(response, angle);
    spectra->command[k] += std::norm(input);
    spectra->response[k] += std::norm(output);
    spectra->cross[k] += output * std::conj(input);
  }
  ++spectra->blocks;
}

double unwrapped(double phase, double before) {
  return phase + 2.0 * kPi * std::round((before - phase) / (2.0 * kPi));
}

}  // namespace

std::vector<FrequencyPoint> measureFrequencyResponse(const std::vector<LoopSegment>& segments, double block,
                                                     double greatest, int points) {
  std::vector<double> frequencies;
  frequencies.reserve(static_cast<std::size_t>(points));
  const double least = 2.0 / block;
  for (int i = 0; i < points; ++i) {
    frequencies.push_back(least * std::pow(greatest / least, static_cast<double>(i) / (points - 1)));
  }
  Spectra spectra;
  spectra.command.resize(frequencies.size());
  spectra.response.resize(frequencies.size());
  spectra.cross.resize(frequencies.size());
  for (const LoopSegment& segment : segments) {
    for (double from = segment.time.front(); from + block <= segment.time.back(); from += 0.5 * block) {
      addBlock(segment, from, block, frequencies, &spectra);
    }
  }
  std::vector<FrequencyPoint> result;
  if (spectra.blocks < kLeastBlocks) return result;
  const double strongest = *std::max_element(spectra.command.begin(), spectra.command.end());
  double before = 0.0;
  for (std::size_t k = 0; k < frequencies.size(); ++k) {
    if (!(spectra.command[k] > 0.0) || !(spectra.response[k] > 0.0)) continue;
    FrequencyPoint point;
    point.frequency = frequencies[k];
    const Complex ratio = spectra.cross[k] / spectra.command[k];
    point.gain = std::abs(ratio);
    point.phase = before = unwrapped(std::arg(ratio), before);
    point.coherence = std::norm(spectra.cross[k]) / (spectra.command[k] * spectra.response[k]);
    point.command_power = spectra.command[k] / strongest;
    result.push_back(point);
  }
  return result;
}

FrequencyPoint modelFrequencyResponse(const LoopFit& fit, double frequency) {
  const double omega = 2.0 * kPi * frequency;
  FrequencyPoint point;
  point.frequency = frequency;
  double lag = 0.0;
  if (fit.shape.order == LoopOrder::kFirst) {
    point.gain = fit.gain / std::hypot(1.0, omega * fit.shape.tau);
    lag = std::atan(omega * fit.shape.tau);
  } else {
    const double ratio = omega / fit.shape.omega;
    const double real = 1.0 - ratio * ratio;
    const double imaginary = 2.0 * fit.shape.zeta * ratio;
    point.gain = fit.gain / std::hypot(real, imaginary);
    lag = std::atan2(imaginary, real);
  }
  point.phase = -lag - omega * fit.shape.delay;
  point.coherence = 1.0;
  return point;
}

}  // namespace polyfly
