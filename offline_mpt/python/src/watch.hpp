#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <string>
#include <utility>

#include "polyfly_base/error.hpp"

namespace polyfly::python {

/// Long work as Python sees it: shows progress, and ends the work on Ctrl-C or where showing fails.
class Watch {
 public:
  /// `progress`: None or False shows nothing, True rewrites a line on sys.stderr, anything else is called with a text.
  explicit Watch(pybind11::object progress);

  /// To be passed to the work.
  const std::atomic<bool>& stop() const noexcept { return stop_; }

  /// Called now and then by the thread that began the work, without Python's lock.
  void look(const std::string& text);

  /// Ends the line, and throws what ended the work. With Python's lock.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  void show(const std::string& text);

  pybind11::object progress_;
  bool on_terminal_ = false;
  bool line_is_open_ = false;
  Clock::time_point next_;
  std::atomic<bool> stop_{false};
  std::exception_ptr failure_;
};

/// What `work(watch)` returns, run without Python's lock. An exception of Python that ended it comes before its own.
template <class Work>
auto watched(pybind11::object progress, const Work& work) {
  Watch watch(std::move(progress));
  try {
    auto result = [&] {
      const pybind11::gil_scoped_release release;
      return work(watch);
    }();
    watch.finish();
    return result;
  } catch (const Error&) {
    watch.finish();
    throw;
  }
}

/// "3 of 10 regions", as progress.
std::string shareText(std::uint64_t done, std::uint64_t total, const std::string& what);

/// Number of threads of work: 0 means all processors. Throws Error unless it is 0 to 256.
int threadCount(int threads);

}  // namespace polyfly::python
