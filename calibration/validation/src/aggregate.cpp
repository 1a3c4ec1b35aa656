#include <cmath>
#include <filesystem>

#include "difference_collector.hpp"
#include "validation/validation.hpp"

namespace polyfly {
namespace {

// Root mean square and greatest of two sets of samples.
Difference joined(const Difference& one, std::size_t ones, const Difference& other, std::size_t others) {
  Difference result = one.max >= other.max || std::isnan(one.max) ? one : other;
  result.max = worse(one.max, other.max);
  const double count = static_cast<double>(ones + others);
  const double squares =
      one.rms * one.rms * static_cast<double>(ones) + other.rms * other.rms * static_cast<double>(others);
  result.rms = count > 0.0 ? std::sqrt(squares / count) : 0.0;
  return result;
}

template <class Part>
void append(std::vector<Part>* all, const std::vector<Part>& more) {
  all->insert(all->end(), more.begin(), more.end());
}

void add(const AxisValidation& other, AxisValidation* axis) {
  axis->tracking = joined(axis->tracking, axis->samples, other.tracking, other.samples);
  axis->MapUse::add(other);
  append(&axis->excursions, other.excursions);
  axis->qp = joined(axis->qp, axis->qp_compared, other.qp, other.qp_compared);
  axis->qp_compared += other.qp_compared;
  axis->qp_failures += other.qp_failures;
  append(&axis->qp_series, other.qp_series);
  append(&axis->edge_series, other.edge_series);
  append(&axis->lookups.in_order, other.lookups.in_order);
  append(&axis->lookups.shuffled, other.lookups.shuffled);
  axis->lookup_ns = percentiles(axis->lookups.in_order);
  axis->lookup_shuffled_ns = percentiles(axis->lookups.shuffled);
}

void add(const CommandValidation& other, CommandValidation* commands) {
  for (std::size_t entry = 0; entry < commands->difference.size(); ++entry) {
    commands->difference[entry] =
        joined(commands->difference[entry], commands->compared, other.difference[entry], other.compared);
  }
  commands->recorded += other.recorded;
  commands->compared += other.compared;
  commands->unmatched += other.unmatched;
  commands->unanswered += other.unanswered;
  commands->max_difference = worse(commands->max_difference, other.max_difference);
  commands->angle_violations += other.angle_violations;
  commands->thrust_violations += other.thrust_violations;
  commands->yaw_rate_violations += other.yaw_rate_violations;
  commands->not_finite += other.not_finite;
}

// The slower flight's times stand for both.
void add(const StatusValidation& other, StatusValidation* statuses) {
  for (std::size_t status = 0; status < statuses->replayed.size(); ++status) {
    statuses->replayed[status] += other.replayed[status];
    statuses->recorded[status] += other.recorded[status];
  }
  statuses->compared += other.compared;
  statuses->differing += other.differing;
  statuses->max_theta_difference = worse(statuses->max_theta_difference, other.max_theta_difference);
  if (other.step_ns.p99 > statuses->step_ns.p99) statuses->step_ns = other.step_ns;
}

void add(const MapComparison& other, MapComparison* comparison) {
  const std::size_t inside = comparison->use.inside;
  comparison->qp = joined(comparison->qp, inside, other.qp, other.use.inside);
  comparison->difference = joined(comparison->difference, comparison->both, other.difference, other.both);
  comparison->use.add(other.use);
  comparison->both += other.both;
  comparison->only_flown += other.only_flown;
  comparison->only_other += other.only_other;
  comparison->qp_failures += other.qp_failures;
  if (other.lookup_ns.p50 > comparison->lookup_ns.p50) comparison->lookup_ns = other.lookup_ns;
}

void add(const ValidationReport& other, ValidationReport* all) {
  all->tracking = joined(all->tracking, all->tracked_samples, other.tracking, other.tracked_samples);
  all->share = all->share && other.share ? std::optional(together(*all->share, *other.share)) : std::nullopt;
  all->samples += other.samples;
  all->tracked_samples += other.tracked_samples;
  all->outside_map_samples += other.outside_map_samples;
  all->outside_map_time += other.outside_map_time;
  all->duration += other.duration;
  all->top_speed = std::max(all->top_speed, other.top_speed);
  for (std::size_t axis = 0; axis < all->axes.size(); ++axis) add(other.axes[axis], &all->axes[axis]);
  add(other.commands, &all->commands);
  add(other.statuses, &all->statuses);
  append(&all->incomparable, other.incomparable);
  for (std::size_t index = 0; index < all->comparisons.size(); ++index) {
    add(other.comparisons.at(index), &all->comparisons[index]);
  }
}

}  // namespace

ValidationReport together(const std::vector<ValidationReport>& flights) {
  ValidationReport all = flights.front();
  if (flights.size() == 1) return all;
  for (std::size_t flight = 1; flight < flights.size(); ++flight) add(flights[flight], &all);
  all.warnings.clear();
  all.broken.clear();
  for (const ValidationReport& flight : flights) {
    const std::string name = std::filesystem::path(flight.source).filename().string();
    for (const std::string& sentence : flight.warnings) all.warnings.push_back(name + ": " + sentence);
    for (const std::string& sentence : flight.broken) all.broken.push_back(name + ": " + sentence);
  }
  all.source = std::to_string(flights.size()) + " flights";
  all.hold.reset();
  all.coverage = all.tracked_samples == 0 ? 0.0
                                          : 1.0 - static_cast<double>(all.outside_map_samples) /
                                                      static_cast<double>(all.tracked_samples);
  std::vector<double> lookups;
  for (const AxisValidation& axis : all.axes) append(&lookups, axis.lookups.in_order);
  all.lookup_ns = percentiles(lookups);
  return all;
}

}  // namespace polyfly
