#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/explore.hpp"

namespace polyfly {

/// Transport between processes that work together, numbered from 0. Process 0 explores with ExploreOptions::group set
/// and has the result; the others call runWorkerProcess. The library
/// itself does not depend on MPI. Not thread-safe.
class ProcessGroup {
 public:
  virtual ~ProcessGroup() = default;

  virtual int rank() const = 0;
  virtual int size() const = 0;

  /// Sends a message without waiting for the other side. Messages between two processes keep their order.
  virtual void send(int to, std::vector<std::byte> message) = 0;

  /// The next message that has come in; false when there is none.
  virtual bool receive(int& from, std::vector<std::byte>& message) = 0;

  /// Whether a process is known to have ended. False says nothing.
  virtual bool lost(int rank) = 0;

  /// Tells all others, once, that there is nothing more to do. For process 0.
  void shutDown();

 private:
  bool shut_down_ = false;
};

/// Thrown in process 0 where another one has ended before its time.
class LostProcess : public std::runtime_error {
 public:
  explicit LostProcess(int rank)
      : std::runtime_error("process " + std::to_string(rank) + " was lost"), rank_(rank) {}
  int rank() const { return rank_; }

 private:
  int rank_;
};

/// Processes active sets for process 0 on options.threads threads. Returns when process 0 ends the exploration or the
/// group, or is lost. Limits, checkpoint and progress belong to process 0. A bad problem is reported to
/// process 0, whose exploration then throws.
void runWorkerProcess(const ParametricProgram& program, const ExploreOptions& options, ProcessGroup& group);

/// For all processes, before they work together: waits for all, and throws Error in each unless all have read the same.
/// `read` says what this process has read, or why it could not. The error names each text and who told it. Throws
/// LostProcess in process 0. Throws Error in another process where process 0 has ended the group.
void requireSameInput(const std::string& read, ProcessGroup& group);

/// For a process that cannot take part: the exploration of process 0 throws Error with this text and this
/// process's rank. Returns when process 0 ends the exploration or the group.
void reportFailure(const std::string& reason, ProcessGroup& group);

}  // namespace polyfly
