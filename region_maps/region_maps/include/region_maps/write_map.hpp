#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "region_maps/map_content.hpp"

namespace polyfly {

/// The bytes of the file that holds `content`; the same content gives the same bytes.
/// Throws Error naming `content.name` and the rule of FORMAT.md that the content breaks.
std::vector<std::byte> layOut(const MapContent& content);

/// Lays out `content` and writes it with writeFileAtomically. Throws Error.
void writeMap(const MapContent& content, const std::string& path);

}  // namespace polyfly
