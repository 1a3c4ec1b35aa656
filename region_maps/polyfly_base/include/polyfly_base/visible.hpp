#pragma once

#include <string>
#include <string_view>

namespace polyfly {

/// The text for a terminal, in one line. Control characters, line ends and bytes that are not UTF-8 become escapes as
/// in C. Names of files, topics and signals come from outside.
std::string visible(std::string_view text);

/// The same for text of several lines, whose line ends stay.
std::string visibleLines(std::string_view text);

/// Whether a terminal would act on a part of the text.
bool hasControl(std::string_view text) noexcept;

}  // namespace polyfly
