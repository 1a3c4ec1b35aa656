#include "offline_mpt/process_group.hpp"

#include "explore/parallel/group_message.hpp"
#include "explore/parallel/region_round.hpp"
#include "explore/state/checkpoint.hpp"
#include "polyfly_base/error.hpp"
#include "program/slater_point.hpp"

namespace polyfly {

void ProcessGroup::shutDown() {
  if (shut_down_) return;
  shut_down_ = true;
  for (int rank = 1; rank < size(); ++rank) send(rank, groupMessage(GroupMessage::kEnd));
}

void reportFailure(const std::string& reason, ProcessGroup& group) {
  std::vector<std::byte> message = groupMessage(GroupMessage::kFailure);
  ByteWriter(message).putArray(reason.data(), reason.size());
  group.send(0, std::move(message));
  while (const auto task = GroupExchange::task(group)) {
    if (task->empty()) return;
  }
}

void runWorkerProcess(const ParametricProgram& program, const ExploreOptions& options, ProcessGroup& group) {
  try {
    checkProgram(program);
    ParametricProgram explicit_equalities = program;
    if (!findSlaterPoint(explicit_equalities).feasible) throw Error("finds no solution");
    const NormalisedProgram scaled = normalise(explicit_equalities);
    RegionThreads threads(scaled, options);
    assistRounds(scaled, fingerprint(program, options), threads, group);
  } catch (const std::exception& error) {
    reportFailure(error.what(), group);
  }
}

}  // namespace polyfly
