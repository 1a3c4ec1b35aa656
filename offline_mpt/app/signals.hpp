#pragma once

#include <atomic>
#include <string>

namespace polyfly {

/// A flag that SIGINT, SIGTERM and SIGHUP set from now on, and the end of `time_limit` [s] where that is
/// above zero: for work that keeps what it has found. A SIGHUP that is ignored (nohup) stays ignored.
const std::atomic<bool>& stopOnSignal(double time_limit = 0.0);

/// Whether the flag is set.
bool stopRequested();

/// Whether it was set by the end of the time limit.
bool timeIsUp();

/// From now on these signals and the end of the time limit end the program at once, with exit code 3 and
/// `message` as one line on standard error. For work of which nothing can be kept. Call it with no other
/// threads running. `time_limit` [s]: replaces what is left of an earlier one where it is above zero.
/// Without one, a signal or an end of the time limit that came before ends the program too.
void endOnSignal(const std::string& message, double time_limit = 0.0);

/// Ends the program now as endOnSignal() does later.
[[noreturn]] void endNow(const std::string& message);

/// These signals and the time limit do nothing from now on: while files are written, and for a process that
/// another one tells when to end.
void ignoreSignals();

}  // namespace polyfly
