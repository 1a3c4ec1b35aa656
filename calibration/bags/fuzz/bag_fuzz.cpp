// libFuzzer target: any bytes are read to their end or refused, and so is every definition and message in
// them.

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>

#include "bags/message_layout.hpp"
#include "bags/scan_bag.hpp"
#include "polyfly_base/error.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::map<std::uint32_t, std::unique_ptr<polyfly::MessageLayout>> layouts;
  std::uint64_t handed = 0;
  polyfly::BagVisitor visitor;
  visitor.wants = [&layouts](const polyfly::BagConnection& connection) {
    try {
      layouts[connection.id] =
          std::make_unique<polyfly::MessageLayout>(connection.type, connection.definition);
    } catch (const polyfly::Error&) {
      layouts[connection.id] = nullptr;
    }
    return true;
  };
  visitor.message = [&](const polyfly::BagMessage& message) {
    ++handed;
    const auto& layout = layouts.at(message.connection->id);
    if (!layout) return;
    const bool fits = layout->fits(message.data, message.size);
    const auto numbers =
        layout->numbers(message.data, message.size, {"header.stamp", "data", "pose.position.x"});
    if (numbers.has_value() != fits) __builtin_trap();
  };
  try {
    const polyfly::BagHealth health = polyfly::scanBagBytes(data, size, "fuzz", visitor);
    if (health.messages != handed) __builtin_trap();
  } catch (const polyfly::Error&) {
    // Refused.
  }
  return 0;
}
