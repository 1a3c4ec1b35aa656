#pragma once

#include <functional>
#include <memory>

#include "explore/parallel/scheduler.hpp"
#include "offline_mpt/explore_options.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// Number of worker threads: as asked for, at most the processors of the machine.
int workerCount(const ExploreOptions& options);

/// Processes active sets. Each thread has one.
class Worker {
 public:
  virtual ~Worker() = default;
  /// Appends the result for one active set, in the form that the queue of the set reads.
  virtual void answer(RowSpan set, ByteWriter& out) = 0;
};
using MakeWorker = std::function<std::unique_ptr<Worker>()>;

/// Makes workers whose results ExplorationState::merge reads.
MakeWorker regionWorkers(const NormalisedProgram& program, const ExploreOptions& options);

/// Processes batches of the queue until it is empty. Runs on `threads` threads, the calling one included; each
/// has its own worker.
void runWorkers(const MakeWorker& make, int threads, WorkQueue& queue);

}  // namespace polyfly
