#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <thread>
#include <vector>

#include "explore/parallel/dispatcher.hpp"
#include "offline_mpt/team.hpp"

namespace polyfly {

/// Process 0's side of a team: a thread that hands chunks to the other processes and gives their answers
/// back.
class TeamLeader {
 public:
  TeamLeader(Team& team, Dispatcher& dispatcher, std::uint64_t fingerprint);
  TeamLeader(const TeamLeader&) = delete;
  TeamLeader& operator=(const TeamLeader&) = delete;
  ~TeamLeader();

  /// When the dispatcher has ended: dismisses the team. The number of a process that was lost, or 0.
  int finish();

 private:
  using Clock = std::chrono::steady_clock;

  struct Member {
    std::size_t threads = 0;     // 0: has not said hello
    std::deque<Chunk*> working;  // with it, in the order in which they were sent
    std::deque<Chunk*> back;     // answered, not yet given back
    Clock::time_point heard;
  };

  void run();
  bool receiveAll();
  void receive(int from, const std::vector<std::byte>& message);
  bool handOut();
  bool giveBack();
  void stayInTouch();
  void findLost();

  Team& team_;
  Dispatcher& dispatcher_;
  const std::uint64_t fingerprint_;
  std::vector<Member> members_;
  Clock::time_point next_sign_;
  Clock::time_point next_check_;
  int lost_ = 0;
  std::thread thread_;
};

}  // namespace polyfly
