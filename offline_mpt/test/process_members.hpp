#pragma once

#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "offline_mpt/process_group.hpp"

namespace polyfly {

/// What carries letters between the members.
struct Post {
  struct Letter {
    int from;
    std::vector<std::byte> message;
  };
  explicit Post(int size) : boxes(static_cast<std::size_t>(size)), dead(static_cast<std::size_t>(size)) {}
  std::mutex mutex;
  std::vector<std::deque<Letter>> boxes;
  std::vector<char> dead;
};

class Member : public ProcessGroup {
 public:
  Member(Post& post, int rank) : post_(post), rank_(rank) {}
  int rank() const override { return rank_; }
  int size() const override { return static_cast<int>(post_.boxes.size()); }
  void send(int to, std::vector<std::byte> message) override {
    const std::lock_guard<std::mutex> lock(post_.mutex);
    post_.boxes[static_cast<std::size_t>(to)].push_back({rank_, std::move(message)});
  }
  bool receive(int& from, std::vector<std::byte>& message) override {
    const std::lock_guard<std::mutex> lock(post_.mutex);
    auto& box = post_.boxes[static_cast<std::size_t>(rank_)];
    if (box.empty()) return false;
    from = box.front().from;
    message = std::move(box.front().message);
    box.pop_front();
    return true;
  }
  bool lost(int rank) override {
    const std::lock_guard<std::mutex> lock(post_.mutex);
    return post_.dead[static_cast<std::size_t>(rank)] != 0;
  }
  void die() {
    const std::lock_guard<std::mutex> lock(post_.mutex);
    post_.dead[static_cast<std::size_t>(rank_)] = 1;
  }

 private:
  Post& post_;
  int rank_;
};

using Part = std::function<void(Member&)>;

/// What `lead` returns as process 0 while the others play their parts. Rethrows what it throws.
template <typename Lead>
auto leadWith(const std::vector<Part>& parts, const Lead& lead) -> decltype(lead(std::declval<Member&>())) {
  Post post(static_cast<int>(parts.size()) + 1);
  std::vector<std::thread> others;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    others.emplace_back([&post, &parts, k] {
      Member member(post, static_cast<int>(k) + 1);
      parts[k](member);
    });
  }
  Member leader(post, 0);
  decltype(lead(leader)) result;
  std::exception_ptr error;
  try {
    result = lead(leader);
  } catch (const std::exception&) {
    error = std::current_exception();
  }
  leader.shutDown();
  for (std::thread& other : others) other.join();
  if (error) std::rethrow_exception(error);
  return result;
}

}  // namespace polyfly
