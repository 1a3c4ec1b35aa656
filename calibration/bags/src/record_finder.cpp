#include "record_finder.hpp"

#include <algorithm>
#include <array>

namespace polyfly {
namespace {

constexpr std::uint64_t kLength = sizeof(std::uint32_t);
constexpr std::uint64_t kGreatestHeader = std::uint64_t{1} << 20;  // bytes; a connection's is a few hundred
constexpr std::uint64_t kGreatestRecord = std::uint64_t{1} << 31;  // bytes
// Bytes that are searched at once.
constexpr std::uint64_t kWindow = std::uint64_t{1} << 16;
// The field `op` of each record's header: its length, name and sign; the kind follows.
constexpr std::array<std::uint8_t, 7> kMark = {4, 0, 0, 0, 'o', 'p', '='};
// Greatest number of bytes in a header before its field `op`. Those of rosbag are 57 at most.
constexpr std::uint64_t kLongestLead = 256;

bool isTopLevelKind(std::uint8_t op) {
  return op >= static_cast<std::uint8_t>(BagOp::kBagHeader) &&
         op <= static_cast<std::uint8_t>(BagOp::kConnection);
}

bool isKindOutsideChunks(std::uint8_t op) {
  return op == static_cast<std::uint8_t>(BagOp::kChunk) || op == static_cast<std::uint8_t>(BagOp::kIndex);
}

bool isTopLevel(const BagFields& fields) {
  const auto op = fields.number<std::uint8_t>("op");
  if (!op || !isTopLevelKind(*op)) return false;
  return !fields.is(BagOp::kChunk) || (fields.text("compression") && fields.number<std::uint32_t>("size"));
}

}  // namespace

bool RecordFinder::within(std::uint64_t from, std::uint64_t count) const {
  return from <= source_.size() && count <= source_.size() - from;
}

std::optional<std::uint32_t> RecordFinder::lengthAt(std::uint64_t at) {
  std::array<std::uint8_t, kLength> bytes{};
  if (!within(at, kLength) || !source_.read(at, kLength, bytes.data())) return std::nullopt;
  return littleEndian<std::uint32_t>(bytes.data());
}

std::optional<FileRecord> RecordFinder::at(std::uint64_t place) {
  const std::optional<std::uint32_t> header = lengthAt(place);
  if (!header || *header > kGreatestHeader || !within(place + kLength, *header)) return std::nullopt;
  header_.resize(*header);
  if (!source_.read(place + kLength, *header, header_.data())) return std::nullopt;
  const std::optional<BagFields> fields = BagFields::parse(header_.data(), header_.size());
  if (!fields || !isTopLevel(*fields)) return std::nullopt;
  const std::uint64_t data = place + kLength + *header + kLength;
  const std::optional<std::uint32_t> size = lengthAt(data - kLength);
  if (!size || *size > kGreatestRecord || !within(data, *size)) return std::nullopt;
  return FileRecord{*fields, place, data, *size};
}

// The header's length stands before its first field; the mark is one of its fields.
std::optional<std::uint64_t> RecordFinder::recordAround(std::uint64_t mark, std::uint64_t from,
                                                        std::uint64_t to) {
  if (mark < from + kLength) return std::nullopt;
  const std::uint64_t last = mark - kLength;
  const std::uint64_t count = std::min(last - from, kLongestLead) + 1;
  for (std::uint64_t back = 0; back < count; ++back) {
    const std::uint64_t place = last - back;
    if (place >= to) continue;
    const std::optional<std::uint32_t> header = lengthAt(place);
    if (!header || *header > kGreatestHeader || place + kLength + *header < mark + kMark.size()) continue;
    if (at(place)) return place;
  }
  return std::nullopt;
}

std::uint64_t RecordFinder::search(std::uint64_t from, std::uint64_t to, Kinds kinds) {
  std::vector<std::uint8_t> window;
  // A record that begins before `to` may have its mark behind it.
  const std::uint64_t last = std::min(source_.size(), to + kLength + kLongestLead + kMark.size() + 1);
  for (std::uint64_t place = from; place + kMark.size() < last; place += kWindow) {
    window.resize(std::min(kWindow + kMark.size(), last - place));
    if (!source_.read(place, window.size(), window.data())) return to;
    auto found = window.begin();
    while (true) {
      found = std::search(found, window.end() - 1, kMark.begin(), kMark.end());
      if (found == window.end() - 1) break;
      const std::uint64_t mark = place + static_cast<std::uint64_t>(found - window.begin());
      const auto record = kinds(found[kMark.size()]) ? recordAround(mark, from, to) : std::nullopt;
      if (record) return *record;
      ++found;
    }
  }
  return to;
}

std::uint64_t RecordFinder::next(std::uint64_t from, std::uint64_t to) {
  return search(from, to, isTopLevelKind);
}

std::uint64_t RecordFinder::nextOutsideChunks(std::uint64_t from, std::uint64_t to) {
  return search(from, to, isKindOutsideChunks);
}

}  // namespace polyfly
