#include "made_bag.hpp"

#include <bzlib.h>
#include <lz4frame.h>

#include <algorithm>
#include <stdexcept>

namespace polyfly::test {
namespace {

using Bytes = MadeBag::Bytes;
using Fields = MadeBag::Fields;

const std::string kMagic = "#ROSBAG V2.0\n";

template <class Number>
Bytes number(Number value) {
  return MessageBytes().put(value).bytes;
}

Bytes text(const std::string& value) { return {value.begin(), value.end()}; }

Bytes fieldsOf(const Fields& fields) {
  MessageBytes all;
  for (const auto& [name, value] : fields) {
    all.put(static_cast<std::uint32_t>(name.size() + 1 + value.size()));
    all.bytes.insert(all.bytes.end(), name.begin(), name.end());
    all.bytes.push_back('=');
    all.bytes.insert(all.bytes.end(), value.begin(), value.end());
  }
  return all.bytes;
}

void add(const Bytes& more, Bytes* to) { to->insert(to->end(), more.begin(), more.end()); }

}  // namespace

void MadeBag::append(Fields header, const Bytes& data, Bytes* to) const {
  std::sort(header.begin(), header.end());
  if (order_ == FieldOrder::kKindFirst) {
    const auto kind =
        std::find_if(header.begin(), header.end(), [](const auto& field) { return field.first == "op"; });
    std::rotate(header.begin(), kind, kind + 1);
  }
  for (const Bytes& part : {fieldsOf(header), data}) {
    add(number(static_cast<std::uint32_t>(part.size())), to);
    add(part, to);
  }
}

std::uint32_t MadeBag::connect(const std::string& topic, const std::string& type,
                               const std::string& definition) {
  const Bytes about = fieldsOf({{"topic", text(topic)},
                                {"type", text(type)},
                                {"md5sum", text(std::string(32, '0'))},
                                {"message_definition", text(definition)}});
  const Fields header = {{"op", {7}}, {"conn", number(connections_)}, {"topic", text(topic)}};
  append(header, about, &chunk_.records);
  append(header, about, &connection_records_);
  return connections_++;
}

void MadeBag::write(std::uint32_t connection, double time, const Bytes& bytes) {
  const auto seconds = static_cast<std::uint32_t>(time);
  const auto rest = static_cast<std::uint32_t>((time - seconds) * 1e9);
  const std::uint64_t stamp = (std::uint64_t{rest} << 32U) | seconds;
  if (chunk_.messages.empty()) chunk_.first = stamp;
  chunk_.last = stamp;
  chunk_.messages[connection].emplace_back(stamp, static_cast<std::uint32_t>(chunk_.records.size()));
  append({{"op", {2}}, {"conn", number(connection)}, {"time", number(stamp)}}, bytes, &chunk_.records);
}

void MadeBag::endChunk() {
  if (chunk_.records.empty()) return;
  chunks_.push_back(std::exchange(chunk_, {}));
}

void MadeBag::reverseChunks() {
  endChunk();
  std::reverse(chunks_.begin(), chunks_.end());
}

Bytes MadeBag::packed(const Bytes& data) const {
  if (compression_ == "none") return data;
  if (compression_ == "lz4") {
    Bytes out(LZ4F_compressFrameBound(data.size(), nullptr));
    out.resize(LZ4F_compressFrame(out.data(), out.size(), data.data(), data.size(), nullptr));
    return out;
  }
  constexpr unsigned kLeastRoom = 600;
  Bytes out(data.size() + data.size() / 100 + kLeastRoom);
  auto length = static_cast<unsigned>(out.size());
  auto* source = const_cast<char*>(reinterpret_cast<const char*>(data.data()));
  if (BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(out.data()), &length, source,
                               static_cast<unsigned>(data.size()), 9, 0, 0) != BZ_OK) {
    throw std::runtime_error("a chunk could not be packed");
  }
  out.resize(length);
  return out;
}

Bytes MadeBag::chunkRecord(const Chunk& chunk) const {
  Bytes out;
  append({{"compression", text(compression_)},
          {"op", {5}},
          {"size", number(static_cast<std::uint32_t>(chunk.records.size()))}},
         packed(chunk.records), &out);
  return out;
}

Bytes MadeBag::indexRecords(const Chunk& chunk) const {
  Bytes out;
  for (const auto& [connection, messages] : chunk.messages) {
    MessageBytes entries;
    for (const auto& [stamp, place] : messages) entries.put(stamp).put(place);
    append({{"op", {4}},
            {"ver", number(std::uint32_t{1})},
            {"conn", number(connection)},
            {"count", number(static_cast<std::uint32_t>(messages.size()))}},
           entries.bytes, &out);
  }
  return out;
}

Bytes MadeBag::bagHeader(std::uint64_t index, std::uint32_t connections, std::uint32_t chunks) const {
  Bytes out;
  append({{"chunk_count", number(chunks)},
          {"conn_count", number(connections)},
          {"index_pos", number(index)},
          {"op", {3}}},
         {}, &out);
  return out;
}

Bytes MadeBag::end(std::uint64_t begin) const {
  Bytes out = connection_records_;
  for (const Chunk& chunk : chunks_) {
    MessageBytes counts;
    for (const auto& [connection, messages] : chunk.messages)
      counts.put(connection).put(static_cast<std::uint32_t>(messages.size()));
    append({{"op", {6}},
            {"ver", number(std::uint32_t{1})},
            {"chunk_pos", number(begin)},
            {"start_time", number(chunk.first)},
            {"end_time", number(chunk.last)},
            {"count", number(static_cast<std::uint32_t>(chunk.messages.size()))}},
           counts.bytes, &out);
    begin += chunkRecord(chunk).size() + indexRecords(chunk).size();
  }
  return out;
}

Bytes MadeBag::bytes(bool closed) {
  endChunk();
  Bytes body;
  for (const Chunk& chunk : chunks_) {
    add(chunkRecord(chunk), &body);
    add(indexRecords(chunk), &body);
  }
  const std::uint64_t begin = kMagic.size() + bagHeader(0, 0, 0).size();
  Bytes all = text(kMagic);
  const auto chunks = static_cast<std::uint32_t>(chunks_.size());
  add(closed ? bagHeader(begin + body.size(), connections_, chunks) : bagHeader(0, 0, 0), &all);
  add(body, &all);
  if (closed) add(end(begin), &all);
  return all;
}

std::vector<std::pair<std::size_t, std::size_t>> MadeBag::chunkPlaces() {
  endChunk();
  std::vector<std::pair<std::size_t, std::size_t>> places;
  std::size_t at = kMagic.size() + bagHeader(0, 0, 0).size();
  for (const Chunk& chunk : chunks_) {
    const std::size_t size = chunkRecord(chunk).size();
    places.emplace_back(at, at + size);
    at += size + indexRecords(chunk).size();
  }
  return places;
}

}  // namespace polyfly::test
