#include "watch.hpp"

#include <algorithm>
#include <thread>

namespace polyfly::python {
namespace {

namespace py = pybind11;

constexpr std::chrono::milliseconds kPeriod{100};
constexpr int kMostThreads = 256;

}  // namespace

Watch::Watch(py::object progress) : progress_(std::move(progress)), next_(Clock::now() + kPeriod) {
  if (py::isinstance<py::bool_>(progress_)) {
    on_terminal_ = progress_.cast<bool>();
    progress_ = py::none();
  }
}

void Watch::look(const std::string& text) {
  if (stop_ || Clock::now() < next_) return;
  next_ = Clock::now() + kPeriod;
  const py::gil_scoped_acquire acquire;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    show(text);
  } catch (const py::error_already_set&) {
    failure_ = std::current_exception();
    stop_ = true;
  }
}

void Watch::show(const std::string& text) {
  if (on_terminal_) {
    py::module_::import("sys").attr("stderr").attr("write")("\r" + text + "\x1b[K");
    line_is_open_ = true;
  } else if (!progress_.is_none()) {
    progress_(text);
  }
}

void Watch::finish() {
  if (line_is_open_) py::module_::import("sys").attr("stderr").attr("write")("\n");
  line_is_open_ = false;
  if (failure_) std::rethrow_exception(failure_);
  // Work that was too short for a look.
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

std::string shareText(std::uint64_t done, std::uint64_t total, const std::string& what) {
  return std::to_string(done) + " of " + std::to_string(total) + " " + what;
}

int threadCount(int threads) {
  if (threads < 0 || threads > kMostThreads) {
    throw Error("threads: must be 0 (all processors) to " + std::to_string(kMostThreads) + ", got " +
                std::to_string(threads));
  }
  if (threads > 0) return threads;
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kMostThreads);
}

}  // namespace polyfly::python
