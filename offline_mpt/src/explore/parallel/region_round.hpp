#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "explore/parallel/group_exchange.hpp"
#include "explore/region/compute_region.hpp"
#include "explore/sets/active_set_pool.hpp"
#include "offline_mpt/explore_options.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// The threads of this process that compute regions, each with a work space.
class RegionThreads {
 public:
  /// As many as ExploreOptions::threads, at most the processors of the machine.
  RegionThreads(const NormalisedProgram& program, const ExploreOptions& options);

  int count() const { return static_cast<int>(workspaces_.size()); }

  /// Calls work(workspace, i) once for i = 0 .. count - 1, in any order, on any thread. `progress`: see inParallel.
  void forEach(std::uint64_t count, const std::function<void(std::uint64_t, std::uint64_t)>& progress,
               const std::function<void(RegionWorkspace&, std::uint64_t)>& work);

 private:
  std::vector<std::unique_ptr<RegionWorkspace>> workspaces_;
};

/// Computes the regions of active sets by the threads of all processes, in rounds. A region depends on its set alone, so
/// nothing depends on the numbers of threads and processes but the time.
class RegionRound {
 public:
  /// For process 0. With ExploreOptions::group it waits until all others call assistRounds. Throws Error where one has read
  /// another problem or cannot take part, and LostProcess.
  RegionRound(const NormalisedProgram& program, const ExploreOptions& options, std::uint64_t fingerprint,
              RegionThreads& threads);
  RegionRound(const RegionRound&) = delete;
  RegionRound& operator=(const RegionRound&) = delete;
  /// Tells the others that there is no further round.
  ~RegionRound();

  /// Sets that keep all threads busy for a round.
  std::uint64_t size() const;

  /// Into results[k] that of set first + k, for k < count. Sets are left out once `isOver` says so. Returns how many results
  /// there are, from the first on. Throws LostProcess, or Error where another process fails.
  std::uint64_t compute(const ActiveSetPool& sets, std::uint32_t first, std::uint64_t count,
                        const std::function<bool()>& isOver, std::vector<RegionResult>& results);

 private:
  int processOf(std::uint64_t k) const { return slots_[k % slots_.size()]; }
  void give(int to, const ActiveSetPool& sets, std::uint32_t first, std::uint64_t count);

  const NormalisedProgram& program_;
  RegionThreads& threads_;
  GroupExchange exchange_;
  /// The process of each thread: sets go to them in turn.
  std::vector<int> slots_;
};

/// The part of another process than 0: computes its share of each round until process 0 ends the exploration or the group.
void assistRounds(const NormalisedProgram& program, std::uint64_t fingerprint, RegionThreads& threads,
                  ProcessGroup& group);

}  // namespace polyfly
