#include "bag_record.hpp"

#include <algorithm>

namespace polyfly {

std::optional<BagFields> BagFields::parse(const std::uint8_t* data, std::size_t size) {
  BagFields fields;
  std::size_t at = 0;
  while (at < size) {
    if (size - at < sizeof(std::uint32_t)) return std::nullopt;
    const std::size_t length = readNumber<std::uint32_t>(data + at);
    at += sizeof(std::uint32_t);
    if (length > size - at) return std::nullopt;
    const auto* begin = reinterpret_cast<const char*>(data + at);
    const auto* end = begin + length;
    const auto* equals = std::find(begin, end, '=');
    if (equals == end) return std::nullopt;
    fields.fields_[std::string(begin, equals)] = std::string(equals + 1, end);
    at += length;
  }
  return fields;
}

std::optional<std::string> BagFields::text(const std::string& name) const {
  const auto found = fields_.find(name);
  if (found == fields_.end()) return std::nullopt;
  return found->second;
}

}  // namespace polyfly
