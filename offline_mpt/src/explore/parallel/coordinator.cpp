#include "explore/parallel/coordinator.hpp"

#include <algorithm>
#include <string>

#include "explore/parallel/group_message.hpp"
#include "explore/parallel/result_message.hpp"
#include "explore/parallel/worker_pool.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Sets in a batch for another process, at most.
constexpr std::size_t kMostSetsSent = 32;
// Batches that a process holds for each of its threads, so that no thread waits.
constexpr std::size_t kAhead = 3;

std::string nameOf(int rank) { return "process " + std::to_string(rank); }

}  // namespace

Coordinator::Coordinator(ProcessGroup& group, const NormalisedProgram& program, std::uint64_t fingerprint,
                         Scheduler<RegionResult>& scheduler)
    : group_(group),
      program_(program),
      fingerprint_(fingerprint),
      scheduler_(scheduler),
      ranks_(static_cast<std::size_t>(group.size())),
      thread_([this] { run(); }) {}

Coordinator::~Coordinator() {
  scheduler_.end(ExploreStatus::kInterrupted);
  if (thread_.joinable()) thread_.join();
}

int Coordinator::finish() {
  thread_.join();
  return lost_;
}

void Coordinator::run() {
  try {
    while (!scheduler_.ended()) {
      bool busy = receiveAll();
      busy = mergeAnswers() || busy;
      busy = sendBatches() || busy;
      sendHeartbeats();
      scheduler_.poll();
      if (!busy) std::this_thread::sleep_for(kPollPeriod);
    }
    receiveAll();  // who cannot assist may say so last
    findLostRanks();
    for (int rank = 1; rank < group_.size(); ++rank) group_.send(rank, groupMessage(GroupMessage::kExplored));
  } catch (...) {
    scheduler_.abort(std::current_exception());
  }
}

bool Coordinator::receiveAll() {
  bool any = false;
  int from = 0;
  std::vector<std::byte> message;
  while (group_.receive(from, message)) {
    any = true;
    receive(from, message);
  }
  return any;
}

void Coordinator::receive(int from, const std::vector<std::byte>& message) {
  RankState& member = ranks_.at(static_cast<std::size_t>(from));
  member.heard = Clock::now();
  ByteReader in(message.data(), message.size(), "message of " + nameOf(from));
  switch (in.get<GroupMessage>()) {
    case GroupMessage::kJoin:
      member.threads = in.get<std::uint32_t>();
      if (in.get<std::uint64_t>() != fingerprint_) throw Error(nameOf(from) + ": has read another problem");
      scheduler_.addWorkers(static_cast<int>(kAhead * member.threads));
      break;
    case GroupMessage::kFailure:
      throw Error(nameOf(from) + ": " + std::string(reinterpret_cast<const char*>(in.next()), in.left()));
    case GroupMessage::kAnswers: {
      const auto number = in.get<std::uint64_t>();
      const auto batch = std::find_if(member.working.begin(), member.working.end(),
                                      [number](const Batch<RegionResult>* c) { return c->number == number; });
      if (batch == member.working.end()) throw Error(nameOf(from) + ": answers what it was not asked");
      for (std::size_t k = 0; k < (*batch)->sets.size(); ++k) readResult(program_, in, (*batch)->results[k]);
      member.back.push_back(*batch);
      member.working.erase(batch);
      break;
    }
    case GroupMessage::kHeartbeat:
    case GroupMessage::kRound:
      break;
    case GroupMessage::kBatch:
    case GroupMessage::kExplored:
    case GroupMessage::kTask:
    case GroupMessage::kEnd:
      throw Error(nameOf(from) + ": speaks as if it led");
  }
}

bool Coordinator::mergeAnswers() {
  bool any = false;
  for (RankState& member : ranks_) {
    while (!member.back.empty() && scheduler_.tryPush(member.back.front())) {
      member.back.pop_front();
      any = true;
    }
  }
  return any;
}

bool Coordinator::sendBatches() {
  bool any = false;
  for (int rank = 1; rank < group_.size(); ++rank) {
    RankState& member = ranks_[static_cast<std::size_t>(rank)];
    while (member.working.size() + member.back.size() < kAhead * member.threads) {
      Batch<RegionResult>* const batch = scheduler_.tryPop(kMostSetsSent);
      if (batch == nullptr) return any;
      member.working.push_back(batch);
      std::vector<std::byte> message = groupMessage(GroupMessage::kBatch);
      ByteWriter out(message);
      out.put(batch->number);
      out.put(static_cast<std::uint32_t>(batch->sets.size()));
      for (const RowSpan& set : batch->sets) writeSet(set, out);
      group_.send(rank, std::move(message));
      any = true;
    }
  }
  return any;
}

void Coordinator::sendHeartbeats() {
  const Clock::time_point now = Clock::now();
  if (now >= next_sign_) {
    next_sign_ = now + kHeartbeatPeriod;
    for (int rank = 1; rank < group_.size(); ++rank)
      group_.send(rank, groupMessage(GroupMessage::kHeartbeat));
  }
  if (now < next_check_) return;
  next_check_ = now + kLossCheckPeriod;
  findLostRanks();
  if (lost_ > 0) scheduler_.end(ExploreStatus::kInterrupted);
}

// A process may leave after it was shut_down only.
void Coordinator::findLostRanks() {
  const Clock::time_point now = Clock::now();
  for (int rank = 1; rank < group_.size() && lost_ == 0; ++rank) {
    const RankState& member = ranks_[static_cast<std::size_t>(rank)];
    const bool silent = member.threads > 0 && now - member.heard > kHeartbeatTimeout;
    if (silent || group_.lost(rank)) lost_ = rank;
  }
}

int runWithGroup(ProcessGroup& group, const NormalisedProgram& program, std::uint64_t fingerprint,
                 int threads, Scheduler<RegionResult>& scheduler,
                 const std::function<void(WorkQueue<RegionResult>&)>& loop) {
  Coordinator coordinator(group, program, fingerprint, scheduler);
  runWorkers<RegionResult>(threads, scheduler, loop);
  return coordinator.finish();
}

}  // namespace polyfly
