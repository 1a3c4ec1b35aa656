#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "exact_programs.hpp"
#include "holds.hpp"
#include "refusal_of.hpp"
#include "solved_map.hpp"

namespace polyfly {

using Words = std::vector<std::string>;

std::string bytesOf(const MapContent& content);

/// Empty where the certificate is confirmed, else why not.
std::string refusal(const std::string& certificate, const std::string& map, const std::string& problem = "");

/// Explores a program to its end, proves the map, and has the proof confirmed: also against the problem, where it is given.
CertifyReport proven(const ParametricProgram& program, const std::string& problem = "");

/// A certificate ends with the checksum of what stands before.
std::string withEnd(const std::string& text);

/// Gives a changed certificate the checksum of its new text, and names the map that it comes with.
std::string sealed(std::string text, const std::string& map);

Words wordsOf(const std::string& line);
Words linesOf(const std::string& text);
std::string joined(const Words& parts, const char* between);

/// Changes the words of a line of a certificate; false: this line is left alone.
using Change = std::function<bool(Words& words)>;

/// The change of those lines that have `text` for a word.
Change where(std::size_t word, const std::string& text, const Change& change);

/// The change that puts `text` in the place of one word.
Change setting(std::size_t word, const std::string& text);

/// The change that adds to a word, which is a number below `count`; the sum stays below it.
Change stepping(std::size_t word, std::size_t by, std::size_t count);

/// The change that replaces all words.
Change replacing(const Words& words);

/// The line is left out, or stands there twice.
Change leavingOut();
Change repeating();

/// Changes of the last word.
Change negatingLast();
Change lengtheningLast(const std::string& text);
Change droppingLast();

/// A program with its map and the map's proof.
struct Subject {
  explicit Subject(ParametricProgram program);
  /// A map and its certificate that are at hand; there is no program.
  Subject(MapContent content, std::string certificate);

  ParametricProgram program;
  MapContent content;
  std::string certificate;
};

/// The subject that a lambda makes for the first test that asks.
template <class Make>
const Subject& once(const Make& make) {
  static_assert(std::is_class_v<Make>, "functions of one type would share a subject");
  static const Subject subject(make());
  return subject;
}

/// A right map and its certificate, to be changed.
class Mutation : public ::testing::Test {
 protected:
  explicit Mutation(const Subject& subject = once([] { return doubleIntegrator(3); }));

  /// Why a changed map is refused with the certificate of the right one.
  std::string refusalOfMap(const MapContent& content) const;

  /// Why a certificate of these lines is refused.
  std::string refusalOfLines(const Words& lines) const;

  /// Every certificate with one changed line of those that start with `key` is refused, for a reason that holds `part`. Of many
  /// lines some all over the certificate are changed, one at a time, at least `least`.
  void expectRefused(const std::string& key, const Change& change, int least = 1,
                     const std::string& part = "") const;

  ParametricProgram program_;
  MapContent content_;
  std::string map_;
  std::string certificate_;
};

}  // namespace polyfly
