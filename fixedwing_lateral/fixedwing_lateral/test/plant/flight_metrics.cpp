#include "fixedwing_plant/flight_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace polyfly {

double pathDistance(const std::vector<PathSegment>& segments, const FlightSample& sample) {
  constexpr int kNear = 2;
  const int last = static_cast<int>(segments.size()) - 1;
  double least = std::numeric_limits<double>::infinity();
  for (int i = std::max(0, sample.output.segment - kNear); i <= std::min(last, sample.output.segment + 1);
       ++i) {
    const Eigen::Vector2d& position = sample.truth.position;
    least = std::min(least, (closestPoint(segments[i], position).point.position - position).norm());
  }
  return least;
}

std::vector<SegmentMetrics> segmentMetrics(const std::vector<PathSegment>& segments,
                                           const std::vector<FlightSample>& samples, double settle,
                                           double window) {
  std::vector<SegmentMetrics> all;
  for (std::size_t begin = 0; begin < samples.size();) {
    std::size_t end = begin;
    while (end < samples.size() && samples[end].output.segment == samples[begin].output.segment) ++end;
    SegmentMetrics metrics;
    metrics.segment = samples[begin].output.segment;
    const PathSegment& segment = segments[metrics.segment];
    const double start = samples[begin].time;
    const double stop = samples[end - 1].time;
    metrics.duration = stop - start;
    const double side = samples[begin].output.error.track >= 0.0 ? 1.0 : -1.0;
    for (std::size_t i = begin; i < end; ++i) {
      const FlightSample& sample = samples[i];
      const double speed = sample.truth.ground_velocity.norm();
      const ClosestPoint nearest = closestPoint(segment, sample.truth.position);
      const bool approaching = nearest.remaining < window * speed;
      if (!approaching && std::holds_alternative<LineSegment>(segment))
        metrics.overshoot = std::max(metrics.overshoot, -side * sample.output.error.track);
      const double distance = pathDistance(segments, sample);
      if (distance >= kConverged && !approaching) metrics.convergence = sample.time - start;
      if (sample.time - start < settle * metrics.duration || approaching) continue;
      metrics.has_converged = true;
      metrics.converged = std::max(metrics.converged, distance);
    }
    all.push_back(metrics);
    begin = end;
  }
  return all;
}

namespace {

void addJoining(const std::vector<PathSegment>& segments, const std::vector<FlightSample>& samples,
                FlightMetrics& metrics) {
  double since = std::numeric_limits<double>::infinity();  // it has been near
  for (const FlightSample& sample : samples) {
    const double distance = pathDistance(segments, sample);
    if (!metrics.has_joined) {
      since = distance < kConverged ? std::min(since, sample.time) : std::numeric_limits<double>::infinity();
      metrics.has_joined = sample.time - since >= kJoinedFor;
      metrics.joined = metrics.has_joined ? since : 0.0;
    }
    if (metrics.has_joined) metrics.after_joining = std::max(metrics.after_joining, distance);
  }
}

}  // namespace

FlightMetrics flightMetrics(const std::vector<PathSegment>& segments,
                            const std::vector<FlightSample>& samples, double settle, double window) {
  FlightMetrics metrics;
  double squares = 0.0;
  double rates = 0.0;
  for (const FlightSample& sample : samples) {
    const double distance = pathDistance(segments, sample);
    squares += distance * distance;
    rates += sample.truth.roll_rate * sample.truth.roll_rate;
    metrics.largest = std::max(metrics.largest, distance);
    metrics.roll_largest = std::max(metrics.roll_largest, std::abs(sample.truth.roll));
    metrics.rate_largest = std::max(metrics.rate_largest, std::abs(sample.truth.roll_rate));
  }
  const double count = std::max(1.0, static_cast<double>(samples.size()));
  metrics.rms = std::sqrt(squares / count);
  metrics.roll_effort = std::sqrt(rates / count);
  for (const SegmentMetrics& segment : segmentMetrics(segments, samples, settle, window)) {
    metrics.overshoot = std::max(metrics.overshoot, segment.overshoot);
    if (!segment.has_converged) continue;
    const bool is_loiter = segment.segment + 1 == static_cast<int>(segments.size());
    (is_loiter ? metrics.loiter : metrics.converged) =
        std::max(is_loiter ? metrics.loiter : metrics.converged, segment.converged);
  }
  addJoining(segments, samples, metrics);
  return metrics;
}

}  // namespace polyfly
