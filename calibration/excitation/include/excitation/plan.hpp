#pragma once

#include <array>
#include <string>
#include <vector>

namespace polyfly {

/// What is excited, in the order of the fields of a command.
enum class ExcitedChannel { kRoll, kPitch, kYawRate, kThrust };
constexpr std::size_t kExcitedChannels = 4;
const char* nameOf(ExcitedChannel channel);  ///< roll, pitch, yaw_rate, thrust
const char* unitOf(ExcitedChannel channel);  ///< rad, rad, rad/s, m/s^2 (thrust per mass)

enum class ExcitationShape {
  kTwoOneOne,  ///< a pulse of two units of time, one of one against it, one of one along it
  kMultisine,  ///< tones of equal amplitude at equal ratios, phases by Schroeder's rule for a low peak
};
const char* nameOf(ExcitationShape shape);  ///< 2-1-1, multisine

/// One manoeuvre of one channel.
struct Manoeuvre {
  ExcitedChannel channel = ExcitedChannel::kRoll;
  ExcitationShape shape = ExcitationShape::kTwoOneOne;
  /// Greatest deviation, with its sign [unit of the channel].
  double amplitude = 0.1;
  /// Time unit of 2-1-1, the "1" [s].
  double unit_time = 0.4;
  /// Length of a multisine [s].
  double length = 20.0;
  /// Lowest frequency of a multisine [Hz].
  double frequency_from = 0.1;
  /// Highest frequency of a multisine [Hz].
  double frequency_to = 3.0;
  /// Number of tones of a multisine.
  int tones = 12;
  /// Start time in the plan [s].
  double start = 0.0;

  double duration() const;  ///< [s]
  /// Deviation at `time` after the manoeuvre's start; 0 outside of it.
  double at(double time) const noexcept;
};

/// What shall be flown: manoeuvres one after the other, with rests between, in which the vehicle settles.
struct ExcitationPlan {
  /// Manoeuvres in the order of their start. They do not overlap.
  std::vector<Manoeuvre> manoeuvres;
  /// Rest before each manoeuvre and after the last one [s].
  double rest = 4.0;

  /// Time from the start of the first rest to the end of the last one [s].
  double duration() const;
  /// Index of the manoeuvre that runs at `time` after the plan's start, -1 in a rest.
  int running(double time) const noexcept;
  /// Deviation of each channel at that time.
  std::array<double, kExcitedChannels> at(double time) const noexcept;
};

/// Reads a plan from YAML, see calibration/excitation/README.md; `source` is used in errors. Each entry of
/// `manoeuvres` gives as many manoeuvres as it has channels, amplitudes, signs and repetitions. Throws Error
/// naming source, entry, field and rule.
ExcitationPlan parsePlan(const std::string& text, const std::string& source);
ExcitationPlan loadPlan(const std::string& path);

/// The plan in words and numbers: manoeuvres and duration.
std::string describe(const ExcitationPlan& plan);

}  // namespace polyfly
