#include "bags/scan_bag.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "bag_contents.hpp"
#include "bag_record.hpp"
#include "byte_source.hpp"
#include "polyfly_base/error.hpp"
#include "unpack_chunk.hpp"

namespace polyfly {
namespace {

const std::string kMagic = "#ROSBAG V2.0\n";
const std::string kAnyVersion = "#ROSBAG V";
constexpr std::size_t kLength = sizeof(std::uint32_t);

class Scan {
 public:
  Scan(ByteSource* source, std::string name, const BagVisitor& visitor)
      : source_(*source), name_(std::move(name)), visitor_(visitor) {}

  BagHealth run() {
    list();
    findConnections();
    for (const FileRecord& chunk : contents_.chunks) {
      if (visitor_.progress)
        visitor_.progress(static_cast<double>(chunk.begin) / static_cast<double>(source_.size()));
      takeChunk(chunk);
    }
    if (visitor_.progress) visitor_.progress(1.0);
    conclude();
    remark();
    return std::move(health_);
  }

  TimeSpan times() {
    list();
    if (!contents_.end_found || contents_.infos.empty()) {
      const BagHealth health = run();
      return {health.first, health.last};
    }
    TimeSpan all = contents_.infos.front().span;
    for (const ChunkInfo& info : contents_.infos)
      all = {std::min(all.from, info.span.from), std::max(all.to, info.span.to)};
    return all;
  }

 private:
  void list() {
    checkMagic();
    contents_ = listContents(&source_, kMagic.size());
  }

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

  // The bag's end names all connections. Where it is damaged, a chunk may hold what the chunks before it need.
  void findConnections() {
    for (const FileRecord& record : contents_.connections) {
      packed_.resize(record.size);
      if (source_.read(record.data, record.size, packed_.data()))
        takeConnection(record.fields, packed_.data(), packed_.size());
    }
    if (contents_.end_found) return;
    for (const FileRecord& chunk : contents_.chunks) {
      if (!unpack(chunk).empty()) continue;
      eachRecord([this](const BagFields& fields, const std::uint8_t* data, std::size_t count) {
        if (fields.is(BagOp::kConnection)) takeConnection(fields, data, count);
      });
    }
  }

  // Returns what is wrong, or an empty string.
  std::string unpack(const FileRecord& chunk) {
    packed_.resize(chunk.size);
    if (!source_.read(chunk.data, chunk.size, packed_.data())) return "cannot be read";
    return unpackChunk(chunk.fields.text("compression").value_or(""), packed_.data(), packed_.size(),
                       chunk.fields.number<std::uint32_t>("size").value_or(0), &unpacked_);
  }

  void takeChunk(const FileRecord& chunk) {
    std::string failure = unpack(chunk);
    // Twice over: nothing of a chunk that breaks off in its middle is handed over.
    if (failure.empty() && !eachRecord([](const BagFields&, const std::uint8_t*, std::size_t) {})) {
      failure = "holds records that break the format";
    }
    if (!failure.empty()) {
      ++health_.damaged_chunks;
      damaged_bytes_ += chunk.end() - chunk.begin;
      if (reason_.empty()) reason_ = failure;
      return;
    }
    ++health_.chunks;
    span_.reset();
    eachRecord([this](const BagFields& fields, const std::uint8_t* data, std::size_t count) {
      if (fields.is(BagOp::kConnection)) takeConnection(fields, data, count);
      if (fields.is(BagOp::kMessage)) takeMessage(fields, data, count);
    });
    if (span_) spans_.push_back(*span_);
  }

  // Calls for each record of the unpacked chunk; false if they break the format.
  template <class Take>
  bool eachRecord(Take take) {
    std::size_t at = 0;
    const auto part = [this, &at](const std::uint8_t** data, std::size_t* size) {
      if (unpacked_.size() - at < kLength) return false;
      *size = readNumber<std::uint32_t>(unpacked_.data() + at);
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
    span_ = span_ ? TimeSpan{std::min(span_->from, time), std::max(span_->to, time)} : TimeSpan{time, time};
    ++health_.messages;
    ++health_.topics[found->second.connection.topic].read;
    if (found->second.wanted && visitor_.message) visitor_.message(message);
  }

  void conclude() {
    health_.indexed = contents_.closed;
    health_.end_found = contents_.end_found;
    health_.unread_bytes = contents_.unread_bytes;
    health_.damaged_chunks += contents_.wrong_lengths;
    health_.bytes = contents_.bytes;
    health_.bytes_read =
        source_.size() - contents_.unread_bytes - contents_.wrong_length_bytes - damaged_bytes_;
    health_.seconds_read = coveredTime(spans_);
    std::multiset<std::pair<double, double>> read;
    for (const TimeSpan& span : spans_) read.insert({span.from, span.to});
    for (const ChunkInfo& info : contents_.infos) {
      if (contents_.end_found) countRecorded(info);
      spans_.push_back(info.span);
      const auto one = read.find({info.span.from, info.span.to});
      if (one == read.end()) {
        health_.lost.push_back(info.span);
      } else {
        read.erase(one);
      }
    }
    health_.seconds = coveredTime(spans_);
  }

  void countRecorded(const ChunkInfo& info) {
    for (const auto& [id, count] : info.messages) {
      const auto found = connections_.find(id);
      const std::string topic = found == connections_.end() ? "" : found->second.connection.topic;
      health_.topics[topic].recorded += count;
    }
  }

  void say(const std::string& clause) { health_.remarks.push_back(clause); }

  void remark() {
    if (!health_.indexed) say("no index: the recording was not closed; all whole chunks were read");
    if (health_.unread_bytes > 0) {
      say(std::to_string(health_.unread_bytes) +
          " bytes are in no whole record (cut off or damaged) and were left out");
    }
    if (health_.damaged_chunks > 0) {
      say(std::to_string(health_.damaged_chunks) + " of " +
          std::to_string(health_.damaged_chunks + health_.chunks) + " chunks " +
          (health_.damaged_chunks == 1 ? "is damaged and was left out: it "
                                       : "are damaged and were left out; the first one ") +
          (reason_.empty() ? "has a wrong length" : reason_));
    }
    if (homeless_ > 0) {
      say(std::to_string(homeless_) + (homeless_ == 1 ? " message is" : " messages are") +
          " of no known topic and " + (homeless_ == 1 ? "was" : "were") + " left out");
    }
  }

  struct Known {
    BagConnection connection;
    bool wanted = false;
  };

  ByteSource& source_;
  std::string name_;
  const BagVisitor& visitor_;
  BagContents contents_;
  BagHealth health_;
  std::map<std::uint32_t, Known> connections_;
  // Data of a record.
  std::vector<std::uint8_t> packed_;
  // Unpacked data of a chunk.
  std::vector<std::uint8_t> unpacked_;
  // Times of the messages in the present chunk, and in all chunks that were read.
  std::optional<TimeSpan> span_;
  std::vector<TimeSpan> spans_;
  // Bytes of damaged chunks whose length is right.
  std::uint64_t damaged_bytes_ = 0;
  // Reason why the first damaged chunk was left out.
  std::string reason_;
  std::uint64_t homeless_ = 0;
  double before_ = 0.0;
};

}  // namespace

BagHealth scanBag(const std::string& path, const BagVisitor& visitor) {
  ByteSource source(path);
  return Scan(&source, path, visitor).run();
}

BagHealth scanBagBytes(const std::uint8_t* data, std::size_t size, const std::string& name,
                       const BagVisitor& visitor) {
  ByteSource source(data, size);
  return Scan(&source, name, visitor).run();
}

TimeSpan timesOf(const std::string& path) {
  ByteSource source(path);
  const BagVisitor nothing{[](const BagConnection&) { return false; }, {}, {}};
  return Scan(&source, path, nothing).times();
}

bool countsFromEpoch(double time) {
  constexpr double kEarliest = 1e8;     // [s]
  constexpr double kLatest = 4.1025e9;  // [s]
  return time > kEarliest && time < kLatest;
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
