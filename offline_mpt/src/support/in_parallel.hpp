#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace polyfly {

/// Runs work(thread, i) for i = 0 .. count - 1, each once, in any order on any of the threads. `progress` is
/// called now and then from the calling thread. False when stopped before the end. Rethrows what `work`
/// throws. Where no further thread can be had, those that started do the work, or the calling one.
inline bool inParallel(std::uint64_t count, int threads, const std::atomic<bool>* stop,
                       const std::function<void(std::uint64_t, std::uint64_t)>& progress,
                       const std::function<void(std::size_t, std::uint64_t)>& work) {
  constexpr std::chrono::milliseconds kProgressPeriod(100);
  std::atomic<std::uint64_t> next{0}, done{0};
  std::mutex mutex;
  std::condition_variable ended;
  std::exception_ptr failure;
  const auto amount = static_cast<std::size_t>(threads < 1 ? 1 : threads > 256 ? 256 : threads);
  std::size_t running = amount;
  const auto run = [&](std::size_t thread) {
    try {
      while (stop == nullptr || !stop->load()) {
        const std::uint64_t i = next.fetch_add(1);
        if (i >= count) break;
        work(thread, i);
        done.fetch_add(1);
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex);
      if (!failure) failure = std::current_exception();
      next.store(count);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    --running;
    ended.notify_one();
  };
  std::vector<std::thread> workers;
  workers.reserve(amount);
  try {
    while (workers.size() < amount) workers.emplace_back(run, workers.size());
  } catch (...) {  // no memory for a further thread: fewer do the same
    const std::lock_guard<std::mutex> lock(mutex);
    running -= amount - std::max<std::size_t>(1, workers.size());
  }
  if (workers.empty()) run(0);
  for (bool all_ended = false; !all_ended;) {
    {
      std::unique_lock<std::mutex> lock(mutex);
      all_ended = ended.wait_for(lock, kProgressPeriod, [&] { return running == 0; });
    }
    if (progress) progress(done.load(), count);
  }
  for (std::thread& worker : workers) worker.join();
  if (failure) std::rethrow_exception(failure);
  return done.load() == count;
}

}  // namespace polyfly
