#include "bag_contents.hpp"

#include <algorithm>
#include <optional>
#include <set>

namespace polyfly {
namespace {

// Whole seconds in the low half, the rest in nanoseconds in the high half.
double timeOf(std::uint64_t stamp) {
  return static_cast<double>(stamp & 0xffffffffU) + 1e-9 * static_cast<double>(stamp >> 32U);
}

// What the bag's first record promises.
struct Promise {
  std::uint64_t index = 0;
  std::uint32_t connections = 0;
  std::uint32_t chunks = 0;
};

class Lister {
 public:
  explicit Lister(ByteSource* source) : source_(*source), finder_(source) {}

  BagContents list(std::uint64_t from) {
    std::uint64_t at = from;
    while (at < source_.size()) {
      const std::optional<FileRecord> record = finder_.at(at);
      if (!record) {
        const std::uint64_t next = finder_.next(at + 1, source_.size());
        contents_.unread_bytes += next - at;
        at = next;
      } else {
        at = take(*record);
      }
    }
    conclude();
    return std::move(contents_);
  }

 private:
  // Returns where to go on.
  std::uint64_t take(const FileRecord& record) {
    if (record.fields.is(BagOp::kChunk)) return takeChunk(record);
    if (record.fields.is(BagOp::kBagHeader)) takeBagHeader(record.fields);
    if (record.fields.is(BagOp::kConnection)) contents_.connections.push_back(record);
    if (record.fields.is(BagOp::kChunkInfo)) takeInfo(record);
    return record.end();
  }

  // A chunk with a wrong length ends where no record begins, and hides the records behind it.
  std::uint64_t takeChunk(const FileRecord& record) {
    if (record.end() < source_.size() && !finder_.at(record.end())) {
      const std::uint64_t hidden = finder_.nextOutsideChunks(record.data, record.end());
      if (hidden < record.end()) {
        ++contents_.wrong_lengths;
        contents_.wrong_length_bytes += hidden - record.begin;
        return hidden;
      }
    }
    contents_.chunks.push_back(record);
    return record.end();
  }

  void takeBagHeader(const BagFields& fields) {
    promise_.index = fields.number<std::uint64_t>("index_pos").value_or(0);
    promise_.connections = fields.number<std::uint32_t>("conn_count").value_or(0);
    promise_.chunks = fields.number<std::uint32_t>("chunk_count").value_or(0);
  }

  void takeInfo(const FileRecord& record) {
    constexpr std::size_t kEntry = 2 * sizeof(std::uint32_t);
    const auto from = record.fields.number<std::uint64_t>("start_time");
    const auto to = record.fields.number<std::uint64_t>("end_time");
    const auto count = record.fields.number<std::uint32_t>("count");
    if (!from || !to || !count || record.size != *count * kEntry) return;
    std::vector<std::uint8_t> data(record.size);
    if (!source_.read(record.data, data.size(), data.data())) return;
    ChunkInfo info;
    info.span = {timeOf(*from), timeOf(*to)};
    for (std::size_t at = 0; at < data.size(); at += kEntry) {
      info.messages[readNumber<std::uint32_t>(data.data() + at)] +=
          readNumber<std::uint32_t>(data.data() + at + kEntry / 2);
    }
    contents_.infos.push_back(std::move(info));
  }

  // A recorder that closes a bag notes where the index begins; what was cut off since no longer holds it.
  void conclude() {
    const bool none = promise_.connections == 0 && promise_.chunks == 0;
    contents_.closed = promise_.index != 0 &&
                       (promise_.index < source_.size() || (none && promise_.index == source_.size()));
    std::set<std::uint32_t> named;
    for (const FileRecord& record : contents_.connections) {
      if (const auto id = record.fields.number<std::uint32_t>("conn")) named.insert(*id);
    }
    contents_.end_found = (contents_.closed || promise_.chunks > 0) &&
                          contents_.infos.size() == promise_.chunks && named.size() >= promise_.connections;
    contents_.bytes = contents_.end_found ? source_.size() : std::max(source_.size(), promise_.index);
  }

  ByteSource& source_;
  RecordFinder finder_;
  BagContents contents_;
  Promise promise_;
};

}  // namespace

double coveredTime(std::vector<TimeSpan> spans) {
  std::sort(spans.begin(), spans.end(),
            [](const TimeSpan& one, const TimeSpan& other) { return one.from < other.from; });
  double covered = 0.0;
  double reached = 0.0;
  for (std::size_t index = 0; index < spans.size(); ++index) {
    const double from = index == 0 ? spans[index].from : std::max(reached, spans[index].from);
    covered += std::max(0.0, spans[index].to - from);
    reached = index == 0 ? spans[index].to : std::max(reached, spans[index].to);
  }
  return covered;
}

BagContents listContents(ByteSource* source, std::uint64_t from) { return Lister(source).list(from); }

}  // namespace polyfly
