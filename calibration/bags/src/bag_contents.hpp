#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "bags/scan_bag.hpp"
#include "byte_source.hpp"
#include "record_finder.hpp"

namespace polyfly {

/// Time that lies in at least one of the intervals [s].
double coveredTime(std::vector<TimeSpan> spans);

/// What the bag's end says of a chunk.
struct ChunkInfo {
  TimeSpan span;
  /// Number of messages by connection.
  std::map<std::uint32_t, std::uint32_t> messages;
};

/// The records on the top level of a bag. Chunks are not unpacked.
struct BagContents {
  /// In the order of the file.
  std::vector<FileRecord> chunks;
  /// Connections outside of chunks: the end of a closed bag names all of them.
  std::vector<FileRecord> connections;
  std::vector<ChunkInfo> infos;
  /// Bytes in no whole record.
  std::uint64_t unread_bytes = 0;
  /// Bytes of chunks whose length is wrong.
  std::uint64_t wrong_length_bytes = 0;
  /// Number of chunks whose length is wrong. They are not among `chunks`.
  std::uint64_t wrong_lengths = 0;
  /// Whether the recorder closed the file.
  bool closed = false;
  /// Whether the bag's end names every connection and every chunk.
  bool end_found = false;
  /// Bytes of the file as it was closed, at least.
  std::uint64_t bytes = 0;
};

/// Lists what `source` holds behind its first `from` bytes. Where a record is damaged, the list goes on with the next
/// one that is whole.
BagContents listContents(ByteSource* source, std::uint64_t from);

}  // namespace polyfly
