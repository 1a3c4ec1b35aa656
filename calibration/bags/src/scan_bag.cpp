#include "bags/scan_bag.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <optional>

#include "bag_record.hpp"
#include "byte_source.hpp"
#include "polyfly_base/error.hpp"
#include "unpack_chunk.hpp"

namespace polyfly {
namespace {

const std::string kMagic = "#ROSBAG V2.0\n";
const std::string kAnyVersion = "#ROSBAG V";
constexpr std::size_t kLength = sizeof(std::uint32_t);
constexpr std::uint64_t kGreatestHeader = std::uint64_t{1} << 20;  // bytes; a connection's is a few hundred
constexpr std::uint64_t kGreatestRecord = std::uint64_t{1} << 31;  // bytes
constexpr std::size_t kSearchWindow = std::size_t{1} << 16;  // bytes searched at once for the next chunk
const std::string kChunkMark = "compression=";               // first field of a chunk's header

// A record of the file: header in memory, data still there.
struct FileRecord {
  BagFields fields;
  // Place of the record's data in the file [bytes].
  std::uint64_t data = 0;
  // Size of the record's data [bytes].
  std::uint64_t size = 0;
};

class Scan {
 public:
  Scan(ByteSource* source, std::string name, const BagVisitor& visitor)
      : source_(*source), name_(std::move(name)), visitor_(visitor) {}

  BagHealth run() {
    checkMagic();
    std::uint64_t at = kMagic.size();
    while (at < source_.size()) {
      if (visitor_.progress) visitor_.progress(static_cast<double>(at) / static_cast<double>(source_.size()));
      const std::optional<FileRecord> record = recordAt(at);
      if (!record) {
        const std::uint64_t next = nextChunk(at + 1);
        health_.unread_bytes += next - at;
        at = next;
        continue;
      }
      take(*record);
      at = record->data + record->size;
    }
    if (visitor_.progress) visitor_.progress(1.0);
    remark();
    return std::move(health_);
  }

 private:
  void checkMagic() {
    if (source_.size() == 0) throw Error(name_ + ": is empty (0 bytes), not a bag");
    std::string begin(std::min<std::uint64_t>(kMagic.size(), source_.size()), '\0');
    if (!source_.read(0, begin.size(), reinterpret_cast<std::uint8_t*>(begin.data()))) {
      throw Error(name_ + ": cannot be read");
    }
    if (begin == kMagic) return;
    if (begin.compare(0, kAnyVersion.size(), kAnyVersion) == 0) {
      throw Error(name_ + ": is a bag of another version than 2.0: " + begin.substr(0, begin.find('\n')));
    }
    throw Error(name_ + ": is not a bag: it does not begin with #ROSBAG");
  }

  bool within(std::uint64_t from, std::uint64_t count) const {
    return from <= source_.size() && count <= source_.size() - from;
  }

  std::optional<std::uint32_t> lengthAt(std::uint64_t at) {
    std::array<std::uint8_t, kLength> bytes{};
    if (!within(at, kLength) || !source_.read(at, kLength, bytes.data())) return std::nullopt;
    return littleEndian<std::uint32_t>(bytes.data());
  }

  // Nothing if no whole record begins here.
  std::optional<FileRecord> recordAt(std::uint64_t at) {
    const std::optional<std::uint32_t> header = lengthAt(at);
    if (!header || *header > kGreatestHeader || !within(at + kLength, *header)) return std::nullopt;
    buffer_.resize(*header);
    if (!source_.read(at + kLength, *header, buffer_.data())) return std::nullopt;
    const std::optional<BagFields> fields = BagFields::parse(buffer_.data(), buffer_.size());
    if (!fields || !fields->number<std::uint8_t>("op")) return std::nullopt;
    const std::uint64_t data = at + kLength + *header + kLength;
    const std::optional<std::uint32_t> size = lengthAt(data - kLength);
    if (!size || *size > kGreatestRecord || !within(data, *size)) return std::nullopt;
    return FileRecord{*fields, data, *size};
  }

  // The place of the next record that looks like a chunk, or the end.
  std::uint64_t nextChunk(std::uint64_t from) {
    std::vector<std::uint8_t> window;
    const std::uint64_t lead = 2 * kLength;  // length of the header, and of its first field
    for (std::uint64_t at = from; within(at, lead + kChunkMark.size()); at += kSearchWindow) {
      const auto count = static_cast<std::size_t>(
          std::min<std::uint64_t>(kSearchWindow + lead + kChunkMark.size(), source_.size() - at));
      window.resize(count);
      if (!source_.read(at, count, window.data())) return source_.size();
      auto begin = window.begin();
      while (true) {
        const auto found = std::search(begin, window.end(), kChunkMark.begin(), kChunkMark.end());
        if (found == window.end()) break;
        const auto place = static_cast<std::uint64_t>(found - window.begin());
        if (place >= lead && recordAt(at + place - lead)) return at + place - lead;
        begin = found + 1;
      }
    }
    return source_.size();
  }

  void take(const FileRecord& record) {
    if (record.fields.is(BagOp::kBagHeader)) {
      takeBagHeader(record.fields);
    } else if (record.fields.is(BagOp::kBatch)) {
      takeChunk(record);
    } else if (record.fields.is(BagOp::kConnection)) {
      // The same as in the chunks, at the end of a bag that was closed: for topics without a chunk of their
      // own.
      packed_.resize(record.size);
      if (source_.read(record.data, record.size, packed_.data())) {
        takeConnection(record.fields, packed_.data(), packed_.size());
      }
    }
  }

  // A recorder that closes a bag notes where the index begins; what was cut off since no longer holds it.
  void takeBagHeader(const BagFields& fields) {
    const std::uint64_t index = fields.number<std::uint64_t>("index_pos").value_or(0);
    const bool none = fields.number<std::uint32_t>("conn_count").value_or(0) == 0 &&
                      fields.number<std::uint32_t>("chunk_count").value_or(0) == 0;
    health_.indexed = index != 0 && (index < source_.size() || (none && index == source_.size()));
  }

  void takeChunk(const FileRecord& record) {
    const std::string compression = record.fields.text("compression").value_or("");
    const std::uint32_t size = record.fields.number<std::uint32_t>("size").value_or(0);
    packed_.resize(record.size);
    std::string failure = "cannot be read";
    if (source_.read(record.data, record.size, packed_.data())) {
      failure = unpackChunk(compression, packed_.data(), packed_.size(), size, &unpacked_);
    }
    // Twice over: nothing of a chunk that breaks off in its middle is handed over.
    if (failure.empty() && !eachRecord([](const BagFields&, const std::uint8_t*, std::size_t) {})) {
      failure = "its records break the format";
    }
    if (!failure.empty()) {
      ++health_.damaged_chunks;
      if (reason_.empty()) reason_ = failure;
      return;
    }
    ++health_.chunks;
    eachRecord([this](const BagFields& fields, const std::uint8_t* data, std::size_t count) {
      if (fields.is(BagOp::kConnection)) takeConnection(fields, data, count);
      if (fields.is(BagOp::kMessage)) takeMessage(fields, data, count);
    });
  }

  // Calls for each record of the unpacked chunk; false if they break the format.
  template <class Take>
  bool eachRecord(Take take) {
    std::size_t at = 0;
    const auto part = [this, &at](const std::uint8_t** data, std::size_t* size) {
      if (unpacked_.size() - at < kLength) return false;
      *size = littleEndian<std::uint32_t>(unpacked_.data() + at);
      at += kLength;
      if (*size > unpacked_.size() - at) return false;
      *data = unpacked_.data() + at;
      at += *size;
      return true;
    };
    while (at < unpacked_.size()) {
      const std::uint8_t* header = nullptr;
      const std::uint8_t* data = nullptr;
      std::size_t header_size = 0;
      std::size_t size = 0;
      if (!part(&header, &header_size) || !part(&data, &size)) return false;
      const std::optional<BagFields> fields = BagFields::parse(header, header_size);
      if (!fields) return false;
      take(*fields, data, size);
    }
    return true;
  }

  void takeConnection(const BagFields& fields, const std::uint8_t* data, std::size_t size) {
    const std::optional<std::uint32_t> id = fields.number<std::uint32_t>("conn");
    const std::optional<BagFields> about = BagFields::parse(data, size);
    if (!id || !about || connections_.count(*id) > 0) return;
    Known known;
    known.connection.id = *id;
    known.connection.topic = fields.text("topic").value_or("");
    known.connection.type = about->text("type").value_or("");
    known.connection.md5sum = about->text("md5sum").value_or("");
    known.connection.definition = about->text("message_definition").value_or("");
    known.wanted = !visitor_.wants || visitor_.wants(known.connection);
    connections_.emplace(*id, std::move(known));
  }

  void takeMessage(const BagFields& fields, const std::uint8_t* data, std::size_t size) {
    const std::optional<std::uint32_t> id = fields.number<std::uint32_t>("conn");
    const std::optional<std::uint64_t> stamp = fields.number<std::uint64_t>("time");
    const auto found = id ? connections_.find(*id) : connections_.end();
    if (found == connections_.end() || !stamp) {
      ++homeless_;
      return;
    }
    BagMessage message;
    message.connection = &found->second.connection;
    message.seconds = static_cast<std::uint32_t>(*stamp & 0xffffffffU);
    message.nanoseconds = static_cast<std::uint32_t>(*stamp >> 32U);
    message.data = data;
    message.size = size;
    const double time = message.time();
    health_.first = health_.messages == 0 ? time : std::min(health_.first, time);
    health_.last = health_.messages == 0 ? time : std::max(health_.last, time);
    if (health_.messages > 0 && time < before_) ++health_.out_of_order;
    before_ = time;
    ++health_.messages;
    if (found->second.wanted && visitor_.message) visitor_.message(message);
  }

  void say(const std::string& sentence) { health_.remarks.push_back(sentence); }

  void remark() {
    if (!health_.indexed) say("has no index: its recording was not closed; all whole chunks were read");
    if (health_.unread_bytes > 0) {
      say(std::to_string(health_.unread_bytes) +
          " bytes are in no whole record (cut off or damaged) and were left out");
    }
    if (health_.damaged_chunks > 0) {
      say(std::to_string(health_.damaged_chunks) + " of " +
          std::to_string(health_.damaged_chunks + health_.chunks) +
          " chunks are damaged and were left out; the first one: " + reason_);
    }
    if (homeless_ > 0) say(std::to_string(homeless_) + " messages are of no known topic and were left out");
  }

  struct Known {
    BagConnection connection;
    bool wanted = false;
  };

  ByteSource& source_;
  std::string name_;
  const BagVisitor& visitor_;
  BagHealth health_;
  std::map<std::uint32_t, Known> connections_;
  // Header of a record.
  std::vector<std::uint8_t> buffer_;
  // Data of a record.
  std::vector<std::uint8_t> packed_;
  // Unpacked data of a chunk.
  std::vector<std::uint8_t> unpacked_;
  // Reason why the first damaged chunk was left out.
  std::string reason_;
  std::uint64_t homeless_ = 0;
  double before_ = 0.0;
};

}  // namespace

BagHealth scanBag(const std::string& path, const BagVisitor& visitor) {
  FileSource source(path);
  return Scan(&source, path, visitor).run();
}

BagHealth scanBagBytes(const std::uint8_t* data, std::size_t size, const std::string& name,
                       const BagVisitor& visitor) {
  MemorySource source(data, size);
  return Scan(&source, name, visitor).run();
}

std::string isoTime(double seconds_since_1970) {
  const auto whole = static_cast<std::time_t>(seconds_since_1970);
  std::tm parts{};
  gmtime_r(&whole, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

}  // namespace polyfly
