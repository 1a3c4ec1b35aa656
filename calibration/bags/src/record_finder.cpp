#include "record_finder.hpp"

#include <algorithm>
#include <array>

namespace polyfly {
namespace {

constexpr std::size_t kLength = sizeof(std::uint32_t);
constexpr std::uint64_t kGreatestHeader = std::uint64_t{1} << 20;  // bytes; a connection's is a few hundred
constexpr std::uint64_t kGreatestRecord = std::uint64_t{1} << 31;  // bytes
// Bytes that are searched at once.
constexpr std::uint64_t kWindow = std::uint64_t{1} << 16;
// The field `op` of each record's header: its length, name and sign; the kind follows.
constexpr std::array<std::uint8_t, 7> kMark = {4, 0, 0, 0, 'o', 'p', '='};
// Greatest number of bytes in a header before its field `op`. Those of rosbag are 57 at most.
constexpr std::size_t kLongestLead = 256;
// Longest header that is searched for [bytes]. A search must end soon in files that hold many marks.
constexpr std::uint32_t kLongestHeader = 4096;

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

// Whether the fields of a header that begins at `place` lead to the mark.
bool leadsTo(const std::vector<std::uint8_t>& bytes, std::size_t place, std::size_t mark) {
  std::size_t field = place + kLength;
  while (field < mark) field += kLength + littleEndian<std::uint32_t>(bytes.data() + field);
  return field == mark;
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
std::optional<std::uint64_t> RecordFinder::recordAround(const Window& window, std::size_t mark,
                                                        std::uint64_t to) {
  for (std::size_t back = kLength; back <= std::min(mark, kLongestLead + kLength); ++back) {
    const std::size_t place = mark - back;
    const auto header = littleEndian<std::uint32_t>(window.bytes.data() + place);
    const bool holds_mark = header <= kLongestHeader && kLength + header >= back + kMark.size() &&
                            leadsTo(window.bytes, place, mark);
    if (holds_mark && window.begin + place < to && at(window.begin + place)) return window.begin + place;
  }
  return std::nullopt;
}

std::uint64_t RecordFinder::search(std::uint64_t from, std::uint64_t to, Kinds kinds) {
  Window window;
  // A record that begins before `to` may have its mark behind it.
  const std::uint64_t last = std::min(source_.size(), to + kLength + kLongestLead + kMark.size() + 1);
  for (std::uint64_t place = from; place + kMark.size() < last; place += kWindow) {
    window.begin = place - std::min<std::uint64_t>(place - from, kLongestLead + kLength);
    window.bytes.resize(std::min(place - window.begin + kWindow + kMark.size(), last - window.begin));
    if (!source_.read(window.begin, window.bytes.size(), window.bytes.data())) return to;
    auto found = window.bytes.begin() + static_cast<std::ptrdiff_t>(place - window.begin);
    while (true) {
      found = std::search(found, window.bytes.end() - 1, kMark.begin(), kMark.end());
      if (found == window.bytes.end() - 1) break;
      const auto mark = static_cast<std::size_t>(found - window.bytes.begin());
      const auto record = kinds(found[kMark.size()]) ? recordAround(window, mark, to) : std::nullopt;
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
