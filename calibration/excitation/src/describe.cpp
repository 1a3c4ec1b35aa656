#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>

#include "excitation/plan.hpp"

namespace polyfly {
namespace {

// Sampling time of the signals [s].
constexpr double kStep = 0.01;
// Lowest frequency of the table [Hz].
constexpr double kLowest = 0.05;
// Highest frequency of the table [Hz].
constexpr double kHighest = 12.8;
// Frequency ratio of neighbouring rows of the table.
constexpr double kRatio = 1.41421356237;
// Frequency step of the energy integral [Hz].
constexpr double kFine = 0.02;

// A channel's signal over the whole plan.
std::vector<double> samplesOf(const ExcitationPlan& plan, ExcitedChannel channel) {
  std::vector<double> samples;
  for (double time = 0.0; time < plan.duration(); time += kStep) {
    samples.push_back(plan.at(time)[static_cast<std::size_t>(channel)]);
  }
  return samples;
}

void writeSpectrum(const ExcitationPlan& plan, ExcitedChannel channel, std::ostream& out) {
  constexpr double kBar = 40.0;  // width of the longest bar
  std::vector<double> rows, fine;
  for (double frequency = kLowest; frequency <= kHighest; frequency *= kRatio) rows.push_back(frequency);
  for (double frequency = 0.5 * kFine; frequency < kHighest; frequency += kFine) fine.push_back(frequency);
  const std::vector<double> samples = samplesOf(plan, channel);
  const std::vector<double> amplitudes = amplitudeSpectrum(samples, kStep, rows);
  const std::vector<double> spectrum = amplitudeSpectrum(samples, kStep, fine);
  const double greatest = *std::max_element(amplitudes.begin(), amplitudes.end());
  // Energy below half the sampling frequency (Parseval).
  double all = 0.0;
  for (const double sample : samples) all += 0.5 * sample * sample * kStep;
  out << "\n"
      << nameOf(channel) << ": spectrum of all its manoeuvres\n  f [Hz]   |U| [" << unitOf(channel)
      << " s]   energy below\n";
  double below = 0.0;
  std::size_t next = 0;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (; next < fine.size() && fine[next] < rows[row]; ++next)
      below += spectrum[next] * spectrum[next] * kFine;
    out << "  " << std::setw(6) << std::setprecision(3) << rows[row] << "   " << std::setw(10)
        << std::setprecision(3) << amplitudes[row] << "   " << std::setw(5)
        << std::lround(100.0 * std::min(1.0, below / std::max(all, 1e-300))) << " %   "
        << std::string(static_cast<std::size_t>(kBar * amplitudes[row] / std::max(greatest, 1e-300)), '#')
        << "\n";
  }
}

}  // namespace

std::string describe(const ExcitationPlan& plan) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << plan.manoeuvres.size() << " manoeuvres, " << plan.duration() << " s with rests of " << plan.rest
      << " s\n";
  for (const Manoeuvre& manoeuvre : plan.manoeuvres) {
    out << "  at " << std::setw(7) << manoeuvre.start << " s  " << nameOf(manoeuvre.channel) << " "
        << nameOf(manoeuvre.shape) << ", amplitude " << manoeuvre.amplitude << " "
        << unitOf(manoeuvre.channel) << ", " << manoeuvre.duration() << " s\n";
  }
  for (std::size_t index = 0; index < kExcitedChannels; ++index) {
    const auto channel = static_cast<ExcitedChannel>(index);
    const bool used =
        std::any_of(plan.manoeuvres.begin(), plan.manoeuvres.end(),
                    [channel](const Manoeuvre& manoeuvre) { return manoeuvre.channel == channel; });
    if (used) writeSpectrum(plan, channel, out);
  }
  return out.str();
}

}  // namespace polyfly
