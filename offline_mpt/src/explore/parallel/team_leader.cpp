#include "explore/parallel/team_leader.hpp"

#include <algorithm>
#include <string>

#include "explore/parallel/team_message.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kMostSets = 32;  // in a chunk for another process
constexpr std::size_t kAhead = 3;      // chunks with a process for each of its threads, so that none waits

std::string nameOf(int rank) { return "process " + std::to_string(rank); }

}  // namespace

TeamLeader::TeamLeader(Team& team, Dispatcher& dispatcher, std::uint64_t fingerprint)
    : team_(team),
      dispatcher_(dispatcher),
      fingerprint_(fingerprint),
      members_(static_cast<std::size_t>(team.size())),
      thread_([this] { run(); }) {}

TeamLeader::~TeamLeader() {
  dispatcher_.end(ExploreStatus::kInterrupted);
  if (thread_.joinable()) thread_.join();
}

int TeamLeader::finish() {
  thread_.join();
  return lost_;
}

void TeamLeader::run() {
  try {
    while (!dispatcher_.ended()) {
      bool busy = receiveAll();
      busy = giveBack() || busy;
      busy = handOut() || busy;
      stayInTouch();
      dispatcher_.look();
      if (!busy) std::this_thread::sleep_for(kTeamPause);
    }
    receiveAll();  // who cannot assist may say so last
    findLost();
    team_.dismiss();
  } catch (...) {
    dispatcher_.fail(std::current_exception());
  }
}

bool TeamLeader::receiveAll() {
  bool any = false;
  int from = 0;
  std::vector<std::byte> message;
  while (team_.receive(from, message)) {
    any = true;
    receive(from, message);
  }
  return any;
}

void TeamLeader::receive(int from, const std::vector<std::byte>& message) {
  Member& member = members_.at(static_cast<std::size_t>(from));
  member.heard = Clock::now();
  ByteReader in(message.data(), message.size(), "message of " + nameOf(from));
  switch (in.get<TeamMessage>()) {
    case TeamMessage::kHello:
      member.threads = in.get<std::uint32_t>();
      if (in.get<std::uint64_t>() != fingerprint_) throw Error(nameOf(from) + ": has read another problem");
      dispatcher_.addDescribers(static_cast<int>(kAhead * member.threads));
      break;
    case TeamMessage::kDecline:
      throw Error(nameOf(from) + ": " + std::string(reinterpret_cast<const char*>(in.next()), in.left()));
    case TeamMessage::kAnswers: {
      const auto number = in.get<std::uint64_t>();
      const auto chunk = std::find_if(member.working.begin(), member.working.end(),
                                      [number](const Chunk* c) { return c->number == number; });
      if (chunk == member.working.end()) throw Error(nameOf(from) + ": answers what it was not asked");
      (*chunk)->answers.assign(in.next(), in.next() + in.left());
      member.back.push_back(*chunk);
      member.working.erase(chunk);
      break;
    }
    case TeamMessage::kAlive:
      break;
    case TeamMessage::kChunk:
    case TeamMessage::kEnd:
      throw Error(nameOf(from) + ": speaks as if it led");
  }
}

bool TeamLeader::giveBack() {
  bool any = false;
  for (Member& member : members_) {
    while (!member.back.empty() && dispatcher_.tryGive(member.back.front())) {
      member.back.pop_front();
      any = true;
    }
  }
  return any;
}

bool TeamLeader::handOut() {
  bool any = false;
  for (int rank = 1; rank < team_.size(); ++rank) {
    Member& member = members_[static_cast<std::size_t>(rank)];
    while (member.working.size() + member.back.size() < kAhead * member.threads) {
      Chunk* const chunk = dispatcher_.tryTake(kMostSets);
      if (chunk == nullptr) return any;
      member.working.push_back(chunk);
      std::vector<std::byte> message = teamMessage(TeamMessage::kChunk);
      ByteWriter out(message);
      out.put(chunk->number);
      out.put(static_cast<std::uint32_t>(chunk->sets.size()));
      for (const RowSpan& set : chunk->sets) {
        out.put(static_cast<std::uint16_t>(set.count));
        out.putArray(set.rows, set.count);
      }
      team_.send(rank, std::move(message));
      any = true;
    }
  }
  return any;
}

void TeamLeader::stayInTouch() {
  const Clock::time_point now = Clock::now();
  if (now >= next_sign_) {
    next_sign_ = now + kTeamAlive;
    for (int rank = 1; rank < team_.size(); ++rank) team_.send(rank, teamMessage(TeamMessage::kAlive));
  }
  if (now < next_check_) return;
  next_check_ = now + kTeamCheck;
  findLost();
  if (lost_ > 0) dispatcher_.end(ExploreStatus::kInterrupted);
}

// A process may leave after it was dismissed only.
void TeamLeader::findLost() {
  const Clock::time_point now = Clock::now();
  for (int rank = 1; rank < team_.size() && lost_ == 0; ++rank) {
    const Member& member = members_[static_cast<std::size_t>(rank)];
    const bool silent = member.threads > 0 && now - member.heard > kTeamSilence;
    if (silent || team_.lost(rank)) lost_ = rank;
  }
}

}  // namespace polyfly
