#pragma once

#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

/// Command lines of the checkers, which share no code with other tools.
namespace checker {

/// What a command line says that breaks a rule.
struct BadUsage : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Values by option; the file that is checked stands under "".
using Arguments = std::map<std::string, std::string>;

struct Tool {
  std::string name;
  std::string version;
  /// The text that --help prints.
  std::string usage;
  /// Options, each of which takes a value.
  std::vector<std::string> options;
  /// The option that may stand in place of the file. Empty: there is none.
  std::string instead_of_file = {};
};

/// The value as a whole number from `least` to `greatest`. Throws BadUsage.
unsigned long long wholeNumber(const std::string& option, const std::string& text, unsigned long long least,
                               unsigned long long greatest);

/// Tells on a terminal, once a second, how far a check is.
void showProgress(const char* kind, std::size_t done, std::size_t total);

/// Reads the command line and checks. Every tool takes --time-limit, after which it ends with 3. Returns 0: confirmed, 1: refused, 2: bad command line, a file that
/// cannot be read, or memory that is not enough. All but the first say so in one line, without what a
/// terminal would act on.
int run(const Tool& tool, int argc, char** argv, const std::function<void(const Arguments&)>& check);

}  // namespace checker
