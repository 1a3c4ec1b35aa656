#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/explore.hpp"

namespace polyfly {

/// Processes that explore together, numbered from 0. Process 0 leads: it explores with ExploreOptions::team
/// set and has the result; the others run assistExploration. What carries the messages is whoever implements
/// this: the library knows of no MPI. One thread at a time.
class Team {
 public:
  virtual ~Team() = default;

  virtual int rank() const = 0;
  virtual int size() const = 0;

  /// Sends a message without waiting for the other side. Messages between two processes keep their order.
  virtual void send(int to, std::vector<std::byte> message) = 0;

  /// The next message that has come in; false when there is none.
  virtual bool receive(int& from, std::vector<std::byte>& message) = 0;

  /// Whether a process is known to have ended. False says nothing.
  virtual bool lost(int rank) = 0;

  /// Tells all others, once, that there is nothing more to do. For process 0.
  void dismiss();

 private:
  bool dismissed_ = false;
};

/// Describes active sets for process 0, on options.threads threads, until that dismisses the team or falls
/// silent. Limits, checkpoint and progress are process 0's business. Does not throw for a bad problem: tells
/// process 0, whose exploration then throws.
void assistExploration(const ParametricProgram& program, const ExploreOptions& options, Team& team);

/// For a process that cannot assist: process 0's exploration throws Error with this text and the process's
/// number. Waits to be dismissed.
void declineExploration(const std::string& reason, Team& team);

}  // namespace polyfly
