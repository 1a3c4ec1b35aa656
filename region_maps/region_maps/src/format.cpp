#include "region_maps/format.hpp"

#include <cstring>

// Compiles XXH64 into this file; nothing to link.
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace polyfly::format {

std::size_t elementSize(std::size_t section, std::uint64_t p, std::uint64_t m) noexcept {
  switch (static_cast<Section>(section)) {
    case kText:
      return 1;
    case kBounds:
      return sizeof(Bounds);
    case kPlanes:
      return sizeof(double) * (p + 1);
    case kLaws:
      return sizeof(double) * (p + 1) * m;
    case kRegions:
      return sizeof(MapContent::Region);
    case kRows:
    case kActive:
      return sizeof(std::int32_t);
    case kNodes:
      return sizeof(MapContent::Node);
    case kLeaves:
      return sizeof(MapContent::Leaf);
    case kCandidates:
    case kTests:
      return sizeof(std::uint32_t);
    case kSectionCount:
      break;
  }
  return 1;
}

Header readHeader(const void* data) noexcept {
  Header header = {};
  std::memcpy(&header, data, kFirstHeader);
  if (header.version != kFirstVersion) std::memcpy(&header, data, sizeof(header));
  return header;
}

std::uint64_t checksum(const void* data, std::size_t size) noexcept {
  const auto* bytes = static_cast<const unsigned char*>(data);
  unsigned char head[kFirstHeader];
  std::memcpy(head, bytes, sizeof(head));
  std::memset(head + offsetof(Header, checksum), 0, sizeof(Header::checksum));
  XXH64_state_t state;
  XXH64_reset(&state, 0);
  XXH64_update(&state, head, sizeof(head));
  XXH64_update(&state, bytes + sizeof(head), size - sizeof(head));
  return XXH64_digest(&state);
}

}  // namespace polyfly::format
