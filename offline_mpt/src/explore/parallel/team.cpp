#include "offline_mpt/team.hpp"

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>

#include "explore/parallel/crew.hpp"
#include "explore/parallel/team_message.hpp"
#include "explore/state/checkpoint.hpp"
#include "polyfly_base/error.hpp"
#include "program/margin.hpp"

namespace polyfly {
namespace {

constexpr int kLeader = 0;

/// A chunk whose sets lie in a message.
struct RemoteChunk : Chunk {
  std::vector<std::uint16_t> rows;
};

/// What process 0 asked for and what is answered.
class Assistant : public Desk {
 public:
  Chunk* take() override {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return ended_ || !asked_.empty(); });
    if (ended_) return nullptr;
    at_work_.push_back(std::move(asked_.front()));
    asked_.pop_front();
    return at_work_.back().get();
  }

  void give(Chunk* chunk) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (auto& mine : at_work_) {
      if (mine.get() != chunk) continue;
      answered_.push_back(std::move(mine));
      mine = std::move(at_work_.back());
      at_work_.pop_back();
      return;
    }
  }

  void fail(std::exception_ptr error) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!error_) error_ = std::move(error);
    ended_ = true;
    changed_.notify_all();
  }

  void end() { fail(nullptr); }

  void ask(std::unique_ptr<RemoteChunk> chunk) {
    const std::lock_guard<std::mutex> lock(mutex_);
    asked_.push_back(std::move(chunk));
    changed_.notify_one();
  }

  std::unique_ptr<RemoteChunk> answer() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (answered_.empty()) return nullptr;
    auto chunk = std::move(answered_.front());
    answered_.pop_front();
    return chunk;
  }

  /// Throws what fail() was given; true after the end.
  bool ended() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (error_) std::rethrow_exception(error_);
    return ended_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::unique_ptr<RemoteChunk>> asked_;
  std::vector<std::unique_ptr<RemoteChunk>> at_work_;
  std::deque<std::unique_ptr<RemoteChunk>> answered_;
  bool ended_ = false;
  std::exception_ptr error_;
};

std::unique_ptr<RemoteChunk> readChunk(ByteReader& in) {
  auto chunk = std::make_unique<RemoteChunk>();
  chunk->number = in.get<std::uint64_t>();
  const auto count = in.get<std::uint32_t>();
  in.need(count, sizeof(std::uint16_t));
  std::vector<std::size_t> sizes(count);
  chunk->rows.resize(in.left() / sizeof(std::uint16_t));
  std::size_t used = 0;
  for (std::size_t& size : sizes) {
    size = in.get<std::uint16_t>();
    in.getArray(chunk->rows.data() + used, size);
    used += size;
  }
  used = 0;
  for (const std::size_t size : sizes) {
    chunk->sets.push_back({chunk->rows.data() + used, size});
    used += size;
  }
  return chunk;
}

/// The messages of a process that assists.
class Line {
 public:
  explicit Line(Team& team) : team_(team) {}

  /// Whether process 0 has dismissed the team, or fallen silent after it had spoken.
  bool over() const { return over_ || (heard_ && Clock::now() - last_heard_ > kTeamSilence); }

  /// Takes in all messages; those with work go to `assistant` if there is one. False when there was none.
  bool listen(Assistant* assistant) {
    bool any = false;
    int from = 0;
    std::vector<std::byte> message;
    while (!over_ && team_.receive(from, message)) {
      any = heard_ = true;
      last_heard_ = Clock::now();
      ByteReader in(message.data(), message.size(), "message of process 0");
      const auto kind = in.get<TeamMessage>();
      if (kind == TeamMessage::kEnd) over_ = true;
      if (kind == TeamMessage::kChunk && assistant != nullptr) assistant->ask(readChunk(in));
    }
    const Clock::time_point now = Clock::now();
    if (now >= next_sign_) {
      next_sign_ = now + kTeamAlive;
      team_.send(kLeader, teamMessage(TeamMessage::kAlive));
    }
    return any;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Team& team_;
  bool over_ = false;
  bool heard_ = false;
  Clock::time_point last_heard_;
  Clock::time_point next_sign_ = Clock::now() + kTeamAlive;
};

bool sendAnswers(Assistant& assistant, Team& team) {
  bool any = false;
  while (const auto chunk = assistant.answer()) {
    std::vector<std::byte> message = teamMessage(TeamMessage::kAnswers);
    ByteWriter out(message);
    out.put(chunk->number);
    out.putArray(chunk->answers.data(), chunk->answers.size());
    team.send(kLeader, std::move(message));
    any = true;
  }
  return any;
}

// The messages have a thread of their own while the crew describes.
void exchange(Assistant& assistant, Team& team) {
  Line line(team);
  try {
    while (!line.over() && !assistant.ended()) {
      const bool heard = line.listen(&assistant);
      if (!sendAnswers(assistant, team) && !heard) std::this_thread::sleep_for(kTeamPause);
    }
    assistant.end();
  } catch (const std::exception& error) {
    assistant.end();
    declineExploration(error.what(), team);
  }
}

void assist(const LeastDistance& program, std::uint64_t key, const ExploreOptions& options, Team& team) {
  std::vector<std::byte> hello = teamMessage(TeamMessage::kHello);
  ByteWriter out(hello);
  out.put(static_cast<std::uint32_t>(crewSize(options)));
  out.put(key);
  team.send(kLeader, std::move(hello));
  Assistant assistant;
  std::thread messages([&] { exchange(assistant, team); });
  runCrew(regionDescribers(program, options), crewSize(options), assistant);
  messages.join();
}

}  // namespace

void Team::dismiss() {
  if (dismissed_) return;
  dismissed_ = true;
  for (int rank = 1; rank < size(); ++rank) send(rank, teamMessage(TeamMessage::kEnd));
}

void declineExploration(const std::string& reason, Team& team) {
  std::vector<std::byte> message = teamMessage(TeamMessage::kDecline);
  ByteWriter(message).putArray(reason.data(), reason.size());
  team.send(kLeader, std::move(message));
  Line line(team);
  while (!line.over()) {
    if (!line.listen(nullptr)) std::this_thread::sleep_for(kTeamPause);
  }
}

void assistExploration(const ParametricProgram& program, const ExploreOptions& options, Team& team) {
  try {
    checkProgram(program);
    ParametricProgram explicit_equalities = program;
    if (!findMargin(explicit_equalities).feasible) return declineExploration("finds no solution", team);
    const LeastDistance scaled = toLeastDistance(explicit_equalities);
    assist(scaled, fingerprint(program, options), options, team);
  } catch (const Error& error) {
    declineExploration(error.what(), team);
  }
}

}  // namespace polyfly
