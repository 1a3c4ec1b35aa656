#include "explore/parallel/group_exchange.hpp"

#include <algorithm>
#include <string>
#include <thread>
#include <utility>

#include "explore/parallel/group_message.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

std::vector<std::byte> messageOf(GroupMessage kind, const std::vector<std::byte>& content) {
  std::vector<std::byte> message(1 + content.size(), static_cast<std::byte>(kind));
  std::copy(content.begin(), content.end(), message.begin() + 1);
  return message;
}

/// "process 0, 2: TEXT; process 1: OTHER TEXT".
std::string differences(const std::vector<std::string>& texts) {
  struct Opinion {
    std::string text, ranks;
  };
  std::vector<Opinion> opinions;
  for (std::size_t rank = 0; rank < texts.size(); ++rank) {
    const auto same = std::find_if(opinions.begin(), opinions.end(),
                                   [&](const Opinion& one) { return one.text == texts[rank]; });
    if (same == opinions.end())
      opinions.push_back({texts[rank], std::to_string(rank)});
    else
      same->ranks += ", " + std::to_string(rank);
  }
  std::string result;
  for (const Opinion& one : opinions)
    result += (result.empty() ? "process " : "; process ") + one.ranks + ": " + one.text;
  return result;
}

/// The next message of process 0 of this kind, without its first byte. Others are left over from earlier work.
std::vector<std::byte> await(GroupMessage kind, ProcessGroup& group) {
  int from = 0;
  std::vector<std::byte> message;
  for (;;) {
    while (group.receive(from, message)) {
      const auto got = static_cast<GroupMessage>(message.at(0));
      if (got == GroupMessage::kEnd) throw GroupExchange::Ended();
      if (got == kind) return {message.begin() + 1, message.end()};
    }
    if (group.lost(0)) throw GroupExchange::Ended();
    std::this_thread::sleep_for(kPollPeriod);
  }
}

}  // namespace

std::vector<std::vector<std::byte>> GroupExchange::round(std::vector<std::byte> mine) {
  if (rank() == 0) {
    std::vector<std::vector<std::byte>> all = gather(std::move(mine), everyone());
    std::vector<std::byte> message = groupMessage(GroupMessage::kRound);
    ByteWriter out(message);
    for (const std::vector<std::byte>& one : all) {
      out.put(static_cast<std::uint64_t>(one.size()));
      out.putArray(one.data(), one.size());
    }
    for (int to = 1; to < size(); ++to) group_->send(to, message);
    return all;
  }
  contribute(mine);
  const std::vector<std::byte> message = await(GroupMessage::kRound, *group_);
  ByteReader in(message.data(), message.size(), "message of process 0");
  std::vector<std::vector<std::byte>> all(static_cast<std::size_t>(size()));
  for (std::vector<std::byte>& one : all) {
    const auto bytes = in.get<std::uint64_t>();
    in.need(bytes, 1);
    one.resize(bytes);
    in.getArray(one.data(), one.size());
  }
  return all;
}

std::vector<std::vector<std::byte>> GroupExchange::gather(std::vector<std::byte> mine,
                                                          const std::vector<char>& asked) {
  std::vector<std::vector<std::byte>> all(asked.size());
  std::vector<char> missing = asked;
  all.front() = std::move(mine);
  missing.front() = 0;
  int from = 0;
  std::vector<std::byte> message;
  for (;;) {
    while (size() > 1 && group_->receive(from, message)) {
      const auto got = static_cast<GroupMessage>(message.at(0));
      if (got == GroupMessage::kFailure) {
        throw Error("process " + std::to_string(from) + ": " +
                    std::string(reinterpret_cast<const char*>(message.data()) + 1, message.size() - 1));
      }
      all.at(static_cast<std::size_t>(from)).assign(message.begin() + 1, message.end());
      missing[static_cast<std::size_t>(from)] = 0;
    }
    if (std::find(missing.begin(), missing.end(), 1) == missing.end()) return all;
    for (int rank = 1; rank < size(); ++rank) {
      if (missing[static_cast<std::size_t>(rank)] != 0 && group_->lost(rank)) throw LostProcess(rank);
    }
    std::this_thread::sleep_for(kPollPeriod);
  }
}

void GroupExchange::contribute(const std::vector<std::byte>& mine) {
  group_->send(0, messageOf(GroupMessage::kRound, mine));
}

void GroupExchange::requireSame(const std::string& read) {
  std::vector<std::byte> mine;
  ByteWriter(mine).putArray(read.data(), read.size());
  std::vector<std::string> texts;
  for (const std::vector<std::byte>& one : round(std::move(mine)))
    texts.emplace_back(reinterpret_cast<const char*>(one.data()), one.size());
  if (std::any_of(texts.begin(), texts.end(), [&](const std::string& text) { return text != read; }))
    throw Error("the processes of the job have not read the same: " + differences(texts));
}

void GroupExchange::give(int to, const std::vector<std::byte>& task) {
  group_->send(to, messageOf(GroupMessage::kTask, task));
}

void requireSameInput(const std::string& read, ProcessGroup& group) {
  try {
    GroupExchange(&group).requireSame(read);
  } catch (const GroupExchange::Ended&) {
    throw Error("process 0 has ended the job");
  }
}

std::optional<std::vector<std::byte>> GroupExchange::task(ProcessGroup& group) {
  try {
    return await(GroupMessage::kTask, group);
  } catch (const Ended&) {
    return std::nullopt;
  }
}

}  // namespace polyfly
