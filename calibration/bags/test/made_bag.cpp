#include "made_bag.hpp"

#include <utility>

namespace polyfly::test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Fields = std::vector<std::pair<std::string, Bytes>>;

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

void append(const Fields& header, const Bytes& data, Bytes* to) {
  for (const Bytes& part : {fieldsOf(header), data}) {
    const Bytes length = number(static_cast<std::uint32_t>(part.size()));
    to->insert(to->end(), length.begin(), length.end());
    to->insert(to->end(), part.begin(), part.end());
  }
}

}  // namespace

std::uint32_t MadeBag::connect(const std::string& topic, const std::string& type,
                               const std::string& definition) {
  const Bytes about = fieldsOf({{"topic", text(topic)},
                                {"type", text(type)},
                                {"md5sum", text(std::string(32, '0'))},
                                {"message_definition", text(definition)}});
  append({{"op", {7}}, {"conn", number(connections_)}, {"topic", text(topic)}}, about, &chunk_);
  return connections_++;
}

void MadeBag::write(std::uint32_t connection, double time, const Bytes& bytes) {
  const auto seconds = static_cast<std::uint32_t>(time);
  Bytes stamp = number(seconds);
  const Bytes rest = number(static_cast<std::uint32_t>((time - seconds) * 1e9));
  stamp.insert(stamp.end(), rest.begin(), rest.end());
  append({{"op", {2}}, {"conn", number(connection)}, {"time", stamp}}, bytes, &chunk_);
}

void MadeBag::endChunk() {
  if (chunk_.empty()) return;
  append({{"compression", text("none")},
          {"op", {5}},
          {"size", number(static_cast<std::uint32_t>(chunk_.size()))}},
         chunk_, &file_);
  chunk_.clear();
}

Bytes MadeBag::bytes(bool closed) {
  endChunk();
  Bytes all = text("#ROSBAG V2.0\n");
  const auto index = static_cast<std::uint64_t>(closed ? 1 : 0);  // not read, but for being there
  append({{"chunk_count", number(std::uint32_t{1})},
          {"conn_count", number(connections_)},
          {"index_pos", number(index)},
          {"op", {3}}},
         {}, &all);
  all.insert(all.end(), file_.begin(), file_.end());
  return all;
}

}  // namespace polyfly::test
