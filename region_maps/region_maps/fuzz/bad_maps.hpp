#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace polyfly {

/// The bytes of a file that must be refused, and what the refusal must say.
struct BadMap {
  std::string name;  ///< usable as a file name
  std::vector<std::byte> bytes;
  std::string reason;  ///< part of the error's text
};

/// Maps whose frame is broken: size, magic, byte order, version, checksum.
std::vector<BadMap> mapsWithBadFrame();

/// Maps that break one structural rule of FORMAT.md each, with the right checksum and file size.
std::vector<BadMap> mapsWithBadStructure();

/// Writes size and checksum that suit `bytes` into its header, which must be there.
void repairFrame(std::vector<std::byte>& bytes);

}  // namespace polyfly
