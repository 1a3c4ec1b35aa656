#include "signals.hpp"

#include <sys/time.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>

#include "command.hpp"

namespace polyfly {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP, SIGALRM};

std::atomic<bool> stop{false};
std::atomic<bool> time_is_up{false};
static_assert(std::atomic<bool>::is_always_lock_free, "used in a signal handler");

// Written before the handler that reads it is installed.
std::string last_words;

extern "C" void setStop(int signal) {
  if (signal == SIGALRM && !stop.load()) time_is_up.store(true);
  stop.store(true);
}

extern "C" void sayAndEnd(int) {
  // Nothing can be done about a failed write.
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, last_words.data(), last_words.size());
  ::_exit(static_cast<int>(ExitCode::kStopped));
}

sigset_t allSignals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : kSignals) sigaddset(&set, signal);
  return set;
}

// As under nohup, before this program has changed it.
bool hangUpIsIgnored() {
  static const bool kIgnored = [] {
    struct sigaction current = {};
    sigaction(SIGHUP, nullptr, &current);
    return (current.sa_flags & SA_SIGINFO) == 0 && current.sa_handler == SIG_IGN;
  }();
  return kIgnored;
}

void install(void (*handler)(int)) {
  const bool without_hang_up = hangUpIsIgnored();
  for (const int signal : kSignals) {
    if (signal == SIGHUP && without_hang_up) continue;
    struct sigaction action = {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    // Of two signals that end the program, one speaks.
    action.sa_mask = allSignals();
    sigaction(signal, &action, nullptr);
  }
}

// One alarm after so many seconds; 0: none.
void setAlarm(double seconds) {
  constexpr double kMicroseconds = 1e6;
  constexpr double kLongest = 1e8;  // [s], three years
  const double limited = std::fmin(seconds, kLongest);
  itimerval timer = {};
  timer.it_value.tv_sec = static_cast<time_t>(limited);
  timer.it_value.tv_usec = static_cast<suseconds_t>((limited - std::floor(limited)) * kMicroseconds);
  if (seconds > 0.0 && timer.it_value.tv_sec == 0 && timer.it_value.tv_usec == 0) timer.it_value.tv_usec = 1;
  setitimer(ITIMER_REAL, &timer, nullptr);
}

void setLastWords(const std::string& message) {
  // A line that shows progress on a terminal is not finished yet.
  last_words = std::string(::isatty(STDERR_FILENO) != 0 ? "\r\033[K" : "") + "offline_mpt: " + message + "\n";
}

}  // namespace

const std::atomic<bool>& stopOnSignal(double time_limit) {
  install(setStop);
  if (time_limit > 0.0) setAlarm(time_limit);
  return stop;
}

bool stopRequested() { return stop.load(); }

bool timeIsUp() { return time_is_up.load(); }

void endOnSignal(const std::string& message, double time_limit) {
  if (time_limit <= 0.0 && stopRequested()) endNow(message);
  const sigset_t all = allSignals();
  sigset_t before;
  // A signal that comes meanwhile waits for the new handler.
  pthread_sigmask(SIG_BLOCK, &all, &before);
  setLastWords(message);
  install(sayAndEnd);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (time_limit > 0.0) setAlarm(time_limit);
}

void endNow(const std::string& message) {
  setLastWords(message);
  sayAndEnd(0);
  std::abort();  // not reached
}

void ignoreSignals() { install(SIG_IGN); }

}  // namespace polyfly
