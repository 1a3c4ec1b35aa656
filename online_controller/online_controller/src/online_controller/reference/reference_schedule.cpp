#include "online_controller/reference/reference_schedule.hpp"

#include <string>
#include <utility>

#include "polyfly_base/error.hpp"

namespace polyfly {

ReferenceSchedule::ReferenceSchedule() {
  for (Entry& entry : entries_) entry.trajectory.becomePose(Eigen::Vector3d::Zero(), 0.0);  // room for hold()
}

// What is over moves behind; its memory is used by what comes next.
void ReferenceSchedule::compact() {
  for (std::size_t i = 0; i < count_ && first_ > 0; ++i) std::swap(entries_[i], entries_[first_ + i]);
  first_ = 0;
  for (std::size_t i = count_; i < entries_.size(); ++i) {
    if (entries_[i].trajectory.samples().size() > 1)
      entries_[i].trajectory = ReferenceTrajectory::pose(Eigen::Vector3d::Zero(), 0.0);
  }
}

void ReferenceSchedule::set(ReferenceTrajectory trajectory, std::optional<double> start) {
  if (trajectory.empty()) return;
  compact();
  if (!start) {
    // The trajectory in force goes on until the next sample.
    count_ = count_ > 0 ? 2 : 1;
    last() = {std::move(trajectory), start, !start};
    return;
  }
  const double begin = *start + trajectory.startTime();
  while (count_ > 0 && last().start && last().begin() >= begin) --count_;
  if (count_ == kMaxEntries) {
    throw Error("trajectory: at most " + std::to_string(kMaxEntries - 1) + " may wait for their start");
  }
  if (count_ > 0 && last().start && last().trajectory.samples().size() > 1) {
    const double offset = *start - *last().start;
    const double gap = begin - (*last().start + last().trajectory.endTime());
    if (gap >= ReferenceTrajectory::kLeastInterval && gap <= kJoin)
      last().trajectory = ReferenceTrajectory::joined(last().trajectory, trajectory, offset);
  }
  ++count_;
  last() = {std::move(trajectory), start, !start};
}

ReferenceExcess ReferenceSchedule::findExcess(const Eigen::Vector3d& vehicle,
                                              const ReferenceLimits& limits) const noexcept {
  ReferenceExcess found;
  for (std::size_t i = first_; i < first_ + count_ && found.limit == nullptr; ++i)
    found = polyfly::findExcess(entries_[i].trajectory, &vehicle, limits);
  return found;
}

void ReferenceSchedule::hold(const Eigen::Vector3d& position, double yaw) noexcept {
  first_ = 0;
  count_ = 1;
  active().trajectory.becomePose(position, yaw);
  active().start = 0.0;
  active().by_sample = false;
}

void ReferenceSchedule::advance(double time) noexcept {
  if (count_ == 1 && !active().start) active().start = time;
  while (count_ > 1) {
    Entry& next = entries_[first_ + 1];
    if (!next.start) next.start = time - next.trajectory.startTime();
    if (time < next.begin()) break;
    // The old trajectory is freed by a later call of set, not here.
    ++first_;
    --count_;
  }
}

void ReferenceSchedule::shift(double seconds) noexcept {
  for (std::size_t i = first_; i < first_ + count_; ++i) {
    if (entries_[i].by_sample && entries_[i].start) *entries_[i].start += seconds;
  }
}

std::optional<Reference> ReferenceSchedule::sample(double time) noexcept {
  if (count_ == 0) return std::nullopt;
  advance(time);
  return active().trajectory.sample(time - *active().start);
}

bool ReferenceSchedule::preview(double time, double period, int count, Reference* references) noexcept {
  if (count_ == 0) return false;
  advance(time);
  std::size_t entry = first_;
  for (int k = 0; k < count; ++k) {
    const double ahead = time + k * period;
    while (entry + 1 < first_ + count_) {
      const Entry& next = entries_[entry + 1];
      if (!next.start || ahead < next.begin()) break;
      ++entry;
    }
    references[k] = entries_[entry].trajectory.sample(ahead - *entries_[entry].start);
  }
  return true;
}

bool ReferenceSchedule::ended(double time) const noexcept {
  if (count_ != 1) return count_ == 0;
  const Entry& entry = entries_[first_];
  if (entry.trajectory.samples().size() < 2) return true;
  return entry.start && time > *entry.start + entry.trajectory.endTime();
}

}  // namespace polyfly
