#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "support/byte_stream.hpp"

namespace polyfly {

/// The first byte of a message between the processes of a team.
enum class TeamMessage : std::uint8_t {
  kHello,    ///< to process 0: threads, fingerprint of the program
  kDecline,  ///< to process 0: a text
  kChunk,    ///< from process 0: number, count, sets
  kAnswers,  ///< to process 0: number, what ExplorationState::merge reads
  kAlive,    ///< both ways, now and then
  kEnd,      ///< from process 0: nothing more to do
};

constexpr auto kTeamPause = std::chrono::microseconds(100);  // between two looks for messages
constexpr auto kTeamAlive = std::chrono::seconds(1);         // between two signs of life
constexpr auto kTeamCheck = std::chrono::milliseconds(50);   // between two looks whether all are there
constexpr auto kTeamSilence = std::chrono::seconds(60);      // without one, the other side is lost

inline std::vector<std::byte> teamMessage(TeamMessage kind) { return {static_cast<std::byte>(kind)}; }

}  // namespace polyfly
