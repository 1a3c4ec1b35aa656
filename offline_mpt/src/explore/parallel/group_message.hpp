#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "support/byte_stream.hpp"

namespace polyfly {

/// The first byte of a message between the processes of a group.
enum class GroupMessage : std::uint8_t {
  /// To process 0: threads, fingerprint of the program.
  kJoin,
  /// To process 0: a text.
  kFailure,
  /// From process 0: number, count, sets.
  kBatch,
  /// To process 0: number, then a result for each set (result_message.hpp).
  kAnswers,
  /// Both ways, periodically.
  kHeartbeat,
  /// From process 0: the exploration is over.
  kExplored,
  /// From process 0: another computation begins (group_exchange.hpp).
  kTask,
  /// Both ways: contributions to a round of it.
  kRound,
  /// From process 0: there is nothing more to do.
  kEnd,
};

// Time between two polls for messages.
constexpr auto kPollPeriod = std::chrono::microseconds(100);
// Time between two heartbeats.
constexpr auto kHeartbeatPeriod = std::chrono::seconds(1);
// Time between two checks for lost processes.
constexpr auto kLossCheckPeriod = std::chrono::milliseconds(50);
// A process is lost after this time without a heartbeat.
constexpr auto kHeartbeatTimeout = std::chrono::seconds(60);

inline std::vector<std::byte> groupMessage(GroupMessage kind) { return {static_cast<std::byte>(kind)}; }

}  // namespace polyfly
