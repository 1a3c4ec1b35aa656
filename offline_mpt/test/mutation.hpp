#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "exact_programs.hpp"
#include "region_maps/map_content.hpp"

namespace polyfly {

std::string bytesOf(const MapContent& content);

/// Empty where the certificate is confirmed, else why not.
std::string refusal(const std::string& certificate, const std::string& map, const std::string& problem = "");

/// Gives a changed certificate the checksum of its new text, and names the map that it comes with.
std::string sealed(std::string text, const std::string& map);

std::vector<std::string> linesOf(const std::string& text);
std::string joined(const std::vector<std::string>& parts, const char* between);

/// Changes the words of a line of a certificate; false: this line is left alone.
using Change = std::function<bool(std::vector<std::string>& words)>;

/// The change that puts `text` in the place of one word.
Change setting(std::size_t word, const std::string& text);

/// The change that replaces all words.
Change replacing(const std::vector<std::string>& words);

/// A right map and its certificate, to be changed.
class Mutation : public ::testing::Test {
 protected:
  explicit Mutation(ParametricProgram program = doubleIntegrator(3));
  /// A map and its certificate that are at hand; there is no program.
  Mutation(MapContent content, std::string certificate);

  /// Why a changed map is refused with the certificate of the right one.
  std::string refusalOfMap(const MapContent& content) const;

  /// Why the certificate is refused after `change` of each line that starts with `key`, one at a time. Empty
  /// where one of them is confirmed. Of many lines some all over the certificate are taken; `tried` counts
  /// them.
  std::string refusalOfLines(const std::string& key, const Change& change, int& tried) const;

  ParametricProgram program_;
  MapContent content_;
  std::string map_;
  std::string certificate_;
};

}  // namespace polyfly
