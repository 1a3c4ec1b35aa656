#pragma once

#include <string>

#include "online_controller/types/node_options.hpp"

namespace polyfly_ros {

using polyfly::RealTimeOptions;

/// Whether odometry is answered in the thread that brings it (IN_FLIGHT.md). `answer` is the value of
/// real_time/answer: publisher, thread (the control thread), or auto. With auto it is the publisher's thread,
/// unless an option asks something of the control thread. Throws Error naming the option.
bool answersInPublisher(const std::string& answer, const RealTimeOptions& options);

/// Asks for the options on behalf of the calling thread. Returns one sentence for each that was not permitted,
/// with what would permit it; empty when all were granted.
std::string becomeRealTime(const RealTimeOptions& options);

}  // namespace polyfly_ros
