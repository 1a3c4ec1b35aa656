#pragma once

#include <atomic>
#include <string>

namespace polyfly {

/// What a signal does that comes after the first one.
enum class NextSignal {
  /// It ends the program at once.
  kEnds,
  /// Nothing more: for work that saves what it has found, which a second signal must not lose.
  kIsTaken,
};

/// A flag that SIGINT, SIGTERM and SIGHUP set from now on, and the end of `time_limit` [s] where that is
/// above zero. A SIGHUP that is ignored (nohup) stays ignored.
const std::atomic<bool>& stopOnSignal(NextSignal next = NextSignal::kEnds, double time_limit = 0.0);

/// Whether the flag is set.
bool stopRequested();

/// Whether it was set by the end of the time limit.
bool timeIsUp();

/// From now on these signals and the end of the time limit end the program at once, with exit code 3 and
/// `message` as one line on standard error. For work of which nothing can be kept. Call it with no other
/// threads running. `time_limit` [s]: replaces what is left of an earlier one where it is above zero.
void endOnSignal(const std::string& message, double time_limit = 0.0);

/// As endOnSignal(), also by a signal or an end of the time limit that came before.
void endOnAnySignal(const std::string& message);

/// Ends the program now as endOnSignal() does later.
[[noreturn]] void endNow(const std::string& message);

/// These signals and the time limit do nothing from now on: while files are written, and for a process that
/// another one tells when to end.
void ignoreSignals();

}  // namespace polyfly
