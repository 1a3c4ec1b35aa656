#include <cmath>

#include "excitation/plan.hpp"

namespace polyfly {
namespace {

constexpr double kPi = 3.14159265358979323846;

double pulses(const Manoeuvre& manoeuvre, double time) {
  const double units = time / manoeuvre.unit_time;
  if (manoeuvre.shape == ExcitationShape::kDoublet) return units < 1.0 ? 1.0 : -1.0;
  return units < 2.0 || units >= 3.0 ? 1.0 : -1.0;
}

double toneFrequency(const Manoeuvre& manoeuvre, int tone) {
  if (manoeuvre.tones == 1) return manoeuvre.frequency_from;
  const double share = static_cast<double>(tone) / (manoeuvre.tones - 1);
  return manoeuvre.frequency_from * std::pow(manoeuvre.frequency_to / manoeuvre.frequency_from, share);
}

// Schroeder: phase of tone k is -pi k (k - 1) / n. The sum is scaled by its greatest value that the phases
// allow, n, halved, and what would still exceed the amplitude is cut: with these phases that is rare.
double multisine(const Manoeuvre& manoeuvre, double time) {
  double sum = 0.0;
  for (int tone = 0; tone < manoeuvre.tones; ++tone) {
    const double phase = -kPi * tone * (tone - 1.0) / manoeuvre.tones;
    sum += std::sin(2.0 * kPi * toneFrequency(manoeuvre, tone) * time + phase);
  }
  const double scale = std::sqrt(2.0 * manoeuvre.tones);
  return std::fmax(-1.0, std::fmin(1.0, sum / scale));
}

double chirp(const Manoeuvre& manoeuvre, double time) {
  const double ratio = manoeuvre.frequency_to / manoeuvre.frequency_from;
  const double rate = std::log(ratio) / manoeuvre.length;
  const double turns = std::abs(rate) < 1e-12 ? manoeuvre.frequency_from * time
                                              : manoeuvre.frequency_from * std::expm1(rate * time) / rate;
  return std::sin(2.0 * kPi * turns);
}

}  // namespace

double Manoeuvre::duration() const {
  switch (shape) {
    case ExcitationShape::kTwoOneOne:
      return 4.0 * unit_time;
    case ExcitationShape::kDoublet:
      return 2.0 * unit_time;
    case ExcitationShape::kMultisine:
    case ExcitationShape::kChirp:
      return length;
  }
  return 0.0;
}

double Manoeuvre::at(double time) const noexcept {
  if (!(time >= 0.0 && time < duration())) return 0.0;
  switch (shape) {
    case ExcitationShape::kTwoOneOne:
    case ExcitationShape::kDoublet:
      return amplitude * pulses(*this, time);
    case ExcitationShape::kMultisine:
      return amplitude * multisine(*this, time);
    case ExcitationShape::kChirp:
      return amplitude * chirp(*this, time);
  }
  return 0.0;
}

double ExcitationPlan::duration() const {
  return manoeuvres.empty() ? rest : manoeuvres.back().start + manoeuvres.back().duration() + rest;
}

int ExcitationPlan::running(double time) const noexcept {
  for (std::size_t index = 0; index < manoeuvres.size(); ++index) {
    const double since = time - manoeuvres[index].start;
    if (since >= 0.0 && since < manoeuvres[index].duration()) return static_cast<int>(index);
  }
  return -1;
}

std::array<double, kExcitedChannels> ExcitationPlan::at(double time) const noexcept {
  std::array<double, kExcitedChannels> deviation{};
  const int index = running(time);
  if (index >= 0) {
    const Manoeuvre& manoeuvre = manoeuvres[static_cast<std::size_t>(index)];
    deviation[static_cast<std::size_t>(manoeuvre.channel)] = manoeuvre.at(time - manoeuvre.start);
  }
  return deviation;
}

std::vector<double> amplitudeSpectrum(const std::vector<double>& samples, double dt,
                                      const std::vector<double>& frequencies) {
  std::vector<double> spectrum;
  for (const double frequency : frequencies) {
    const double twice_cosine = 2.0 * std::cos(2.0 * kPi * frequency * dt);
    double before = 0.0;
    double last = 0.0;
    for (const double sample : samples) {
      const double next = sample + twice_cosine * last - before;
      before = last;
      last = next;
    }
    const double power = last * last + before * before - twice_cosine * last * before;
    spectrum.push_back(dt * std::sqrt(std::fmax(0.0, power)));
  }
  return spectrum;
}

}  // namespace polyfly
