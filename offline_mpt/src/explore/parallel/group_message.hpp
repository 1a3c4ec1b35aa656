#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "support/byte_stream.hpp"

namespace polyfly {

/// The first byte of a message between the processes of a group.
enum class GroupMessage : std::uint8_t {
  /// To process 0: a text.
  kFailure,
  /// From process 0: what is to be computed.
  kTask,
  /// Both ways: contributions.
  kRound,
  /// From process 0: there is nothing more to do.
  kEnd,
};

// Time between two polls for messages.
constexpr auto kPollPeriod = std::chrono::microseconds(100);

inline std::vector<std::byte> groupMessage(GroupMessage kind) { return {static_cast<std::byte>(kind)}; }

}  // namespace polyfly
