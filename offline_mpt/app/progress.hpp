#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

namespace polyfly {

/// One line on standard error about long work: rewritten in place on a terminal, else a new line now and
/// then.
class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows `text` and the time that has passed, if it is time to.
  void show(const std::string& text);

  /// Shows "BEFORE DONE of TOTAL AFTER" for work that counts. The progress must outlive it.
  std::function<void(std::uint64_t done, std::uint64_t total)> counter(const std::string& before,
                                                                       const std::string& after);

  /// Ends the line.
  void finish();

  /// Time since construction [s].
  double elapsed() const;

 private:
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point next_;
  const bool quiet_;
  const bool terminal_;
  // Whether the terminal shows an unfinished line.
  bool open_ = false;
};

/// "12 s", "3 min 05 s", "2 h 10 min"
std::string duration(double seconds);

}  // namespace polyfly
