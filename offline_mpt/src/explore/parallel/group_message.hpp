#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "support/byte_stream.hpp"

namespace polyfly {

/// The first byte of a message between the processes of a group.
enum class GroupMessage : std::uint8_t {
  kJoin,       ///< to process 0: threads, fingerprint of the program
  kFailure,    ///< to process 0: a text
  kBatch,      ///< from process 0: number, count, sets
  kAnswers,    ///< to process 0: number, what ExplorationState::merge reads
  kHeartbeat,  ///< both ways, periodically
  kEnd,        ///< from process 0: nothing more to do
};

constexpr auto kPollPeriod = std::chrono::microseconds(100);      // between two polls for messages
constexpr auto kHeartbeatPeriod = std::chrono::seconds(1);        // between two heartbeats
constexpr auto kLossCheckPeriod = std::chrono::milliseconds(50);  // between two checks for lost processes
constexpr auto kHeartbeatTimeout = std::chrono::seconds(60);      // without a heartbeat, a process is lost

inline std::vector<std::byte> groupMessage(GroupMessage kind) { return {static_cast<std::byte>(kind)}; }

}  // namespace polyfly
