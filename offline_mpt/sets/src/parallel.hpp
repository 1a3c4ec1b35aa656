#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace polyfly {

/// Calls work(i) for i = 0 .. count - 1 on several threads; `progress` is called from the calling one. Ends
/// early when `stop` is set. The first exception is passed on.
template <typename Work>
void forEach(std::size_t count, int threads, const std::atomic<bool>* stop,
             const std::function<void(std::uint64_t)>& progress, const Work& work) {
  std::atomic<std::size_t> next{0}, done{0};
  std::atomic<bool> failed{false};
  std::exception_ptr error;
  std::mutex mutex;
  const auto run = [&](bool reports) {
    while (!failed && (stop == nullptr || !stop->load())) {
      const std::size_t index = next++;
      if (index >= count) return;
      try {
        work(index);
        const std::size_t finished = ++done;
        if (reports && progress) progress(finished);
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!failed.exchange(true)) error = std::current_exception();
      }
    }
  };
  std::vector<std::thread> helpers;
  const int extra = static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(threads), count)) - 1;
  for (int k = 0; k < extra; ++k) helpers.emplace_back(run, false);
  run(true);
  for (std::thread& helper : helpers) helper.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace polyfly
