#include "arguments.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <new>

#include "files.hpp"

namespace checker {
namespace {

constexpr int kRefused = 1;
constexpr int kBadUsage = 2;
constexpr int kStopped = 3;
constexpr const char* kTimeLimit = "--time-limit";
constexpr unsigned long long kLongestLimit = 100'000'000;  // [s], three years
constexpr std::size_t kMostShown = 40;                     // characters of a value that a message repeats

std::string shown(std::string text) {
  const bool cut = text.size() > kMostShown;
  text.resize(std::min(text.size(), kMostShown));
  return "'" + text + (cut ? "..'" : "'");
}

void say(const std::string& name, std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) c = '?';
  }
  std::fprintf(stderr, "%s: %s\n", name.c_str(), text.c_str());
}

/// What --help or --version prints, or the arguments are read and it is empty.
std::string read(const Tool& tool, int argc, char** argv, Arguments& arguments) {
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--help") return tool.usage;
    if (word == "--version") return tool.name + " " + tool.version + "\n";
    const bool option =
        word == kTimeLimit || std::find(tool.options.begin(), tool.options.end(), word) != tool.options.end();
    if (!option && !word.empty() && word[0] == '-') throw BadUsage(shown(word) + " is no option");
    if (!option && arguments.count("") != 0) throw BadUsage(shown(word) + ": one file is checked at a time");
    if (option && (++k == argc || *argv[k] == '\0')) throw BadUsage(word + ": its value is missing");
    arguments[option ? word : ""] = argv[k];
  }
  const bool has_folder = !tool.instead_of_file.empty() && arguments.count(tool.instead_of_file) != 0;
  if (!has_folder && (arguments.count("") == 0 || arguments[""].empty()))
    throw BadUsage("the file to check is missing");
  if (has_folder) {
    if (arguments.count("") != 0) throw BadUsage(tool.instead_of_file + " and a file exclude each other");
    arguments[""] = arguments[tool.instead_of_file];
  }
  return "";
}

// What is written at the end of the time limit; set before the alarm.
std::string time_is_up;

extern "C" void endInTime(int) {
  // Nothing can be done about a failed write.
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, time_is_up.data(), time_is_up.size());
  ::_exit(kStopped);
}

void limitTime(const Tool& tool, const Arguments& arguments) {
  const auto limit = arguments.find(kTimeLimit);
  if (limit == arguments.end()) return;
  time_is_up = tool.name + ": stopped at the time limit, nothing is confirmed\n";
  std::signal(SIGALRM, endInTime);
  ::alarm(static_cast<unsigned>(wholeNumber(kTimeLimit, limit->second, 1, kLongestLimit)));
}

}  // namespace

void showProgress(const char* kind, std::size_t done, std::size_t total) {
  using Clock = std::chrono::steady_clock;
  static Clock::time_point next = Clock::now() + std::chrono::seconds(1);
  if (::isatty(STDERR_FILENO) == 0 || Clock::now() < next) return;
  next = Clock::now() + std::chrono::seconds(1);
  std::fprintf(stderr, "%s %zu of %zu\n", kind, done, total);
}

unsigned long long wholeNumber(const std::string& option, const std::string& text, unsigned long long least,
                               unsigned long long greatest) {
  // 64 bits hold every number with this many digits.
  constexpr std::size_t kMostDigits = 18;
  const bool digits = !text.empty() && text.size() <= kMostDigits &&
                      text.find_first_not_of("0123456789") == std::string::npos;
  const unsigned long long value = digits ? std::stoull(text) : 0;
  if (!digits || value < least || value > greatest) {
    throw BadUsage(option + ": " + shown(text) + " is not a whole number from " + std::to_string(least) +
                   " to " + std::to_string(greatest));
  }
  return value;
}

int run(const Tool& tool, int argc, char** argv, const std::function<void(const Arguments&)>& check) {
  Arguments arguments;
  try {
    const std::string answer = read(tool, argc, argv, arguments);
    limitTime(tool, arguments);
    if (answer.empty()) check(arguments);
    std::fputs(answer.c_str(), stdout);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      throw Unreadable("the standard output cannot be written");
    return 0;
  } catch (const BadUsage& error) {
    say(tool.name, error.what() + (" (see " + tool.name + " --help)"));
  } catch (const Unreadable& error) {
    say(tool.name, error.what());
  } catch (const RefusedFile& error) {
    say(tool.name, error.what());
    return kRefused;
  } catch (const std::bad_alloc&) {
    say(tool.name, "out of memory");
  } catch (const std::exception& error) {
    say(tool.name, arguments[""] + ": refused: " + error.what());
    return kRefused;
  }
  return kBadUsage;
}

}  // namespace checker
