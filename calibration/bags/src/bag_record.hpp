#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "bags/packed_number.hpp"

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
    return readNumber<Number>(reinterpret_cast<const std::uint8_t*>(found->second.data()));
  }
  /// Whether the record is of this kind.
  bool is(BagOp op) const { return number<std::uint8_t>("op") == static_cast<std::uint8_t>(op); }

 private:
  std::map<std::string, std::string> fields_;
};

}  // namespace polyfly
