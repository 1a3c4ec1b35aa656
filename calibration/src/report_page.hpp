#pragma once

#include <string>

namespace polyfly {

/// Style of the report page; no font, script or image comes from elsewhere.
extern const char* const kReportStyle;

/// The text with the characters replaced that mean something in HTML.
std::string escaped(const std::string& text);

}  // namespace polyfly
