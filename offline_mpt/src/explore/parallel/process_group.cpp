#include "offline_mpt/process_group.hpp"

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>

#include "explore/parallel/compute_regions.hpp"
#include "explore/parallel/group_message.hpp"
#include "explore/parallel/result_message.hpp"
#include "explore/parallel/worker_pool.hpp"
#include "explore/state/checkpoint.hpp"
#include "polyfly_base/error.hpp"
#include "program/slater_point.hpp"

namespace polyfly {
namespace {

constexpr int kLeader = 0;

/// A batch whose sets lie in a message.
struct RemoteBatch : Batch<RegionResult> {
  std::vector<std::uint16_t> rows;
};

/// What process 0 asked for and what is answered.
class RemoteQueue : public WorkQueue<RegionResult> {
 public:
  Batch<RegionResult>* pop() override {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return ended_ || !asked_.empty(); });
    if (ended_) return nullptr;
    at_work_.push_back(std::move(asked_.front()));
    asked_.pop_front();
    return at_work_.back().get();
  }

  void push(Batch<RegionResult>* batch) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (auto& mine : at_work_) {
      if (mine.get() != batch) continue;
      answered_.push_back(std::move(mine));
      mine = std::move(at_work_.back());
      at_work_.pop_back();
      return;
    }
  }

  void abort(std::exception_ptr error) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!error_) error_ = std::move(error);
    ended_ = true;
    changed_.notify_all();
  }

  void end() { abort(nullptr); }

  void ask(std::unique_ptr<RemoteBatch> batch) {
    const std::lock_guard<std::mutex> lock(mutex_);
    asked_.push_back(std::move(batch));
    changed_.notify_one();
  }

  std::unique_ptr<RemoteBatch> answer() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (answered_.empty()) return nullptr;
    auto batch = std::move(answered_.front());
    answered_.pop_front();
    return batch;
  }

  /// Throws what abort() was given; true after the end.
  bool ended() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (error_) std::rethrow_exception(error_);
    return ended_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::unique_ptr<RemoteBatch>> asked_;
  std::vector<std::unique_ptr<RemoteBatch>> at_work_;
  std::deque<std::unique_ptr<RemoteBatch>> answered_;
  bool ended_ = false;
  std::exception_ptr error_;
};

std::unique_ptr<RemoteBatch> readBatch(ByteReader& in) {
  auto batch = std::make_unique<RemoteBatch>();
  batch->number = in.get<std::uint64_t>();
  const auto count = in.get<std::uint32_t>();
  in.need(count, sizeof(std::uint16_t));
  std::vector<std::size_t> sizes(count);
  batch->rows.resize(in.left() / sizeof(std::uint16_t));
  std::size_t used = 0;
  for (std::size_t& size : sizes) {
    size = in.get<std::uint16_t>();
    in.getArray(batch->rows.data() + used, size);
    used += size;
  }
  used = 0;
  for (const std::size_t size : sizes) {
    batch->sets.push_back({batch->rows.data() + used, size});
    used += size;
  }
  batch->fitResults();
  return batch;
}

/// The messages of a process that assists.
class Line {
 public:
  explicit Line(ProcessGroup& group) : group_(group) {}

  /// Whether process 0 has ended the exploration or the group, or fallen silent after it had spoken.
  bool over() const { return over_ || (heard_ && Clock::now() - last_heard_ > kHeartbeatTimeout); }

  /// Takes in all messages; those with work go to `remote` if there is one. False when there was none.
  bool listen(RemoteQueue* remote) {
    bool any = false;
    int from = 0;
    std::vector<std::byte> message;
    while (!over_ && group_.receive(from, message)) {
      any = heard_ = true;
      last_heard_ = Clock::now();
      ByteReader in(message.data(), message.size(), "message of process 0");
      const auto kind = in.get<GroupMessage>();
      over_ = kind == GroupMessage::kExplored || kind == GroupMessage::kEnd;
      if (kind == GroupMessage::kBatch && remote != nullptr) remote->ask(readBatch(in));
    }
    const Clock::time_point now = Clock::now();
    if (now >= next_sign_) {
      next_sign_ = now + kHeartbeatPeriod;
      group_.send(kLeader, groupMessage(GroupMessage::kHeartbeat));
    }
    return any;
  }

 private:
  using Clock = std::chrono::steady_clock;
  ProcessGroup& group_;
  bool over_ = false;
  bool heard_ = false;
  Clock::time_point last_heard_;
  Clock::time_point next_sign_ = Clock::now() + kHeartbeatPeriod;
};

bool sendAnswers(RemoteQueue& remote, ProcessGroup& group) {
  bool any = false;
  while (const auto batch = remote.answer()) {
    std::vector<std::byte> message = groupMessage(GroupMessage::kAnswers);
    ByteWriter out(message);
    out.put(batch->number);
    for (std::size_t k = 0; k < batch->sets.size(); ++k) writeResult(batch->results[k], out);
    group.send(kLeader, std::move(message));
    any = true;
  }
  return any;
}

// The messages have a thread of their own while the pool describes.
void exchange(RemoteQueue& remote, Line& line, ProcessGroup& group) {
  try {
    while (!line.over() && !remote.ended()) {
      const bool heard = line.listen(&remote);
      if (!sendAnswers(remote, group) && !heard) std::this_thread::sleep_for(kPollPeriod);
    }
    remote.end();
  } catch (const std::exception& error) {
    remote.end();
    reportFailure(error.what(), group);
  }
}

void assist(const NormalisedProgram& program, std::uint64_t key, const ExploreOptions& options,
            ProcessGroup& group) {
  std::vector<std::byte> hello = groupMessage(GroupMessage::kJoin);
  ByteWriter out(hello);
  out.put(static_cast<std::uint32_t>(workerCount(options)));
  out.put(key);
  group.send(kLeader, std::move(hello));
  RemoteQueue remote;
  Line line(group);
  std::thread messages([&] { exchange(remote, line, group); });
  runWorkers<RegionResult>(workerCount(options), remote,
                           [&](WorkQueue<RegionResult>& queue) { computeRegions(program, options, queue); });
  messages.join();
}

}  // namespace

void ProcessGroup::shutDown() {
  if (shut_down_) return;
  shut_down_ = true;
  for (int rank = 1; rank < size(); ++rank) send(rank, groupMessage(GroupMessage::kEnd));
}

void reportFailure(const std::string& reason, ProcessGroup& group) {
  std::vector<std::byte> message = groupMessage(GroupMessage::kFailure);
  ByteWriter(message).putArray(reason.data(), reason.size());
  group.send(kLeader, std::move(message));
  Line line(group);
  while (!line.over()) {
    if (!line.listen(nullptr)) std::this_thread::sleep_for(kPollPeriod);
  }
}

void runWorkerProcess(const ParametricProgram& program, const ExploreOptions& options, ProcessGroup& group) {
  try {
    checkProgram(program);
    ParametricProgram explicit_equalities = program;
    if (!findSlaterPoint(explicit_equalities).feasible) throw Error("finds no solution");
    const NormalisedProgram scaled = normalise(explicit_equalities);
    assist(scaled, fingerprint(program, options), options, group);
  } catch (const std::exception& error) {
    reportFailure(error.what(), group);
  }
}

}  // namespace polyfly
