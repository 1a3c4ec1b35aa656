#pragma once

#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command.hpp"
#include "mpi_group.hpp"

namespace polyfly {

/// The other processes of an MPI launcher, if any. Whatever happens, they are shut down and waited for.
class MpiSession {
 public:
  MpiSession() : group_(joinGroup()) {}
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;
  ~MpiSession() { leave(); }

  /// CPU time of this process by phase, five at most [s]; after `leave` that of all.
  std::vector<double> cpu;

  /// Null where this process is alone.
  MpiGroup* group() const { return group_.get(); }
  int processes() const { return group_ ? group_->size() : 1; }
  bool leads() const { return !group_ || group_->rank() == 0; }

  /// What `read` returns. Its member `summary` tells what this process has read; where `read` throws, the error does.
  /// Throws Error in all processes where they differ in that.
  template <typename Read>
  auto readAlike(const Read& read) -> decltype(read()) {
    std::optional<decltype(read())> input;
    std::exception_ptr failure;
    std::string told;
    try {
      input.emplace(read());
      told = input->summary;
    } catch (const std::exception& error) {
      failure = std::current_exception();
      told = error.what();
    }
    if (group_) requireSameInput(told, *group_);
    if (failure) std::rethrow_exception(failure);
    alike_ = true;
    return std::move(*input);
  }

  /// For another process than 0: does its part. Process 0 says what went wrong, and its exit code is that of the job. An
  /// error code of this process would make the launcher end process 0 before it has spoken.
  template <typename Work>
  ExitCode assist(const Work& work) {
    try {
      work();
    } catch (const std::exception& error) {
      if (alike_) reportFailure(error.what(), *group_);  // otherwise process 0 knows
    }
    return ExitCode::kDone;
  }

  void leave() {
    if (!group_ || left_) return;
    left_ = true;
    if (leads()) group_->shutDown();
    // Also of a process that failed in between, the sum needs equally many numbers.
    constexpr std::size_t kMostPhases = 5;
    cpu.resize(kMostPhases);
    cpu = group_->leave(cpu);
  }

  /// One of them is lost: there is nothing to wait for.
  void abort() {
    left_ = true;
    group_->abort(static_cast<int>(ExitCode::kStopped));
  }

 private:
  std::unique_ptr<MpiGroup> group_;
  bool alike_ = false;
  bool left_ = false;
};

}  // namespace polyfly
