#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "offline_mpt/process_group.hpp"

namespace polyfly {

/// A computation that all processes of a group carry out alike, in rounds: in each, every process contributes bytes,
/// and all receive the contributions of all. So all take the same decisions.
class GroupExchange {
 public:
  /// Thrown in a process other than 0 where process 0 has ended the group, or is lost.
  struct Ended {};

  /// Null: this process alone. `group` must outlive the object.
  explicit GroupExchange(ProcessGroup* group) : group_(group) {}

  int rank() const { return group_ == nullptr ? 0 : group_->rank(); }
  int size() const { return group_ == nullptr ? 1 : group_->size(); }

  /// The contributions of all processes, by rank, in each of them. Waits for them. Throws LostProcess in process 0, or Error
  /// where another has reported a failure.
  std::vector<std::vector<std::byte>> round(std::vector<std::byte> mine);

  /// The same for process 0 alone, which waits for those that are `asked`, by rank. The others call contribute.
  std::vector<std::vector<std::byte>> gather(std::vector<std::byte> mine, const std::vector<char>& asked);
  void contribute(const std::vector<std::byte>& mine);
  std::vector<char> everyone() const { return std::vector<char>(static_cast<std::size_t>(size()), 1); }

  /// A round in which all tell what they read. Throws Error in each unless all texts are the same.
  void requireSame(const std::string& read);

  /// For process 0: hands a task to another one, which waits for it in `task`.
  void give(int to, const std::vector<std::byte>& task);

  /// For the others: the next task of process 0; none where it has ended the group.
  static std::optional<std::vector<std::byte>> task(ProcessGroup& group);

 private:
  ProcessGroup* group_;
};

}  // namespace polyfly
