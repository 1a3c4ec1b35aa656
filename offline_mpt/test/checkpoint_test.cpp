// Explorations that are stopped and resumed end with the bytes of one that was not; a checkpoint that is not
// whole or not the problem's is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "error_of.hpp"
#include "holds.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "random_program.hpp"
#include "region_maps/write_map.hpp"
#include "same_regions.hpp"
#include "scratch_folder.hpp"

// Compiles XXH64 into this file; nothing to link.
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace polyfly {
namespace {

constexpr std::size_t kHeader = 64, kFileSize = 16, kChecksum = 24, kRegionCount = 56;  // [bytes]

/// Where the numbers of each region begin in a checkpoint: radius, centre, law, half-spaces.
std::vector<std::size_t> placesOf(const std::string& file, const Partition& partition) {
  std::vector<std::size_t> places;
  for (const CriticalRegion& region : partition.regions) {
    for (std::size_t at = kHeader; at + sizeof region.radius <= file.size(); at += 2) {
      if (std::memcmp(file.data() + at, &region.radius, sizeof region.radius) == 0) places.push_back(at);
    }
  }
  std::sort(places.begin(), places.end());
  return places;
}

void addTo(std::string& file, std::size_t at, std::uint64_t added) {
  std::uint64_t value = 0;
  std::memcpy(&value, file.data() + at, sizeof value);
  value += added;
  std::memcpy(file.data() + at, &value, sizeof value);
}

/// Of a file that is shorter than one piece of the hash.
std::string withChecksum(std::string file) {
  std::string header = file.substr(0, kHeader);
  std::fill_n(header.begin() + kChecksum, sizeof(std::uint64_t), '\0');
  const std::uint64_t payload = XXH64(file.data() + kHeader, file.size() - kHeader, 0);
  const std::uint64_t checksum = XXH64(header.data(), header.size(), payload);
  std::memcpy(file.data() + kChecksum, &checksum, sizeof checksum);
  return file;
}

class Checkpoint : public ::testing::Test {
 protected:
  Checkpoint() { options_.checkpoint = folder_.file("x.map.checkpoint"); }

  // Explores up to `limit` regions, from the checkpoint if `resume`.
  Partition upTo(std::uint64_t limit, bool resume) {
    ExploreOptions options = options_;
    options.region_limit = limit;
    options.resume = resume;
    return explore(program_, options);
  }

  std::string refusal(const ParametricProgram& program, const ExploreOptions& options) {
    return errorOf([&] { explore(program, options); });
  }
  std::string refusal() {
    ExploreOptions options = options_;
    options.resume = true;
    return refusal(program_, options);
  }

  const ParametricProgram program_ = randomProgram(8, 24, 3, 5);
  const Partition whole_ = explore(program_);
  ScratchFolder folder_;
  ExploreOptions options_;
};

TEST_F(Checkpoint, ResumedAtAnyRegionGivesTheSameBytes) {
  const std::vector<std::byte> bytes = layOut(encode(program_, whole_));
  std::mt19937_64 random(3);
  for (int round = 0; round < 12; ++round) {
    options_.threads = 1 + round % 2;
    std::uint64_t cut = 1 + random() % (whole_.regions.size() - 1);
    Partition partition = upTo(cut, false);
    ASSERT_EQ(partition.status, ExploreStatus::kLimited);
    ASSERT_EQ(partition.regions.size(), cut);
    if (round % 3 == 0) {  // stopped twice
      cut += (whole_.regions.size() - cut) / 2;
      partition = upTo(cut, true);
    }
    options_.threads = 1 + round / 2 % 2;
    partition = upTo(whole_.regions.size() + 1, true);
    EXPECT_EQ(partition.stats.resumed_regions, cut);
    expectSameRegions(partition, whole_);
    EXPECT_EQ(layOut(encode(program_, partition)), bytes);
  }
}

TEST_F(Checkpoint, TheLimitCutsAtTheSameRegionForAnyThreads) {
  const std::uint64_t cut = whole_.regions.size() / 2;
  const Partition one = upTo(cut, false);
  const std::string saved = fileText(options_.checkpoint);
  options_.threads = 2;
  expectSameRegions(upTo(cut, false), one);
  EXPECT_EQ(fileText(options_.checkpoint), saved);
}

TEST_F(Checkpoint, InterruptedAnywhereGivesTheSameBytes) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 6; ++round) {
    std::atomic<bool> stop{false};
    int left = 1 + static_cast<int>(random() % 20);
    ExploreOptions options = options_;
    options.threads = 1 + round % 2;
    options.stop = &stop;
    options.progress = [&](const ExploreProgress&) { stop = --left <= 0; };
    const Partition part = explore(program_, options);
    if (part.status == ExploreStatus::kComplete) continue;  // another thread did all the work
    EXPECT_EQ(part.status, ExploreStatus::kInterrupted);
    expectSameRegions(upTo(whole_.regions.size() + 1, true), whole_);
  }
}

TEST_F(Checkpoint, SavedNowAndThenServesToo) {
  ExploreOptions options = options_;
  options.checkpoint_period = 1e-9;
  ASSERT_EQ(explore(program_, options).status, ExploreStatus::kComplete);
  ASSERT_EQ(folder_.names().size(), 1u);  // how much it holds, none to all, is the clock's choice
  expectSameRegions(upTo(whole_.regions.size() + 1, true), whole_);
  EXPECT_EQ(folder_.names().size(), 1u);
}

TEST_F(Checkpoint, MemoryLimitStops) {
  ExploreOptions options = options_;
  options.memory_limit = whole_.stats.memory_bytes / 2;
  const Partition part = explore(program_, options);
  EXPECT_EQ(part.status, ExploreStatus::kLimited);
  EXPECT_LT(part.regions.size(), whole_.regions.size());
  EXPECT_GE(part.stats.memory_bytes, options.memory_limit);
  expectSameRegions(upTo(whole_.regions.size() + 1, true), whole_);
}

TEST_F(Checkpoint, LimitBeforeTheFirstRegionLeavesNone) {
  const std::atomic<bool> stop{true};
  options_.stop = &stop;
  EXPECT_EQ(explore(program_, options_).status, ExploreStatus::kInterrupted);
  EXPECT_EQ(folder_.names().size(), 0u);
}

TEST_F(Checkpoint, RefusesEveryDamage) {
  upTo(40, false);
  const std::string bytes = fileText(options_.checkpoint);
  for (std::size_t i = 0; i < bytes.size(); i += i < 64 ? 1 : 97) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ (1 << i % 8));
    saveText(options_.checkpoint, damaged);
    EXPECT_TRUE(holds(refusal(), options_.checkpoint + ": ")) << "byte " << i;
  }
  for (const std::size_t size : {bytes.size() - 1, bytes.size() / 2, std::size_t{64}, std::size_t{10}}) {
    saveText(options_.checkpoint, bytes.substr(0, size));
    EXPECT_TRUE(holds(refusal(), options_.checkpoint + ": is")) << size << " bytes";
  }
  saveText(options_.checkpoint, bytes + std::string(8, '\0'));
  EXPECT_TRUE(holds(refusal(), "has grown"));
  saveText(options_.checkpoint, std::string(4096, 'x'));
  EXPECT_TRUE(holds(refusal(), "is no checkpoint"));
  std::filesystem::remove(options_.checkpoint);
  EXPECT_TRUE(holds(refusal(), options_.checkpoint));
}

// One bit of one number of one region: no sample would meet it.
TEST_F(Checkpoint, RefusesEachEditedNumber) {
  ASSERT_EQ(explore(program_, options_).status, ExploreStatus::kComplete);
  const std::string bytes = fileText(options_.checkpoint);
  ASSERT_EQ(withChecksum(bytes), bytes);
  const std::vector<std::size_t> places = placesOf(bytes, whole_);
  ASSERT_EQ(places.size(), whole_.regions.size());
  ASSERT_GE(places.size(), 64u);
  for (std::size_t k = 0; k + 1 < places.size(); k += 13) {
    const std::size_t end =
        places[k + 1] - 2 * sizeof(std::uint32_t);  // the next one's set and number of facets
    for (std::size_t at = places[k]; at < end; at += sizeof(double)) {
      std::string edited = bytes;
      addTo(edited, at, 1);
      saveText(options_.checkpoint, withChecksum(edited));
      EXPECT_TRUE(holds(refusal(), "gives another region")) << "region " << k;
    }
  }
}

TEST_F(Checkpoint, RefusesALostRegion) {
  ASSERT_EQ(explore(program_, options_).status, ExploreStatus::kComplete);
  const std::string bytes = fileText(options_.checkpoint);
  const std::vector<std::size_t> places = placesOf(bytes, whole_);
  for (const std::size_t k : {std::size_t{1}, places.size() / 2 + 1}) {
    std::string edited = bytes;
    const std::size_t size = places[k + 1] - places[k];
    edited.erase(places[k] - 2 * sizeof(std::uint32_t), size);
    addTo(edited, kFileSize, -size);
    addTo(edited, kRegionCount, std::uint64_t{0} - 1);
    saveText(options_.checkpoint, withChecksum(edited));
    EXPECT_TRUE(holds(refusal(), "gives another region")) << "region " << k;
  }
}

TEST_F(Checkpoint, RefusesAnotherProblem) {
  upTo(40, false);
  ExploreOptions options = options_;
  options.resume = true;
  ParametricProgram other = program_;
  other.b(3) = std::nextafter(other.b(3), 10.0);
  EXPECT_TRUE(holds(refusal(other, options), "belongs to another problem"));
  options.facet_tolerance *= 2.0;
  EXPECT_TRUE(holds(refusal(program_, options), "other tolerances"));
  ParametricProgram renamed = program_;
  renamed.name = "another name";
  options = options_;
  options.resume = true;
  expectSameRegions(explore(renamed, options), whole_);
}

TEST_F(Checkpoint, SaysWhereItCannotBeWritten) {
  options_.checkpoint = folder_.file("no/such/folder");
  options_.region_limit = 3;
  EXPECT_TRUE(holds(refusal(program_, options_), options_.checkpoint));

  // While it explores it goes on, and says so.
  ExploreOptions options = options_;
  options.region_limit = whole_.regions.size() + 1;
  options.checkpoint_period = 1e-9;
  bool unsaved = false;
  options.progress = [&](const ExploreProgress& state) { unsaved = unsaved || state.unsaved; };
  expectSameRegions(explore(program_, options), whole_);
  EXPECT_TRUE(unsaved);
}

}  // namespace
}  // namespace polyfly
