#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "bag_record.hpp"
#include "byte_source.hpp"

namespace polyfly {

/// A record on the top level of a bag: its header in memory, its data still in the file.
struct FileRecord {
  BagFields fields;
  /// Place of the record in the file [bytes].
  std::uint64_t begin = 0;
  /// Place of the record's data in the file [bytes].
  std::uint64_t data = 0;
  /// Size of the record's data [bytes].
  std::uint64_t size = 0;

  std::uint64_t end() const { return data + size; }
};

/// Finds the records on the top level of a bag. The order of the fields in a header does not matter: rosbag in C++
/// sorts them, rosbag in Python does not.
class RecordFinder {
 public:
  explicit RecordFinder(ByteSource* source) : source_(*source) {}

  /// The record that begins here, or nothing if no whole record of the top level does.
  std::optional<FileRecord> at(std::uint64_t place);

  /// Place of the first whole record that begins in [from, to); `to` if there is none.
  std::uint64_t next(std::uint64_t from, std::uint64_t to);

  /// The same, of the records alone that cannot lie within a chunk: chunks and their index.
  std::uint64_t nextOutsideChunks(std::uint64_t from, std::uint64_t to);

 private:
  std::uint64_t search(std::uint64_t from, std::uint64_t to, bool outside_chunks);
  bool within(std::uint64_t from, std::uint64_t count) const;
  std::optional<std::uint32_t> lengthAt(std::uint64_t at);

  ByteSource& source_;
  std::vector<std::uint8_t> header_;
  std::vector<std::uint8_t> window_;
};

}  // namespace polyfly
