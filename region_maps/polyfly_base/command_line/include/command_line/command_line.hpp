#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

/// What the command lines of all tools have in common: rules for values, and how a tool ends.
namespace polyfly {

/// What a tool returns where its command line, a file or a problem breaks a rule.
constexpr int kBadUsage = 2;

/// Parses the command line, which may ask for --version, then does the work, whose result is returned. Every error, of either, is one line
/// `name: ...` on standard error, without what a terminal would act on, and kBadUsage is returned; so is where the standard
/// output cannot be written. Words with control characters are refused, since names of files are printed in many places, and
/// so are empty ones. A tool that does not
/// `speak` says nothing: of the processes of a launcher, which all fail alike, one does.
int runTool(CLI::App& app, int argc, const char* const* argv, const std::function<int()>& work,
            bool speaks = true);

/// Commands, and options that begin with "--", that are gone. They are not listed, take any arguments, and are refused with
/// `NAME: text`, which says what to use instead.
void addRemoved(CLI::App& app, const std::vector<std::string>& names, const std::string& text);

/// Whole numbers in decimal digits, from `least` to `greatest`. CLI11 alone would wrap -1 around.
CLI::Validator wholeNumber(std::uint64_t least, std::uint64_t greatest);

/// The same for what a variable of this type holds, from `least` on.
template <typename Number>
CLI::Validator wholeNumber(std::uint64_t least = 0) {
  return wholeNumber(least, static_cast<std::uint64_t>(std::numeric_limits<Number>::max()));
}

/// Numbers from `least` to `greatest`; not NaN, nor infinite.
CLI::Validator numberFrom(double least, double greatest = std::numeric_limits<double>::max());

/// Finite numbers above `least`.
CLI::Validator numberAbove(double least);

/// Any finite number.
CLI::Validator finiteNumber();

/// For CLI::Option::transform: a number of bytes, with k, M, G or T (powers of 1024) behind it or not.
CLI::Validator byteCount(std::uint64_t least = 0);

/// An option whose value is called `type` in the help text.
template <class Value>
CLI::Option* addOption(CLI::App& app, const char* name, Value& value, const char* type, const char* meaning) {
  return app.add_option(name, value, meaning)->type_name(type);
}

/// One of these words.
CLI::Validator oneOf(const std::vector<std::string>& words);

/// For CLI::Option::transform: a word's replacement; upper and lower case count as one.
CLI::Validator replaced(const std::map<std::string, std::string>& words);

/// The same for the enumerators that words stand for.
template <typename Value>
CLI::Validator oneOf(const std::map<std::string, Value>& values) {
  std::map<std::string, std::string> words;
  for (const auto& [word, value] : values) words[word] = std::to_string(static_cast<long>(value));
  return replaced(words);
}

}  // namespace polyfly
