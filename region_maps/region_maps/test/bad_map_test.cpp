// What RegionMap must refuse: see ../fuzz/bad_maps.hpp for the files.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <set>

#include "bad_maps.hpp"
#include "error_of.hpp"
#include "holds.hpp"
#include "region_maps/format.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"
#include "scratch_folder.hpp"
#include "synthetic_map.hpp"

namespace polyfly {
namespace {

std::string refusal(const std::string& path, std::uint64_t most_bytes = kAnySize) {
  return errorOf([&] { RegionMap::open(path, most_bytes); });
}

std::string refusal(AlignedBytes& bytes) {
  return errorOf([&] { RegionMap::view(bytes.data(), bytes.size(), "some.map"); });
}

void expectRefused(const std::vector<BadMap>& maps) {
  const ScratchFolder folder;
  std::set<std::string> names;
  for (const BadMap& map : maps) {
    EXPECT_TRUE(names.insert(map.name).second) << map.name << " occurs twice";
    const std::string path = folder.save(map.name, map.bytes);
    const std::string text = refusal(path);
    EXPECT_EQ(text.find(path + ": "), 0u) << map.name << ": " << text;
    EXPECT_TRUE(holds(text, map.reason)) << map.name;
  }
}

TEST(BadMap, TheMapThatTheBadOnesComeFromIsGood) {
  AlignedBytes bytes(layOut(makeSmallMap()));
  EXPECT_EQ(refusal(bytes), "no error");
}

TEST(BadMap, RepairMakesAnUnchangedMapGood) {
  std::vector<std::byte> bytes = layOut(makeSmallMap());
  for (std::size_t i = 16; i < 32; ++i) bytes[i] = std::byte{0xee};
  repairFrame(bytes);
  EXPECT_EQ(bytes, layOut(makeSmallMap()));
}

TEST(BadMap, FrameIsChecked) { expectRefused(mapsWithBadFrame()); }

TEST(BadMap, EachRuleIsChecked) { expectRefused(mapsWithBadStructure()); }

TEST(BadMap, EveryTruncationIsRefused) {
  const ScratchFolder folder;
  const std::vector<std::byte> good = layOut(makeSmallMap());
  const std::string path = folder.save("cut.map", good);
  ASSERT_EQ(refusal(path), "no error");
  for (std::size_t size = good.size(); size-- > 0;) {
    std::filesystem::resize_file(path, size);
    const std::string text = refusal(path);
    ASSERT_EQ(text.find(path + ": is "), 0u) << size << " bytes: " << text;
  }
}

TEST(BadMap, EveryFlippedBitIsRefused) {
  AlignedBytes bytes(layOut(makeSmallMap()));
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    const std::byte mask = std::byte{1} << (bit % 8);
    bytes.data()[bit / 8] ^= mask;
    const std::string text = refusal(bytes);
    ASSERT_EQ(text.find("some.map: "), 0u) << "bit " << bit << ": " << text;
    bytes.data()[bit / 8] ^= mask;
  }
  EXPECT_EQ(refusal(bytes), "no error");
}

TEST(BadMap, EveryChangedByteOfALargerMapIsRefused) {
  TreeRecipe recipe;
  recipe.parameters = 4;
  recipe.regions = 20;
  AlignedBytes bytes(layOut(makeTreeMap(recipe)));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::byte old = bytes.data()[i];
    bytes.data()[i] ^= static_cast<std::byte>(1 + i % 255);
    ASSERT_NE(refusal(bytes), "no error") << "byte " << i;
    bytes.data()[i] = old;
  }
}

TEST(BadMap, MissingFile) {
  const ScratchFolder folder;
  const std::string path = folder.file("missing.map");
  EXPECT_EQ(refusal(path), path + ": cannot be opened: No such file or directory");
}

TEST(BadMap, Folder) {
  const ScratchFolder folder;
  const std::string path = folder.file("folder");
  std::filesystem::create_directory(path);
  EXPECT_EQ(refusal(path), path + ": is a directory, not a file");
}

TEST(BadMap, NamedPipeIsRefusedWithoutWaiting) {
  const ScratchFolder folder;
  const std::string path = folder.file("pipe");
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(refusal(path), path + ": is not a regular file");
}

// Files of 20 GB, of which the disk holds little: they are refused before memory is taken for them.
TEST(BadMap, HugeFilesCostNoMemory) {
  const ScratchFolder folder;
  constexpr std::uint64_t kHuge = 20'000'000'000;
  std::vector<std::byte> bytes = layOut(makeSmallMap());
  const std::string zeros = folder.save("zeros.map", {});
  std::filesystem::resize_file(zeros, kHuge);
  EXPECT_EQ(refusal(zeros), zeros + ": is unfinished: its writer was stopped");
  const std::string longer = folder.save("longer.map", bytes);
  std::filesystem::resize_file(longer, kHuge);
  EXPECT_EQ(refusal(longer),
            longer + ": is too long: 20000000000 bytes, the header says " + std::to_string(bytes.size()));
  std::memcpy(bytes.data() + offsetof(format::Header, file_size), &kHuge, sizeof(kHuge));
  const std::string claimed = folder.save("claimed.map", bytes);
  std::filesystem::resize_file(claimed, kHuge);
  EXPECT_EQ(refusal(claimed, kGreatestFlownMap),
            claimed + ": is too large for a node: 20000000000 bytes, at most 268435456");
}

}  // namespace
}  // namespace polyfly
