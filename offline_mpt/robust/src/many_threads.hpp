#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace polyfly {

/// work(0) .. work(count - 1), each once, by up to `threads` threads. The first exception is thrown again.
template <typename Work>
void inManyThreads(std::size_t count, int threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex guard;
  const auto loop = [&] {
    try {
      for (std::size_t k = next++; k < count; k = next++) work(k);
    } catch (...) {
      const std::lock_guard<std::mutex> lock(guard);
      if (!failure) failure = std::current_exception();
      next = count;
    }
  };
  std::vector<std::thread> team;
  for (int t = 1; t < threads && static_cast<std::size_t>(t) < count; ++t) team.emplace_back(loop);
  loop();
  for (std::thread& member : team) member.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace polyfly
