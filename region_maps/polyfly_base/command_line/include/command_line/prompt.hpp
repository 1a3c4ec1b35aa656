#pragma once

#include <unistd.h>

#include <cstddef>
#include <functional>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "polyfly_base/visible.hpp"

namespace polyfly {

/// Answers which of several is meant, or nothing.
using Ask = std::function<std::optional<std::size_t>(const std::string& question,
                                                     const std::vector<std::string>& choices)>;

/// Asks at the terminal; an empty answer, or the end of the input, is none.
inline std::optional<std::size_t> askAtTerminal(const std::string& question,
                                                const std::vector<std::string>& choices) {
  std::cerr << visibleLines(question) << "\n";
  for (std::size_t i = 0; i < choices.size(); ++i)
    std::cerr << "  " << i + 1 << "  " << visible(choices[i]) << "\n";
  for (;;) {
    std::cerr << "number, or return for none: " << std::flush;
    std::string line;
    if (!std::getline(std::cin, line) || line.empty()) return std::nullopt;
    for (std::size_t i = 0; i < choices.size(); ++i) {
      if (line == std::to_string(i + 1) || line == choices[i]) return i;
    }
  }
}

/// The question where somebody can answer it, else none: scripts get an error that names the option.
inline Ask promptIfTerminal() {
  return isatty(STDIN_FILENO) != 0 && isatty(STDERR_FILENO) != 0 ? Ask(askAtTerminal) : Ask();
}

}  // namespace polyfly
