#include "validation/validation.hpp"

#include <algorithm>

#include "identification/loop_record.hpp"
#include "validation_parts.hpp"

namespace polyfly {
namespace {

// Greatest velocity and acceleration of a reference that rests [m/s, m/s^2].
constexpr double kRestTolerance = 1e-6;
// Least length of a rest [s]. Shorter rests say nothing about the steady state.
constexpr double kLeastHold = 2.0;
// Share of the rest that is left out until the transient has decayed.
constexpr double kSettlingShare = 0.5;

bool rests(const ReplaySample& sample) {
  return sample.has_reference && sample.reference.velocity.norm() <= kRestTolerance &&
         sample.reference.acceleration.norm() <= kRestTolerance;
}

std::vector<double> stampsOf(const std::vector<ReplaySample>& samples) {
  std::vector<double> stamps;
  for (const ReplaySample& sample : samples) stamps.push_back(sample.state.stamp);
  return stamps;
}

std::optional<HoldOffset> holdOffset(const std::vector<ReplaySample>& all) {
  std::vector<ReplaySample> samples;
  for (const ReplaySample& sample : all) {
    if (sample.is_known) samples.push_back(sample);
  }
  std::size_t first = samples.size();
  while (
      first > 0 && rests(samples[first - 1]) &&
      (first == samples.size() || !isFarStep(samples[first - 1].state.stamp, samples[first].state.stamp))) {
    --first;
  }
  if (first == samples.size() || samples.back().state.stamp - samples[first].state.stamp < kLeastHold) {
    return std::nullopt;
  }
  HoldOffset hold;
  hold.to = samples.back().state.stamp;
  hold.from = samples[first].state.stamp + kSettlingShare * (hold.to - samples[first].state.stamp);
  double count = 0.0;
  for (std::size_t index = first; index < samples.size(); ++index) {
    const ReplaySample& sample = samples[index];
    if (sample.state.stamp < hold.from) continue;
    hold.offset += sample.state.position - sample.reference.position;
    count += 1.0;
  }
  hold.offset /= count;
  return hold;
}

bool isOutside(const ReplaySample& sample) {
  const auto outside = [](const AxisReport& axis) { return axis.lookup != LookupStatus::kInside; };
  return std::any_of(sample.report.axis.begin(), sample.report.axis.end(), outside);
}

void addTracking(const std::vector<ReplaySample>& samples, double duration, DifferenceCollector* tracking,
                 ValidationReport* report) {
  std::size_t outside = 0;
  for (const ReplaySample& sample : samples) {
    if (!sample.is_known) continue;
    report->top_speed = std::max(report->top_speed, sample.state.velocity.norm());
    if (!sample.has_reference) continue;
    ++report->tracked_samples;
    tracking->add((sample.state.position - sample.reference.position).norm(), sample.state.stamp);
    if (isOutside(sample)) ++outside;
  }
  report->outside_map_samples += outside;
  if (samples.size() > 1)
    report->outside_map_time +=
        duration * static_cast<double>(outside) / static_cast<double>(samples.size() - 1);
}

void addStretches(const std::vector<ReplaySample>& samples, std::vector<IncomparableStretch>* all) {
  std::vector<IncomparableStretch> stretches;
  const ReplaySample* before = nullptr;
  for (const ReplaySample& sample : samples) {
    if (sample.ignorance && (before == nullptr || before->ignorance != sample.ignorance)) {
      const bool is_hole = *sample.ignorance == Ignorance::kMissing && before != nullptr;
      stretches.push_back({*sample.ignorance, (is_hole ? *before : sample).state.stamp, 0.0, 0});
    }
    if (sample.ignorance) {
      stretches.back().to = sample.state.stamp;
      ++stretches.back().samples;
    }
    before = &sample;
  }
  all->insert(all->end(), stretches.begin(), stretches.end());
}

}  // namespace

Verdict ValidationReport::verdict() const {
  if (!broken.empty()) return Verdict::kFailed;
  return warnings.empty() ? Verdict::kPassed : Verdict::kDoubtful;
}

std::size_t ValidationReport::regionCount() const {
  return axes[0].regions() + axes[1].regions() + axes[2].regions();
}

std::size_t ValidationReport::visitedCount() const {
  return axes[0].visited() + axes[1].visited() + axes[2].visited();
}

double ValidationReport::maxQpDifference() const {
  double greatest = 0.0;
  for (const AxisValidation& axis : axes) {
    greatest = worse(greatest, axis.qp.max);
  }
  return greatest;
}

std::size_t ValidationReport::violationCount() const {
  return commands.angle_violations + commands.thrust_violations + commands.yaw_rate_violations +
         commands.not_finite;
}

bool ValidationReport::isWhole() const { return (!share || share->isWhole()) && incomparable.empty(); }

ValidationReport validate(const std::vector<ReplayedFlight>& flights, const AxisMaps& maps) {
  ValidationReport report;
  const ReplayedFlight& first = flights.front();
  report.source = flights.size() == 1 ? first.log.source : std::to_string(flights.size()) + " flights";
  report.share = first.log.share;
  DifferenceCollector tracking;
  for (const ReplayedFlight& flight : flights) {
    const std::optional<RecordingShare>& share = flight.log.share;
    if (&flight != &first)
      report.share = report.share && share ? std::optional(together(*report.share, *share)) : std::nullopt;
    report.samples += flight.samples.size();
    const double duration = durationOf(stampsOf(flight.samples));
    report.duration += duration;
    addStretches(flight.samples, &report.incomparable);
    addTracking(flight.samples, duration, &tracking, &report);
  }
  report.tracking = tracking.result();
  if (report.tracked_samples > 0) {
    report.coverage =
        1.0 - static_cast<double>(report.outside_map_samples) / static_cast<double>(report.tracked_samples);
  }
  std::vector<double> lookups;
  for (std::size_t axis = 0; axis < maps.size(); ++axis) {
    report.axes[axis] = validateAxis(flights, *maps[axis], axis);
    const std::vector<double>& times = report.axes[axis].lookup_times;
    lookups.insert(lookups.end(), times.begin(), times.end());
  }
  report.lookup_ns = percentiles(lookups);
  report.commands = validateCommands(flights);
  report.statuses = validateStatuses(flights, maps);
  if (flights.size() > 1) return report;
  report.parameters = parametersTold(first.log);
  report.hold = holdOffset(first.samples);
  report.warnings = warningsOf(first, maps, report);
  return report;
}

}  // namespace polyfly
