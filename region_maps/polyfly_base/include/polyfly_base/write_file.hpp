#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace polyfly {

/// Replaces the file at `path`, or makes it: readers see the old bytes or the new ones, also after a loss of
/// power. Writes beside it (FileDraft), syncs, renames, syncs the folder. The first 64 bytes are written last
/// and are zero until then, so a left-over of a killed writer (`path`.tmp-*) is recognisable. Throws Error;
/// the old file is untouched then and nothing is left behind. A text goes into a device, a FIFO or the
/// standard output as it comes (isStream); bytes need a file.
void writeFileAtomically(const std::string& path, const std::vector<std::byte>& bytes);
void writeFileAtomically(const std::string& path, std::string_view text);

}  // namespace polyfly
