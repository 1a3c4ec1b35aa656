#include "command_line/command_line.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include "polyfly_base/decimal.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/version.hpp"
#include "polyfly_base/visible.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kMostShown = 40;  // characters of a value that a message repeats
constexpr std::uint64_t kGreatest = std::numeric_limits<std::uint64_t>::max();

/// The value as a message repeats it.
std::string shown(const std::string& text) {
  const std::string part = visible(text.substr(0, kMostShown)) + (text.size() > kMostShown ? ".." : "");
  const auto plain = [](unsigned char c) { return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '+'; };
  return !part.empty() && std::all_of(part.begin(), part.end(), plain) ? part : "'" + part + "'";
}

std::string shown(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.15g", value);
  return text;
}

bool allDigits(const std::string& text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// The value of decimal digits; none where they are beyond 64 bits, or CLI11 would read them as octal.
std::optional<std::uint64_t> wholeOf(const std::string& digits) {
  if (!allDigits(digits) || (digits.size() > 1 && digits[0] == '0')) return std::nullopt;
  errno = 0;
  const std::uint64_t value = std::strtoull(digits.c_str(), nullptr, 10);
  if (errno == ERANGE) return std::nullopt;
  return value;
}

std::string lowerCase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

CLI::Validator rule(std::function<bool(const std::string&)> holds, const std::string& sentence,
                    const std::string& hint) {
  return CLI::Validator(
      [holds = std::move(holds), sentence](std::string& text) {
        return holds(text) ? std::string() : shown(text) + " is not " + sentence;
      },
      hint);
}

bool isCommand(const CLI::App& app, const std::string& name) {
  const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
  return std::any_of(commands.begin(), commands.end(),
                     [&name](const CLI::App* command) { return command->check_name(name); });
}

/// What is wrong with a word before it has a meaning: names of files are printed by many lines, so none may
/// hold what a terminal would act on; an empty one is a variable of the shell that is not set; and a word in the place of a
/// command must be one.
std::string strayWord(const CLI::App& app, int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (hasControl(word)) return shown(word) + ": control characters are not taken";
    if (word.empty() && i > 1 && argv[i - 1][0] == '-')
      return std::string(argv[i - 1]) + ": its value is empty";
    if (word.empty()) return "an argument is empty";
    if (word[0] == '-' && word.back() == '=') return word + " has no value";
  }
  const bool has_commands = !app.get_subcommands([](const CLI::App*) { return true; }).empty();
  if (!has_commands || argc < 2 || argv[1][0] == '-' || isCommand(app, argv[1])) return "";
  return "'" + std::string(argv[1]) + "' is no command";
}

constexpr const char* kNotPrinted = "the standard output cannot be written";

/// Whether all that was printed has arrived.
bool printedAll() {
  std::cout.flush();
  return std::cout.good() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
}

}  // namespace

int runTool(CLI::App& app, int argc, const char* const* argv, const std::function<int()>& work, bool speaks) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may grow no further is an error of the write that meets it
  const auto fail = [&](const std::string& text) {
    if (speaks) std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), visible(text).c_str());
    return kBadUsage;
  };
  const std::string help = " (see " + app.get_name() + " --help)";
  try {
    const std::string stray = strayWord(app, argc, argv);
    if (!stray.empty()) return fail(stray + help);
    app.set_version_flag("--version", app.get_name() + " " + kVersion, "Print the version and exit");
    app.parse(argc, argv);
    const int result = work();
    return printedAll() ? result : fail(kNotPrinted);
  } catch (const CLI::Success& request) {  // --help, --version
    const int result = app.exit(request);
    return printedAll() ? result : fail(kNotPrinted);
  } catch (const CLI::ParseError& error) {
    return fail(error.what() + help);
  } catch (const std::bad_alloc&) {
    return fail("out of memory");
  } catch (const std::length_error&) {
    // A container would be larger than memory can be.
    return fail("out of memory");
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}

CLI::Validator wholeNumber(std::uint64_t least, std::uint64_t greatest) {
  const std::string range = greatest == kGreatest
                                ? "of at least " + std::to_string(least)
                                : "from " + std::to_string(least) + " to " + std::to_string(greatest);
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const std::optional<std::uint64_t> value = wholeOf(text);
        if (value && *value >= least && *value <= greatest) return "";
        const bool beyond = greatest == kGreatest && !value && allDigits(text) && text[0] != '0';
        return shown(text) + " is not a whole number " +
               (beyond ? "of at most " + std::to_string(greatest) : range);
      },
      greatest == kGreatest ? ">= " + std::to_string(least)
                            : std::to_string(least) + ".." + std::to_string(greatest));
}

CLI::Validator numberFrom(double least, double greatest) {
  const bool open = greatest == std::numeric_limits<double>::max();
  return rule(
      [=](const std::string& text) {
        const std::optional<double> value = decimalNumber(text);
        return value && *value >= least && *value <= greatest;
      },
      open ? "a finite number of at least " + shown(least)
           : "a number from " + shown(least) + " to " + shown(greatest),
      open ? ">= " + shown(least) : shown(least) + ".." + shown(greatest));
}

CLI::Validator numberAbove(double least) {
  return rule(
      [=](const std::string& text) {
        const std::optional<double> value = decimalNumber(text);
        return value && *value > least;
      },
      "a finite number above " + shown(least), "> " + shown(least));
}

CLI::Validator finiteNumber() {
  return rule([](const std::string& text) { return decimalNumber(text).has_value(); }, "a finite number", "");
}

CLI::Validator byteCount(std::uint64_t least) {
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
        const std::string unit = lowerCase(text.substr(digits));
        const std::string letters = "kmgtpe";
        const std::size_t power = unit.empty() || unit == "b" ? 0 : letters.find(unit[0]) + 1;
        const std::string rest = power == 0 ? "" : unit.substr(1);
        const std::optional<std::uint64_t> value = wholeOf(text.substr(0, digits));
        const bool known = (unit.empty() || unit == "b" || letters.find(unit[0]) != std::string::npos) &&
                           (rest.empty() || rest == "b" || rest == "i" || rest == "ib");
        if (value && known && *value <= kGreatest >> (10 * power) && *value << (10 * power) >= least) {
          text = std::to_string(*value << (10 * power));
          return "";
        }
        return shown(text) + " is not a number of bytes of at least " + std::to_string(least) +
               ", such as 500M or 4G";
      },
      "BYTES");
}

void addRemoved(CLI::App& app, const std::vector<std::string>& names, const std::string& text) {
  for (const std::string& name : names) {
    const auto refuse = [sentence = name + ": " + text] { throw Error(sentence); };
    if (name.rfind("--", 0) == 0) {
      app.add_option_function<std::string>(name, [refuse](const std::string&) { refuse(); })
          ->expected(0, 1)
          ->group("");
      continue;
    }
    CLI::App* command = app.add_subcommand(name, "")->group("");
    command->allow_extras()->prefix_command();
    command->callback(refuse);
  }
}

CLI::Validator oneOf(const std::vector<std::string>& words) {
  return rule(
      [=](const std::string& text) { return std::find(words.begin(), words.end(), text) != words.end(); },
      "one of " + CLI::detail::join(words, ", "), CLI::detail::join(words, "|"));
}

CLI::Validator replaced(const std::map<std::string, std::string>& words) {
  std::vector<std::string> known;
  for (const auto& [word, value] : words) known.push_back(word);
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const auto found = words.find(lowerCase(text));
        if (found == words.end()) return shown(text) + " is not one of " + CLI::detail::join(known, ", ");
        text = found->second;
        return "";
      },
      CLI::detail::join(known, "|"));
}

}  // namespace polyfly
