#pragma once

#include <cstddef>
#include <string>

#include "c_text.hpp"

namespace polyfly {

/// What all templates need: name, version, words of the type.
struct CodeKind {
  std::string name;
  ExportType type = ExportType::kDouble;
  std::string problem_text;
  std::size_t parameters = 0, inputs = 0;
};
Replacements sharedKeys(const CodeKind& code);

/// The same of a map, with its checksum, name and number of regions.
Replacements mapKeys(const RegionMap& map, const ExportOptions& options);

/// NAME_test.c. The keys also have "oracle", "workspace", "parameter_note" and "call".
std::string testText(Replacements keys, ExportType type, const TestVectors& vectors);

}  // namespace polyfly
