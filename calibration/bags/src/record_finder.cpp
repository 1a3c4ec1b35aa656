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
// Longest header that is searched for [bytes].
constexpr std::uint32_t kLongestHeader = 4096;
// What a header is told by: its length, that of its first field, and the first letter of the field's name.
constexpr std::size_t kBegin = 2 * kLength + 1;

bool isTopLevel(const BagFields& fields) {
  const auto op = fields.number<std::uint8_t>("op");
  const bool is_kind = op && *op >= static_cast<std::uint8_t>(BagOp::kBagHeader) &&
                       *op <= static_cast<std::uint8_t>(BagOp::kConnection);
  if (!is_kind) return false;
  return !fields.is(BagOp::kChunk) || (fields.text("compression") && fields.number<std::uint32_t>("size"));
}

bool mayBegin(const std::uint8_t* data) {
  const auto header = readNumber<std::uint32_t>(data);
  const auto field = readNumber<std::uint32_t>(data + kLength);
  return header <= kLongestHeader && field < header && data[kBegin - 1] >= 'a' && data[kBegin - 1] <= 'z';
}

}  // namespace

bool RecordFinder::within(std::uint64_t from, std::uint64_t count) const {
  return from <= source_.size() && count <= source_.size() - from;
}

std::optional<std::uint32_t> RecordFinder::lengthAt(std::uint64_t at) {
  std::array<std::uint8_t, kLength> bytes{};
  if (!within(at, kLength) || !source_.read(at, kLength, bytes.data())) return std::nullopt;
  return readNumber<std::uint32_t>(bytes.data());
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

std::uint64_t RecordFinder::search(std::uint64_t from, std::uint64_t to, bool outside_chunks) {
  for (std::uint64_t begin = from; begin < to && within(begin, kBegin); begin += kWindow) {
    window_.resize(std::min(kWindow + kBegin - 1, source_.size() - begin));
    if (!source_.read(begin, window_.size(), window_.data())) return to;
    for (std::size_t place = 0; place + kBegin <= window_.size() && begin + place < to; ++place) {
      if (!mayBegin(window_.data() + place)) continue;
      const std::optional<FileRecord> record = at(begin + place);
      if (!record) continue;
      const BagFields& fields = record->fields;
      if (!outside_chunks || fields.is(BagOp::kChunk) || fields.is(BagOp::kIndex)) return begin + place;
    }
  }
  return to;
}

std::uint64_t RecordFinder::next(std::uint64_t from, std::uint64_t to) { return search(from, to, false); }

std::uint64_t RecordFinder::nextOutsideChunks(std::uint64_t from, std::uint64_t to) {
  return search(from, to, true);
}

}  // namespace polyfly
