#pragma once

#include <string>

#include "polyfly_base/range.hpp"

namespace polyfly_ros {

/// What the operating system does for the control thread.
struct RealTimeOptions {
  /// Priority of SCHED_FIFO; 0 or -1: not real-time.
  int priority = 0;
  /// The only processor on which the thread runs; -1: any.
  int core = -1;
  /// Whether the whole process is kept in memory.
  bool lock_memory = false;
};

template <class Options, class Visit>
void visitRealTimeOptions(Options& options, Visit&& visit) {
  visit("real_time/priority", options.priority, "of SCHED_FIFO", polyfly::Range{-1.0, 99.0});
  visit("real_time/core", options.core, "", polyfly::Range{-1.0, 1023.0});
  visit("real_time/lock_memory", options.lock_memory);
}

/// Whether odometry is answered in the thread that brings it (IN_FLIGHT.md). `answer` is the value of
/// real_time/answer: publisher, thread (the control thread), or auto. With auto it is the publisher's thread,
/// unless an option asks something of the control thread. Throws Error naming the option.
bool answersInPublisher(const std::string& answer, const RealTimeOptions& options);

/// Asks for the options on behalf of the calling thread. Returns one sentence for each that was not permitted,
/// with what would permit it; empty when all were granted.
std::string becomeRealTime(const RealTimeOptions& options);

}  // namespace polyfly_ros
