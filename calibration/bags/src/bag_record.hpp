#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string>

namespace polyfly {

/// Kinds of records, field `op` of their header.
enum class BagOp : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7,
};

/// Little-endian number of the file; `data` must hold it.
template <class Number>
Number littleEndian(const std::uint8_t* data) {
  Number value = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) value |= static_cast<Number>(Number{data[i]} << (8 * i));
  return value;
}

/// Fields of a record's header: u32 length, then name=value, and again.
class BagFields {
 public:
  /// Nothing if the bytes break the format.
  static std::optional<BagFields> parse(const std::uint8_t* data, std::size_t size);

  std::optional<std::string> text(const std::string& name) const;
  template <class Number>
  std::optional<Number> number(const std::string& name) const {
    const auto found = fields_.find(name);
    if (found == fields_.end() || found->second.size() != sizeof(Number)) return std::nullopt;
    return littleEndian<Number>(reinterpret_cast<const std::uint8_t*>(found->second.data()));
  }
  /// Whether the record is of this kind.
  bool is(BagOp op) const { return number<std::uint8_t>("op") == static_cast<std::uint8_t>(op); }

 private:
  std::map<std::string, std::string> fields_;
};

}  // namespace polyfly
