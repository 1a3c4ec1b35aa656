#include "bags/message_layout.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// A message with what makes layouts hard: strings, open and fixed arrays, types within types, constants,
// comments.
const char* const kDefinition = R"(
Header header   # first
uint8 KIND=3
string NAME=what = ever
float64[] angles
Point[2] corners
string label
Point at
bool good
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
================================================================================
MSG: test/Point
float32 x
int16 y
)";

class Writer {
 public:
  template <class Number>
  Writer& put(Number value) {
    std::uint8_t raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.insert(bytes.end(), raw, raw + sizeof value);
    return *this;
  }
  Writer& text(const std::string& value) {
    put(static_cast<std::uint32_t>(value.size()));
    bytes.insert(bytes.end(), value.begin(), value.end());
    return *this;
  }
  std::vector<std::uint8_t> bytes;
};

std::vector<std::uint8_t> message() {
  Writer writer;
  writer.put(std::uint32_t{7}).put(std::uint32_t{100}).put(std::uint32_t{500000000}).text("map");
  writer.put(std::uint32_t{3}).put(1.0).put(2.0).put(3.0);
  for (int i = 0; i < 2; ++i) writer.put(0.5F).put(std::int16_t{1});
  writer.text("a label").put(2.5F).put(std::int16_t{-4}).put(std::uint8_t{1});
  return writer.bytes;
}

TEST(MessageLayout, ReadsNumbersByPath) {
  const MessageLayout layout("test/Thing", kDefinition);
  const std::vector<std::uint8_t> bytes = message();
  ASSERT_TRUE(layout.fits(bytes.data(), bytes.size()));
  const auto values =
      layout.numbers(bytes.data(), bytes.size(),
                     {"header.stamp", "at.x", "at.y", "good", "label", "corners.x", "header.seq"});
  ASSERT_TRUE(values.has_value());
  EXPECT_DOUBLE_EQ((*values)[0], 100.5);
  EXPECT_DOUBLE_EQ((*values)[1], 2.5);
  EXPECT_DOUBLE_EQ((*values)[2], -4.0);
  EXPECT_DOUBLE_EQ((*values)[3], 1.0);
  EXPECT_TRUE(std::isnan((*values)[4]));
  EXPECT_TRUE(std::isnan((*values)[5]));
  EXPECT_DOUBLE_EQ((*values)[6], 7.0);
  EXPECT_TRUE(layout.has("header.stamp"));
  EXPECT_TRUE(layout.has("at.y"));
  EXPECT_FALSE(layout.has("at"));
  EXPECT_FALSE(layout.has("label"));
  EXPECT_FALSE(layout.has("corners.x"));
}

TEST(MessageLayout, RefusesBytesThatEndEarlyOrLate) {
  const MessageLayout layout("test/Thing", kDefinition);
  std::vector<std::uint8_t> bytes = message();
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(layout.fits(bytes.data(), size)) << size;
  bytes.push_back(0);
  EXPECT_FALSE(layout.fits(bytes.data(), bytes.size()));
}

TEST(MessageLayout, RefusesAnArrayLongerThanTheMessage) {
  const MessageLayout layout("test/Thing", kDefinition);
  std::vector<std::uint8_t> bytes = message();
  constexpr std::size_t kCount = 4 + 8 + 4 + 3;  // before the length of the array
  for (const std::uint32_t count : {4U, 1000U, 0x20000000U, 0xffffffffU}) {
    std::memcpy(bytes.data() + kCount, &count, sizeof count);
    EXPECT_FALSE(layout.fits(bytes.data(), bytes.size())) << count;
    EXPECT_FALSE(layout.numbers(bytes.data(), bytes.size(), {"at.x"}).has_value());
  }
}

TEST(MessageLayout, RefusesBadDefinitions) {
  EXPECT_THROW(MessageLayout("test/A", "Unknown thing\n"), Error);
  EXPECT_THROW(MessageLayout("test/A", "float64\n"), Error);
  EXPECT_THROW(MessageLayout("test/A", "float64[x] a\n"), Error);
  EXPECT_THROW(MessageLayout("test/A", "float64[99999999999] a\n"), Error);
  EXPECT_THROW(MessageLayout("test/A", "B b\n===\nMSG: test/B\nB b\n"), Error);
  EXPECT_NO_THROW(MessageLayout("std_msgs/Empty", ""));
}

// Counts of elements that have no bytes must not be walked one by one.
TEST(MessageLayout, IsNotHeldUpByElementsWithoutBytes) {
  const MessageLayout layout("test/A", "Nothing[] many\n===\nMSG: test/Nothing\n");
  const std::vector<std::uint8_t> bytes = {0xff, 0xff, 0xff, 0xff};
  EXPECT_TRUE(layout.fits(bytes.data(), bytes.size()));
}

}  // namespace
}  // namespace polyfly
