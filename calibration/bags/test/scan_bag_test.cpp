#include "bags/scan_bag.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>

#include "bags/message_layout.hpp"
#include "bags/recording_share.hpp"
#include "polyfly_base/error.hpp"
#include "reference_data.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

fs::path bags() { return referenceData("bags"); }

Bytes contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

struct Counts {
  BagHealth health;
  std::map<std::string, int> topics;
  int misfits = 0;  // messages that are not what their definition says
};

Counts countMessages(const fs::path& path) {
  Counts counts;
  std::map<std::string, MessageLayout> layouts;
  BagVisitor visitor;
  visitor.message = [&](const BagMessage& message) {
    ++counts.topics[message.connection->topic];
    auto layout = layouts.find(message.connection->md5sum);
    if (layout == layouts.end()) {
      const BagConnection& connection = *message.connection;
      layout =
          layouts.emplace(connection.md5sum, MessageLayout(connection.type, connection.definition)).first;
    }
    counts.misfits += layout->second.fits(message.data, message.size) ? 0 : 1;
  };
  counts.health = scanBag(path, visitor);
  return counts;
}

struct Expected {
  const char* file;
  std::uint64_t messages;
  bool indexed;
  std::uint64_t damaged_chunks;
};

class Bags : public testing::TestWithParam<Expected> {};

// Counts of another program: those of the data's README.
TEST_P(Bags, GivesTheCountsAndLeavesTheFileAsItIs) {
  if (bags().empty()) GTEST_SKIP() << "The bags are not here: set POLYFLY_DATA to their folder.";
  const fs::path path = bags() / GetParam().file;
  const Bytes before = contents(path);
  const Counts counts = countMessages(path);
  EXPECT_EQ(counts.health.messages, GetParam().messages);
  EXPECT_EQ(counts.health.indexed, GetParam().indexed);
  EXPECT_EQ(counts.health.damaged_chunks, GetParam().damaged_chunks);
  EXPECT_EQ(counts.misfits, 0);
  const TimeSpan times = timesOf(path);
  EXPECT_EQ(times.from, counts.health.first);
  EXPECT_EQ(times.to, counts.health.last);
  EXPECT_EQ(counts.health.remarks.empty(),
            GetParam().indexed && GetParam().damaged_chunks == 0 && counts.health.unread_bytes == 0);
  if (counts.health.remarks.empty()) {
    const RecordingShare share = recordingShare(counts.health);
    EXPECT_EQ(share.messages.recorded, static_cast<double>(counts.health.messages));
    EXPECT_EQ(share.bytes.share(), 1.0);
    EXPECT_EQ(share.seconds.share(), 1.0);
  }
  EXPECT_EQ(contents(path), before);
}

INSTANTIATE_TEST_SUITE_P(
    All, Bags,
    testing::Values(Expected{"odometry_scarab_bz2.bag", 463, true, 0},
                    Expected{"jay_2017-04-10-10-09-32.bag", 6896, true, 0},
                    Expected{"turtlesim_none.bag", 8647, true, 0},
                    Expected{"turtlesim_lz4.bag", 8647, true, 0},
                    Expected{"turtlesim_bz2.bag", 8647, true, 0}, Expected{"rosout_lz4.bag", 194, true, 0},
                    Expected{"tilt_laser_2chunks.bag", 4093, true, 0},
                    Expected{"roscomm_test.bag", 11, true, 0}, Expected{"empty_msgs.bag", 13, true, 0},
                    Expected{"constants.bag", 1, true, 0}, Expected{"unsorted_chunks.bag", 3, true, 0},
                    Expected{"no_messages.bag", 0, true, 0}, Expected{"unindexed_90byte.bag", 0, false, 0},
                    Expected{"damaged/jay_truncated_1200000.bag", 2748, false, 0},
                    Expected{"damaged/jay_truncated_700000.bag", 0, false, 0},
                    Expected{"damaged/scarab_index_pos_zero.bag", 463, false, 0},
                    Expected{"damaged/roscomm_header_only_4117.bag", 0, false, 0}),
    [](const auto& test) {
      std::string name = test.param.file;
      for (char& character : name) {
        if (std::isalnum(static_cast<unsigned char>(character)) == 0) character = '_';
      }
      return name;
    });

TEST(BagFile, CountsByTopic) {
  if (bags().empty()) GTEST_SKIP() << "The bags are not here: set POLYFLY_DATA to their folder.";
  const Counts odometry = countMessages(bags() / "odometry_scarab_bz2.bag");
  EXPECT_EQ(odometry.topics.at("/scarab1/odom"), 231);
  EXPECT_NEAR(odometry.health.last - odometry.health.first, 23.0, 1.0);
  EXPECT_EQ(isoTime(1358350266.2).substr(0, 10), "2013-01-16");
  const Counts jay = countMessages(bags() / "damaged" / "jay_truncated_1200000.bag");
  EXPECT_EQ(jay.topics.size(), 3u);
  int least = 1 << 30;
  int greatest = 0;
  for (const auto& [topic, count] : jay.topics) {
    least = std::min(least, count);
    greatest = std::max(greatest, count);
  }
  EXPECT_EQ(least, 382);
  EXPECT_EQ(greatest, 1984);
  EXPECT_GT(countMessages(bags() / "unsorted_chunks.bag").health.out_of_order, 0u);
}

TEST(BagFile, LeavesOutDamagedChunksAndSaysSo) {
  if (bags().empty()) GTEST_SKIP() << "The bags are not here: set POLYFLY_DATA to their folder.";
  for (const char* name : {"scarab_bz2_byte_flipped.bag", "turtlesim_lz4_byte_flipped.bag"}) {
    const Counts counts = countMessages(bags() / "damaged" / name);
    EXPECT_EQ(counts.health.damaged_chunks, 1u) << name;
    ASSERT_FALSE(counts.health.remarks.empty()) << name;
    EXPECT_NE(counts.health.remarks.back().find("damaged"), std::string::npos)
        << counts.health.remarks.back();
  }
}

std::string errorOf(const std::string& path) {
  try {
    scanBag(path, {});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(BagFile, RefusesWhatIsNoBag) {
  EXPECT_NE(errorOf("/nowhere/at.bag").find("/nowhere/at.bag: no such file"), std::string::npos);
  EXPECT_NE(errorOf("/").find("not a file"), std::string::npos);
  if (bags().empty()) GTEST_SKIP() << "The bags are not here: set POLYFLY_DATA to their folder.";
  EXPECT_NE(errorOf(bags() / "empty_file.bag").find("is empty"), std::string::npos);
  EXPECT_NE(errorOf(bags() / "README.md").find("is not a bag"), std::string::npos);
  EXPECT_NE(errorOf(bags() / "damaged" / "roscomm_wrong_version.bag").find("another version"),
            std::string::npos);
}

// Whatever stands in the file, it is read to its end or refused.
TEST(BagFile, SurvivesAnyByte) {
  if (bags().empty()) GTEST_SKIP() << "The bags are not here: set POLYFLY_DATA to their folder.";
  std::mt19937 random(1);
  for (const char* name :
       {"roscomm_test.bag", "rosout_lz4.bag", "odometry_scarab_bz2.bag", "empty_msgs.bag"}) {
    const Bytes good = contents(bags() / name);
    for (int round = 0; round < 150; ++round) {
      Bytes bad = good;
      auto place = std::uniform_int_distribution<std::size_t>(13, bad.size() - 1);
      for (int change = 0; change <= round % 4; ++change)
        bad[place(random)] ^= static_cast<std::uint8_t>(1U << (random() % 8));
      if (round % 5 == 0) bad.resize(place(random));
      BagVisitor visitor;
      std::uint64_t handed = 0;
      visitor.message = [&handed](const BagMessage&) { ++handed; };
      const BagHealth health = scanBagBytes(bad.data(), bad.size(), name, visitor);
      EXPECT_EQ(health.messages, handed);
    }
  }
}

}  // namespace
}  // namespace polyfly
