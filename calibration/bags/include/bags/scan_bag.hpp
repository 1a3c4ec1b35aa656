#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace polyfly {

/// One publisher's topic in a bag.
struct BagConnection {
  std::uint32_t id = 0;
  std::string topic;
  /// Message type, for example nav_msgs/Odometry.
  std::string type;
  /// MD5 sum of the definition, as ROS computes it.
  std::string md5sum;
  /// Text of the message definition and of the definitions in it.
  std::string definition;
};

/// One recorded message. A view: valid during the call that hands it over.
struct BagMessage {
  const BagConnection* connection = nullptr;
  /// Receive time of the recorder, whole seconds [s].
  std::uint32_t seconds = 0;
  /// Receive time of the recorder, rest of the second [ns].
  std::uint32_t nanoseconds = 0;
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;

  double time() const { return seconds + 1e-9 * nanoseconds; }  ///< [s]
};

/// Messages of one topic.
struct TopicCount {
  std::uint64_t read = 0;
  /// By the bag's end; 0 where that is missing.
  std::uint64_t recorded = 0;
};

/// An interval of time, ends included [s].
struct TimeSpan {
  double from = 0.0;
  double to = 0.0;
};

/// What the file was like.
struct BagHealth {
  /// Messages in chunks that could be read, wanted or not.
  std::uint64_t messages = 0;
  /// Chunks that were read.
  std::uint64_t chunks = 0;
  /// Chunks that were left out. They cannot be unpacked, their length is wrong, or their records break the format.
  std::uint64_t damaged_chunks = 0;
  /// Bytes that were not read. They are at the cut-off end, or between chunks where the format is broken.
  std::uint64_t unread_bytes = 0;
  /// Messages that were received before the message that precedes them in the file.
  std::uint64_t out_of_order = 0;
  /// True: the recorder closed the file.
  bool indexed = false;
  /// True: the bag's end is there. It tells how many messages were recorded, and when.
  bool end_found = false;
  /// Messages by topic.
  std::map<std::string, TopicCount> topics;
  /// Size of the file. Where its end is missing, the least size that it had.
  std::uint64_t bytes = 0;
  /// Bytes in whole records, without damaged chunks.
  std::uint64_t bytes_read = 0;
  /// Time within chunks, with those that were not read as far as the bag's end tells of them [s].
  double seconds = 0.0;
  /// Time within the chunks that were read [s].
  double seconds_read = 0.0;
  /// Least time of a message [s].
  double first = 0.0;
  /// Greatest time of a message [s].
  double last = 0.0;
  /// The chunks that were not read, as far as the bag's end tells of them.
  std::vector<TimeSpan> lost;
  /// Every irregularity of the file, as a clause without its name.
  std::vector<std::string> remarks;
};

/// What is called while a bag is read. Empty functions are not called.
struct BagVisitor {
  std::function<bool(const BagConnection&)> wants;  ///< whether its messages are handed over; all if empty
  std::function<void(const BagMessage&)> message;
  std::function<void(double)> progress;  ///< share of the file that was read, 0..1
};

/// Reads a bag (format 2.0; chunks as they are, bz2 or lz4). The file is opened for reading only.
///
/// All connections are known before the first message comes: from the bag's end, or from all chunks where that is
/// damaged. Then each chunk is unpacked twice. Chunks that are damaged are left out and counted; a chunk that the
/// file's end cuts off is left out, as `rosbag reindex` does. Memory: one chunk, packed and unpacked. Messages come in
/// the file's order, which need not be that of time.
///
/// Throws Error naming the file: not there, empty, no bag, of another version.
BagHealth scanBag(const std::string& path, const BagVisitor& visitor);

/// The same for bytes in memory; `name` stands for the file.
BagHealth scanBagBytes(const std::uint8_t* data, std::size_t size, const std::string& name,
                       const BagVisitor& visitor);

/// From the least to the greatest time of a message [s]. Unpacks chunks only where the bag's end is damaged. Throws Error
/// as scanBag does.
TimeSpan timesOf(const std::string& path);

/// Time of a bag's first message as date and time of day (UTC, ISO 8601).
std::string isoTime(double seconds_since_1970);

/// Whether a time counts from 1970 rather than from a start of its own: it lies between 1973 and 2100 [s].
bool countsFromEpoch(double time);

}  // namespace polyfly
