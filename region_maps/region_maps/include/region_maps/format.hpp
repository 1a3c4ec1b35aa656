#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "region_maps/map_content.hpp"

/// Mirror of FORMAT.md, which explains the fields.
namespace polyfly::format {

constexpr unsigned char kMagic[8] = {'P', 'F', 'L', 'Y', 'M', 'A', 'P', '\n'};
constexpr std::uint32_t kByteOrder = 0x01020304u;
/// The version that writers write.
constexpr std::uint32_t kVersion = 2;
/// The oldest version that readers read. It has no section `tests`.
constexpr std::uint32_t kFirstVersion = 1;
/// Alignment of the file in memory and of each section in the file.
constexpr std::size_t kAlignment = 64;  ///< [bytes]
constexpr std::uint32_t kMaxSignals = 256;
/// Greatest tolerance that readers accept. `solve` writes this one.
constexpr double kMaxTolerance = 1e-8;  ///< [scaled]
/// Greatest number of elements of a section, text excepted.
constexpr std::uint64_t kMaxElements = 0x7fffffffu;

enum Section : std::size_t {
  kText,
  kBounds,
  kPlanes,
  kLaws,
  kRegions,
  kRows,
  kActive,
  kNodes,
  kLeaves,
  kCandidates,
  kTests,
  kSectionCount
};

/// The strings that lead the text section; names and units of the signals follow.
enum Text : std::size_t { kName, kProblemText, kProblemKind, kSolverStatus, kSolverNotes, kTextCount };

struct SectionEntry {
  std::uint64_t offset;  ///< [bytes]
  std::uint64_t count;   ///< elements
};

struct Header {
  unsigned char magic[8];
  std::uint32_t byte_order;
  std::uint32_t version;
  std::uint64_t file_size;  ///< [bytes]
  std::uint64_t checksum;
  std::uint32_t parameters;
  std::uint32_t inputs;
  std::uint32_t root;
  std::uint32_t section_count;
  double period;     ///< [s]
  double tolerance;  ///< [scaled]
  std::uint32_t depth;
  std::uint32_t region_checks;
  std::uint64_t multiply_adds;
  std::uint64_t reduced_from;
  /// Always 0. Otherwise a map of version 0.2 with fallback regions, which are no more.
  std::uint32_t first_fallback;
  unsigned char reserved[4];
  SectionEntry sections[kSectionCount];
};

struct Bounds {
  double lower;
  double upper;
};

static_assert(sizeof(double) == 8, "f64");
/// Bytes of the header in version 1, and of the part that all versions share.
constexpr std::size_t kFirstHeader = 256;

static_assert(sizeof(Header) == 272 && std::is_trivially_copyable_v<Header>);
static_assert(offsetof(Header, checksum) == 24 && offsetof(Header, period) == 48);
static_assert(offsetof(Header, multiply_adds) == 72 && offsetof(Header, reduced_from) == 80);
static_assert(offsetof(Header, first_fallback) == 88 && offsetof(Header, sections) == 96);
static_assert(sizeof(Bounds) == 16 && std::is_trivially_copyable_v<Bounds>);
static_assert(sizeof(MapContent::Region) == 20 && std::is_trivially_copyable_v<MapContent::Region>);
static_assert(sizeof(MapContent::Node) == 12 && std::is_trivially_copyable_v<MapContent::Node>);
static_assert(sizeof(MapContent::Leaf) == 8 && std::is_trivially_copyable_v<MapContent::Leaf>);

/// Sections and bytes of the header in a version.
constexpr std::size_t sectionCount(std::uint32_t version) noexcept {
  return version == kFirstVersion ? kSectionCount - 1 : std::size_t{kSectionCount};
}
constexpr std::size_t headerSize(std::uint32_t version) noexcept {
  return version == kFirstVersion ? kFirstHeader : sizeof(Header);
}

/// The header of a file that is long enough for its version. Sections that the version lacks are empty.
Header readHeader(const void* data) noexcept;

/// Bytes of one element of a section, with p parameters and m inputs.
std::size_t elementSize(std::size_t section, std::uint64_t p, std::uint64_t m) noexcept;

/// Next multiple of kAlignment.
constexpr std::uint64_t alignUp(std::uint64_t bytes) noexcept {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

/// Checksum of a file of at least kFirstHeader bytes, as the header's field must hold it.
std::uint64_t checksum(const void* data, std::size_t size) noexcept;

}  // namespace polyfly::format
