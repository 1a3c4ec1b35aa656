// Bags that are damaged on purpose, of both writers and all compressions: a damaged chunk costs that chunk only, and
// what was lost is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <tuple>

#include "bags/recording_share.hpp"
#include "bags/scan_bag.hpp"
#include "made_bag.hpp"

namespace polyfly {
namespace {

using test::FieldOrder;
using test::MadeBag;
using Bytes = MadeBag::Bytes;

constexpr std::uint64_t kChunks = 14;
constexpr std::uint64_t kPerChunk = 50;
constexpr double kPeriod = 0.01;  // [s]

MadeBag flight(FieldOrder order, const std::string& compression) {
  MadeBag bag(order, compression);
  const std::uint32_t one = bag.connect("/one", "test/Number", "float64 value\n");
  std::uint32_t other = 0;
  for (std::uint64_t message = 0; message < kChunks * kPerChunk; ++message) {
    // The second topic begins in the second chunk.
    if (message == kPerChunk) other = bag.connect("/other", "test/Number", "float64 value\n");
    const bool is_other = message > kPerChunk && message % 2 == 1;
    const auto value = static_cast<double>(message);
    bag.write(is_other ? other : one, 100.0 + kPeriod * value, test::MessageBytes().put(value).bytes);
    if (message % kPerChunk == kPerChunk - 1) bag.endChunk();
  }
  return bag;
}

BagHealth scan(const Bytes& bytes, std::map<std::string, std::uint64_t>* handed = nullptr) {
  BagVisitor visitor;
  if (handed != nullptr)
    visitor.message = [handed](const BagMessage& message) { ++(*handed)[message.connection->topic]; };
  return scanBagBytes(bytes.data(), bytes.size(), "made.bag", visitor);
}

std::string allRemarks(const BagHealth& health) {
  std::string all;
  for (const std::string& remark : health.remarks) all += remark + "\n";
  return all;
}

class DamagedBag : public testing::TestWithParam<std::tuple<FieldOrder, std::string>> {
 protected:
  MadeBag bag_ = flight(std::get<0>(GetParam()), std::get<1>(GetParam()));
  Bytes bytes_ = bag_.bytes();

  // Everything but the given number of chunks, and the shares that belong to it.
  static void expectLost(const Bytes& bytes, std::uint64_t chunks, const std::string& what) {
    std::map<std::string, std::uint64_t> handed;
    const BagHealth health = scan(bytes, &handed);
    const std::uint64_t left = (kChunks - chunks) * kPerChunk;
    EXPECT_EQ(health.messages, left) << what << "\n" << allRemarks(health);
    EXPECT_EQ(handed["/one"] + handed["/other"], left) << what;
    EXPECT_TRUE(health.end_found) << what;
    const RecordingShare share = recordingShare(health);
    EXPECT_NEAR(share.messages.share().value_or(-1.0),
                static_cast<double>(kChunks - chunks) / static_cast<double>(kChunks), 1e-12)
        << what;
    EXPECT_NEAR(share.seconds.share().value_or(-1.0),
                static_cast<double>(kChunks - chunks) / static_cast<double>(kChunks), 1e-6)
        << what;
    EXPECT_LT(share.bytes.share().value_or(2.0), 1.0 - 0.02 * static_cast<double>(chunks)) << what;
    EXPECT_FALSE(share.isWhole()) << what;
    EXPECT_NE(lossSentence(share).find("Parts of the recording are lost"), std::string::npos) << what;
    EXPECT_FALSE(health.remarks.empty()) << what;
    ASSERT_EQ(share.lost.size(), chunks) << what;
    EXPECT_GT(share.lost[0].to, share.lost[0].from) << what;
    EXPECT_NE(lossSentence(share).find(" Lost: "), std::string::npos) << what;
  }
};

TEST_P(DamagedBag, IsReadWholeWhereNothingIsDamaged) {
  std::map<std::string, std::uint64_t> handed;
  const BagHealth health = scan(bytes_, &handed);
  EXPECT_EQ(health.messages, kChunks * kPerChunk);
  EXPECT_EQ(handed["/one"] + handed["/other"], kChunks * kPerChunk);
  EXPECT_TRUE(health.remarks.empty()) << allRemarks(health);
  const RecordingShare share = recordingShare(health);
  EXPECT_EQ(share.messages.share(), 1.0);
  EXPECT_EQ(share.bytes.share(), 1.0);
  EXPECT_EQ(share.seconds.share(), 1.0);
  EXPECT_TRUE(lossSentence(share).empty());
  const RecordingShare one = recordingShare(health, {"/other"});
  EXPECT_EQ(one.messages.read, static_cast<double>(handed["/other"]));
  EXPECT_EQ(one.messages.recorded, static_cast<double>(handed["/other"]));
}

// The records of the connections stand in the first two chunks.
TEST_P(DamagedBag, LosesNoChunkBesideTheDamagedOne) {
  const auto places = bag_.chunkPlaces();
  for (const std::size_t chunk : {std::size_t{0}, std::size_t{1}, std::size_t{7}, kChunks - 1}) {
    const auto [begin, end] = places[chunk];
    Bytes bad = bytes_;
    // The length of a message, or packed data.
    const std::size_t middle = begin + (end - begin) / 2;
    for (std::size_t place = middle; place < middle + 40; ++place) bad[place] ^= 0x5a;
    expectLost(bad, 1, "data of chunk " + std::to_string(chunk));
  }
}

TEST_P(DamagedBag, LosesNoChunkBehindAWrongLength) {
  const auto places = bag_.chunkPlaces();
  for (const std::size_t chunk : {std::size_t{0}, std::size_t{5}}) {
    const auto [begin, end] = places[chunk];
    std::uint32_t header = 0;
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(begin), 4,
                reinterpret_cast<std::uint8_t*>(&header));
    const std::size_t length = begin + 4 + header;
    const auto right = static_cast<std::uint32_t>(end - length - 4);
    for (const std::uint32_t wrong : {right / 2, right + 5, 3 * right, 0x7fffffffU, 0xffffffffU}) {
      Bytes bad = bytes_;
      std::copy_n(reinterpret_cast<const std::uint8_t*>(&wrong), 4,
                  bad.begin() + static_cast<std::ptrdiff_t>(length));
      expectLost(bad, 1, "length " + std::to_string(wrong) + " of chunk " + std::to_string(chunk));
    }
    Bytes bad = bytes_;
    bad[begin + 1] ^= 0x40;
    expectLost(bad, 1, "header's length of chunk " + std::to_string(chunk));
  }
}

TEST_P(DamagedBag, IsReadWithItsChunksInAnyOrder) {
  bag_.reverseChunks();
  for (const bool closed : {true, false}) {
    const BagHealth health = scan(bag_.bytes(closed));
    EXPECT_EQ(health.messages, kChunks * kPerChunk) << allRemarks(health);
    EXPECT_EQ(health.end_found, closed);
    EXPECT_GT(health.out_of_order, 0u);
    EXPECT_EQ(recordingShare(health).isWhole(), closed);
  }
}

// Chunks that were put in another order by something that left the index as it was.
TEST_P(DamagedBag, IsReadWhereTheIndexIsOfAnotherOrder) {
  const auto places = bag_.chunkPlaces();
  Bytes moved(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(places.front().first));
  const auto copy = [&](std::size_t from, std::size_t to) {
    moved.insert(moved.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(from),
                 bytes_.begin() + static_cast<std::ptrdiff_t>(to));
  };
  const Bytes open = bag_.bytes(false);
  for (std::size_t chunk = kChunks; chunk-- > 0;)
    copy(places[chunk].first, chunk + 1 < kChunks ? places[chunk + 1].first : open.size());
  copy(open.size(), bytes_.size());
  ASSERT_EQ(moved.size(), bytes_.size());
  const BagHealth health = scan(moved);
  EXPECT_EQ(health.messages, kChunks * kPerChunk);
  EXPECT_TRUE(recordingShare(health).isWhole());
}

TEST_P(DamagedBag, IsNotWholeWhereItsEndIsMissing) {
  const auto places = bag_.chunkPlaces();
  const Bytes open = bag_.bytes(false);
  Bytes cut = bytes_;
  cut.resize(places[3].second);
  Bytes without_last_record = bytes_;
  without_last_record.resize(bytes_.size() - 1);
  for (const Bytes& bytes : {open, cut, without_last_record}) {
    const BagHealth health = scan(bytes);
    EXPECT_GE(health.messages, 4 * kPerChunk);
    EXPECT_FALSE(health.end_found);
    const RecordingShare share = recordingShare(health);
    EXPECT_FALSE(share.messages.share().has_value());
    EXPECT_FALSE(share.seconds.share().has_value());
    EXPECT_FALSE(share.isWhole());
    EXPECT_NE(lossSentence(share).find("The end of the recording is missing"), std::string::npos);
  }
  // A closed bag notes where its end began.
  EXPECT_LT(*recordingShare(scan(cut)).bytes.share(), 0.5);
}

// The bag's end names the connections even where no chunk that is left does.
TEST_P(DamagedBag, TellsWhenItsEndIsDamaged) {
  Bytes bad = bytes_;
  const std::size_t end = bag_.bytes(false).size();
  for (std::size_t place = end + 30; place < end + 40; ++place) bad[place] ^= 0x5a;
  const BagHealth health = scan(bad);
  EXPECT_EQ(health.messages, kChunks * kPerChunk);
  EXPECT_FALSE(health.end_found);
}

INSTANTIATE_TEST_SUITE_P(All, DamagedBag,
                         testing::Combine(testing::Values(FieldOrder::kSorted, FieldOrder::kKindFirst),
                                          testing::Values("none", "bz2", "lz4")),
                         [](const auto& test) {
                           return std::get<1>(test.param) +
                                  (std::get<0>(test.param) == FieldOrder::kSorted ? "Sorted" : "KindFirst");
                         });

TEST(RecordingShareText, FindsThePiecesOfRecordings) {
  using Groups = std::vector<std::vector<std::size_t>>;
  EXPECT_EQ(recordingsOf({{100.0, 160.0}}), (Groups{{0}}));
  // The pieces in any order, and another flight.
  EXPECT_EQ(recordingsOf({{160.1, 200.0}, {10.0, 50.0}, {100.0, 160.0}, {200.0, 210.0}}),
            (Groups{{1}, {2, 0, 3}}));
  // One flight twice, and flights on a clock that begins anew.
  EXPECT_EQ(recordingsOf({{100.0, 160.0}, {100.0, 160.0}}), (Groups{{0}, {1}}));
  EXPECT_EQ(recordingsOf({{0.0, 60.0}, {0.0, 61.0}, {62.5, 70.0}}), (Groups{{0}, {1}, {2}}));
}

// A file of nothing but the marks that are searched for.
TEST(DamagedBagText, IsSearchedInReasonableSteps) {
  const std::string magic = "#ROSBAG V2.0\n";
  Bytes bytes(magic.begin(), magic.end());
  const Bytes mark = {4, 0, 0, 0, 'o', 'p', '=', 5};
  for (int copy = 0; copy < 100000; ++copy) bytes.insert(bytes.end(), mark.begin(), mark.end());
  const BagHealth health = scan(bytes);
  EXPECT_EQ(health.messages, 0u);
  EXPECT_EQ(health.unread_bytes, bytes.size() - magic.size());
}

TEST(DamagedBagText, CountsInWords) {
  MadeBag bag = flight(FieldOrder::kSorted, "lz4");
  Bytes bad = bag.bytes();
  const auto damage = [&](std::size_t chunk) {
    for (std::size_t back = 50; back < 100; ++back) bad[bag.chunkPlaces()[chunk].second - back] ^= 0xff;
  };
  damage(0);
  EXPECT_EQ(allRemarks(scan(bad)), "1 of 14 chunks is damaged and was left out: it has damaged lz4 data\n");
  damage(1);
  EXPECT_EQ(allRemarks(scan(bad)),
            "2 of 14 chunks are damaged and were left out; the first one has damaged lz4 data\n");
}

}  // namespace
}  // namespace polyfly
