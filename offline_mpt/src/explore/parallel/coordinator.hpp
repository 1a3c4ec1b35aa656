#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <thread>
#include <vector>

#include "explore/parallel/scheduler.hpp"
#include "explore/region/compute_region.hpp"
#include "offline_mpt/process_group.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// Process 0's side of a group: a thread that sends batches to the other processes and merges their answers.
class Coordinator {
 public:
  Coordinator(ProcessGroup& group, const NormalisedProgram& program, std::uint64_t fingerprint,
              Scheduler<RegionResult>& scheduler);
  Coordinator(const Coordinator&) = delete;
  Coordinator& operator=(const Coordinator&) = delete;
  ~Coordinator();

  /// After the scheduler has ended: ends the other processes. Returns the rank of a lost process, or 0.
  int finish();

 private:
  using Clock = std::chrono::steady_clock;

  struct RankState {
    std::size_t threads = 0;                   // 0: has not joined
    std::deque<Batch<RegionResult>*> working;  // with it, in the order in which they were sent
    std::deque<Batch<RegionResult>*> back;     // answered, not yet given back
    Clock::time_point heard;
  };

  void run();
  bool receiveAll();
  void receive(int from, const std::vector<std::byte>& message);
  bool sendBatches();
  bool mergeAnswers();
  void sendHeartbeats();
  void findLostRanks();

  ProcessGroup& group_;
  const NormalisedProgram& program_;
  const std::uint64_t fingerprint_;
  Scheduler<RegionResult>& scheduler_;
  std::vector<RankState> ranks_;
  Clock::time_point next_sign_;
  Clock::time_point next_check_;
  int lost_ = 0;
  std::thread thread_;
};

/// The executor of a group: runs `loop` on `threads` threads of this process while the others examine batches, too.
/// Returns the rank of a lost process, or 0.
int runWithGroup(ProcessGroup& group, const NormalisedProgram& program, std::uint64_t fingerprint,
                 int threads, Scheduler<RegionResult>& scheduler,
                 const std::function<void(WorkQueue<RegionResult>&)>& loop);

}  // namespace polyfly
