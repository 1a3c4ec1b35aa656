#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace polyfly::test {

/// Order of the fields in a record's header: rosbag in C++ sorts them by name, rosbag in Python begins with the kind.
enum class FieldOrder { kSorted, kKindFirst };

/// Writes bags of format 2.0 by hand, with all that recorders would not do.
class MadeBag {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using Fields = std::vector<std::pair<std::string, Bytes>>;

  /// `compression`: none, bz2 or lz4.
  explicit MadeBag(FieldOrder order = FieldOrder::kSorted, std::string compression = "none")
      : order_(order), compression_(std::move(compression)) {}

  /// Returns the number of the new connection. Its record stands in the present chunk.
  std::uint32_t connect(const std::string& topic, const std::string& type, const std::string& definition);
  void write(std::uint32_t connection, double time, const Bytes& bytes);
  void endChunk();
  /// The chunks stand in the file in another order from now on: the last one first.
  void reverseChunks();
  /// The whole file, closed by its recorder or not.
  Bytes bytes(bool closed = true);
  /// Place of each chunk's record in bytes(), and that of the first record behind its data.
  std::vector<std::pair<std::size_t, std::size_t>> chunkPlaces();

 private:
  struct Chunk {
    Bytes records;
    std::uint64_t first = 0;
    std::uint64_t last = 0;
    /// Messages by connection: times and places in the chunk.
    std::map<std::uint32_t, std::vector<std::pair<std::uint64_t, std::uint32_t>>> messages;
  };

  void append(Fields header, const Bytes& data, Bytes* to) const;
  Bytes bagHeader(std::uint64_t index, std::uint32_t connections, std::uint32_t chunks) const;
  Bytes chunkRecord(const Chunk& chunk) const;
  Bytes indexRecords(const Chunk& chunk) const;
  Bytes end(std::uint64_t begin) const;
  Bytes packed(const Bytes& data) const;

  FieldOrder order_;
  std::string compression_;
  std::vector<Chunk> chunks_;
  Chunk chunk_;
  /// Records of the connections, for the bag's end.
  Bytes connection_records_;
  std::uint32_t connections_ = 0;
};

/// Bytes of a message, field by field.
class MessageBytes {
 public:
  template <class Number>
  MessageBytes& put(Number value) {
    const auto* raw = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), raw, raw + sizeof value);
    return *this;
  }
  MessageBytes& text(const std::string& value) {
    put(static_cast<std::uint32_t>(value.size()));
    bytes.insert(bytes.end(), value.begin(), value.end());
    return *this;
  }
  MessageBytes& header(double stamp) {
    const auto seconds = static_cast<std::uint32_t>(stamp);
    put(std::uint32_t{0}).put(seconds);
    return put(static_cast<std::uint32_t>((stamp - seconds) * 1e9)).text("world");
  }
  std::vector<std::uint8_t> bytes;
};

}  // namespace polyfly::test
