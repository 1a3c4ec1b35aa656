#include "region_maps/write_map.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <utility>

#include "error_of.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/file_draft.hpp"
#include "polyfly_base/write_file.hpp"
#include "region_maps/map_image.hpp"
#include "scratch_folder.hpp"
#include "synthetic_map.hpp"

namespace polyfly {
namespace {

using Bytes = std::vector<std::byte>;

/// XXH64 as its specification has it, for whole inputs with seed 0: the oracle of the checksum.
class ReferenceHash {
 public:
  static std::uint64_t of(const Bytes& bytes) {
    const std::size_t n = bytes.size();
    std::size_t at = 0;
    std::uint64_t hash = kPrime5;
    if (n >= 32) {
      std::uint64_t lane[4] = {kPrime1 + kPrime2, kPrime2, 0, 0 - kPrime1};
      for (; at + 32 <= n; at += 32) {
        for (std::size_t i = 0; i < 4; ++i) lane[i] = round(lane[i], little(bytes, at + 8 * i, 8));
      }
      hash = turn(lane[0], 1) + turn(lane[1], 7) + turn(lane[2], 12) + turn(lane[3], 18);
      for (const std::uint64_t value : lane) hash = (hash ^ round(0, value)) * kPrime1 + kPrime4;
    }
    hash += n;
    for (; at + 8 <= n; at += 8) hash = turn(hash ^ round(0, little(bytes, at, 8)), 27) * kPrime1 + kPrime4;
    for (; at + 4 <= n; at += 4) hash = turn(hash ^ (little(bytes, at, 4) * kPrime1), 23) * kPrime2 + kPrime3;
    for (; at < n; ++at) hash = turn(hash ^ (little(bytes, at, 1) * kPrime5), 11) * kPrime1;
    hash = (hash ^ (hash >> 33)) * kPrime2;
    hash = (hash ^ (hash >> 29)) * kPrime3;
    return hash ^ (hash >> 32);
  }

  static std::uint64_t little(const Bytes& bytes, std::size_t at, std::size_t count) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i) value |= std::to_integer<std::uint64_t>(bytes[at + i]) << (8 * i);
    return value;
  }

 private:
  static constexpr std::uint64_t kPrime1 = 0x9E3779B185EBCA87u;
  static constexpr std::uint64_t kPrime2 = 0xC2B2AE3D27D4EB4Fu;
  static constexpr std::uint64_t kPrime3 = 0x165667B19E3779F9u;
  static constexpr std::uint64_t kPrime4 = 0x85EBCA77C2B2AE63u;
  static constexpr std::uint64_t kPrime5 = 0x27D4EB2F165667C5u;

  static std::uint64_t turn(std::uint64_t value, int bits) {
    return (value << bits) | (value >> (64 - bits));
  }
  static std::uint64_t round(std::uint64_t lane, std::uint64_t value) {
    return turn(lane + value * kPrime2, 31) * kPrime1;
  }
};

double numberAt(const Bytes& bytes, std::size_t at) {
  const std::uint64_t bits = ReferenceHash::little(bytes, at, 8);
  double value = 0.0;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

TEST(ReferenceHash, KnowsThePublishedValueOfNothing) {
  EXPECT_EQ(ReferenceHash::of({}), 0xEF46DB3751D8E999u);
}

TEST(LayOut, FollowsFormatMd) {
  const MapContent map = makeSmallMap();
  const Bytes bytes = layOut(map);
  const auto u32 = [&](std::size_t at) { return ReferenceHash::little(bytes, at, 4); };
  const auto u64 = [&](std::size_t at) { return ReferenceHash::little(bytes, at, 8); };
  EXPECT_EQ(std::memcmp(bytes.data(), "PFLYMAP\n", 8), 0);
  EXPECT_EQ(std::to_integer<int>(bytes[8]), 4);  // little-endian 0x01020304
  EXPECT_EQ(u32(12), 2u);
  EXPECT_EQ(u64(16), bytes.size());
  Bytes blank;
  for (std::size_t i = 0; i < bytes.size(); ++i) blank.push_back(i >= 24 && i < 32 ? std::byte{0} : bytes[i]);
  EXPECT_EQ(u64(24), ReferenceHash::of(blank));
  EXPECT_EQ(u32(32), 2u);
  EXPECT_EQ(u32(36), 1u);
  EXPECT_EQ(u32(40), map.root);
  EXPECT_EQ(u32(44), 11u);
  EXPECT_EQ(numberAt(bytes, 48), 0.125);
  EXPECT_EQ(numberAt(bytes, 56), 1e-8);
  // Every path has two nodes.
  EXPECT_EQ(u32(64), 2u);
  // One square has four sides.
  EXPECT_EQ(u32(68), 4u);
  // Two nodes, four sides and one law take two multiply-adds each.
  EXPECT_EQ(u64(72), (2u + 4 + 1) * 2);
  EXPECT_EQ(u64(80), 0u);
  EXPECT_EQ(u64(88), 0u);
  MapContent reduced = map;
  reduced.reduced_from = 0x123456789abcdefu;
  const Bytes reduced_bytes = layOut(reduced);
  EXPECT_EQ(ReferenceHash::little(reduced_bytes, 80, 8), reduced.reduced_from);
  EXPECT_EQ(ReferenceHash::little(reduced_bytes, 88, 8), 0u);
  const std::size_t elements[] = {u64(104), 3, 6, 4, 4, 16, map.active.size(), 3, 4, 4, 4};
  const std::size_t sizes[] = {1, 16, 24, 24, 20, 4, 4, 12, 8, 4, 4};
  std::size_t end = 272;
  for (std::size_t i = 0; i < 11; ++i) {
    const std::size_t offset = (end + 63) / 64 * 64;
    EXPECT_EQ(u64(96 + 16 * i), offset) << "section " << i;
    EXPECT_EQ(u64(104 + 16 * i), elements[i]) << "section " << i;
    end = offset + elements[i] * sizes[i];
  }
  EXPECT_EQ(bytes.size(), (end + 63) / 64 * 64);
  EXPECT_EQ(std::memcmp(bytes.data() + 320, "small\0name: small\n", 18), 0);
  const std::size_t bounds = u64(112);
  EXPECT_EQ(numberAt(bytes, bounds + 24), 2.0);  // greatest value of the second parameter
  const std::size_t nodes = u64(96 + 16 * 7);
  EXPECT_EQ(u32(nodes), map.nodes[0].plane);
  EXPECT_EQ(u32(nodes + 4), map.nodes[0].below);
  EXPECT_EQ(u32(nodes + 8), map.nodes[0].above);
  EXPECT_EQ(u32(u64(96 + 16 * 10)), 0xfu);  // all sides of the first square
}

TEST(LayOut, GivesTheSameBytesForTheSameContent) {
  TreeRecipe recipe;
  EXPECT_EQ(layOut(makeTreeMap(recipe)), layOut(makeTreeMap(recipe)));
  recipe.seed = 2;
  EXPECT_NE(layOut(makeTreeMap(recipe)), layOut(makeTreeMap({})));
}

TEST(LayOut, RefusesContentThatBreaksARule) {
  const struct {
    const char* reason;
    std::function<void(MapContent&)> change;
  } cases[] = {
      {"small: parameters: must be 1 to 256, got 0", [](MapContent& m) { m.parameters.clear(); }},
      {"small: inputs: must be 1 to 256, got 0", [](MapContent& m) { m.inputs.clear(); }},
      {"small: planes: must hold p + 1 numbers each", [](MapContent& m) { m.planes.pop_back(); }},
      {"small: laws: must hold m rows of p + 1", [](MapContent& m) { m.laws.push_back(0.0); }},
      {"small: solver notes: holds a zero byte", [](MapContent& m) { m.solver_notes.push_back('\0'); }},
      {"small: unit of a signal: holds a zero byte", [](MapContent& m) { m.inputs[0].unit.push_back('\0'); }},
      {"small: parameter 1: name theta_0 occurs twice",
       [](MapContent& m) { m.parameters[1].name = "theta_0"; }},
      {"small: parameter 0: lower must not exceed", [](MapContent& m) { m.parameters[0].lower = 5.0; }},
      {"small: section planes 0: holds a number that is not finite",
       [](MapContent& m) { m.planes[0] = std::numeric_limits<double>::quiet_NaN(); }},
      {"small: region 2: law 9 does not exist", [](MapContent& m) { m.regions[2].law = 9; }},
      {"small: node 0: node 7 does not exist", [](MapContent& m) { m.nodes[0].above = 7; }},
      {"small: section laws: must not be empty", [](MapContent& m) { m.laws.clear(); }},
      {"small: section leaves: must not be empty", [](MapContent& m) { m.leaves.clear(); }},
      {"small: leaf 3: more than 2^32 - 1 half-spaces",
       [](MapContent& m) {
         m.rows.resize(70'000, 1);
         m.regions[0] = {0, 70'000, 0, 0, 0};
         m.candidates.resize(70'000, 0);
         m.tests.clear();
         m.leaves[3] = {0, 70'000};
       }},
      {"region map: header: period must be finite",
       [](MapContent& m) {
         m.name.clear();
         m.period = -1.0;
       }},
  };
  for (const auto& test : cases) {
    MapContent map = makeSmallMap();
    test.change(map);
    EXPECT_EQ(errorOf([&] { layOut(map); }).rfind(test.reason, 0), 0u) << test.reason;
  }
}

TEST(WriteMap, WritesTheBytesAndNothingElse) {
  const ScratchFolder folder;
  writeMap(makeSmallMap(), folder.file("a.map"));
  EXPECT_EQ(readBytes(folder.file("a.map")), layOut(makeSmallMap()));
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.map"});
  struct stat info = {};
  ASSERT_EQ(::stat(folder.file("a.map").c_str(), &info), 0);
  EXPECT_NE(info.st_mode & S_IRUSR, 0u);
}

TEST(WriteMap, ReplacesAnOldFile) {
  const ScratchFolder folder;
  const std::string path = folder.save("a.map", Bytes(100'000, std::byte{7}));
  writeMap(makeSmallMap(), path);
  EXPECT_EQ(readBytes(path), layOut(makeSmallMap()));
  EXPECT_EQ(folder.names().size(), 1u);
}

TEST(WriteMap, BadContentLeavesTheOldFile) {
  const ScratchFolder folder;
  const Bytes old(10, std::byte{7});
  const std::string path = folder.save("a.map", old);
  MapContent map = makeSmallMap();
  map.root = 99;
  EXPECT_THROW(writeMap(map, path), Error);
  EXPECT_EQ(readBytes(path), old);
  EXPECT_EQ(folder.names().size(), 1u);
}

std::string writeError(const std::string& path, const Bytes& bytes) {
  return errorOf([&] { writeFileAtomically(path, bytes); });
}

TEST(WriteFileAtomically, WritesShortAndEmptyFiles) {
  const ScratchFolder folder;
  for (const std::size_t size : {0u, 1u, 63u, 64u, 65u, 200u}) {
    const Bytes bytes(size, std::byte{3});
    writeFileAtomically(folder.file("short"), bytes);
    EXPECT_EQ(readBytes(folder.file("short")), bytes);
  }
}

TEST(WriteFileAtomically, WritesIntoTheWorkingFolder) {
  const ScratchFolder folder;
  const auto old = std::filesystem::current_path();
  std::filesystem::current_path(folder.file(""));
  const std::string error = writeError("plain", Bytes(5, std::byte{1}));
  std::filesystem::current_path(old);
  EXPECT_EQ(error, "no error");
  EXPECT_EQ(readBytes(folder.file("plain")).size(), 5u);
}

TEST(WriteFileAtomically, FolderThatDoesNotExist) {
  const ScratchFolder folder;
  const std::string path = folder.file("nowhere/a.map");
  EXPECT_EQ(writeError(path, Bytes(5)), path + ": cannot be written: No such file or directory");
  EXPECT_TRUE(folder.names().empty());
}

TEST(WriteFileAtomically, FolderThatMayNotBeWritten) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const ScratchFolder folder;
  const Bytes old(10, std::byte{7});
  const std::string path = folder.save("a.map", old);
  ASSERT_EQ(::chmod(folder.file("").c_str(), 0555), 0);
  const std::string error = writeError(path, Bytes(5));
  ASSERT_EQ(::chmod(folder.file("").c_str(), 0755), 0);
  EXPECT_EQ(error, path + ": cannot be written: Permission denied");
  EXPECT_EQ(readBytes(path), old);
}

TEST(WriteFileAtomically, TargetThatCannotBeReplaced) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder.file("a.map/inside"));
  const std::string error = writeError(folder.file("a.map"), Bytes(500));
  EXPECT_EQ(error.find(folder.file("a.map") + ": cannot be replaced: "), 0u) << error;
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.map"});
}

TEST(WriteFileAtomically, NoSpaceLeavesTheOldFileAndNothingElse) {
  const ScratchFolder folder;
  const Bytes old(10, std::byte{7});
  const std::string path = folder.save("a.map", old);
  // A limit on the size of files stands for a full disk.
  struct rlimit limit = {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  struct rlimit small = limit;
  small.rlim_cur = 4096;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string error = writeError(path, Bytes(100'000, std::byte{9}));
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(error, path + ": cannot be written: File too large");
  EXPECT_EQ(readBytes(path), old);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.map"});
}

TEST(WriteFileAtomically, StepsAroundALeftOver) {
  const ScratchFolder folder;
  const std::string left_over = "a.map.tmp-" + std::to_string(::getpid()) + "-0";
  folder.save(left_over, Bytes(3));
  EXPECT_EQ(writeError(folder.file("a.map"), Bytes(5, std::byte{1})), "no error");
  EXPECT_EQ(readBytes(folder.file(left_over)), Bytes(3));
  EXPECT_EQ(readBytes(folder.file("a.map")).size(), 5u);
  EXPECT_EQ(folder.names().size(), 2u);
}

TEST(FileDraft, OfAKilledWriterLeavesNothing) {
  const ScratchFolder folder;
  const int unnamed = ::open(folder.file("").c_str(), O_TMPFILE | O_WRONLY, 0600);
  if (unnamed < 0) GTEST_SKIP() << "this file system has no files without a name";
  ::close(unnamed);
  EXPECT_EXIT(
      {
        FileDraft draft(folder.file("a.map"));
        draft.write("bytes", 0, 5);
        ::kill(::getpid(), SIGKILL);
      },
      testing::KilledBySignal(SIGKILL), "");
  EXPECT_EQ(folder.names(), std::vector<std::string>{});
}

/// What waits to be read at an end that was opened for reading.
std::string arrived(int descriptor) {
  char bytes[100];
  const ssize_t count = ::read(descriptor, bytes, sizeof bytes);
  return {bytes, static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
}

TEST(WriteFileAtomically, WritesATextIntoAFifo) {
  const ScratchFolder folder;
  const std::string fifo = folder.file("fifo");
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  const int reader = ::open(fifo.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  writeFileAtomically(fifo, "from the first byte to the last");
  EXPECT_EQ(arrived(reader), "from the first byte to the last");
  ::close(reader);
  EXPECT_TRUE(std::filesystem::is_fifo(fifo));
  EXPECT_EQ(folder.names().size(), 1u);
}

TEST(WriteFileAtomically, WritesATextIntoADevice) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(::unlockpt(terminal), 0);
  const ScratchFolder folder;
  const std::string device = ::ptsname(terminal);
  std::filesystem::create_symlink(device, folder.file("link"));
  writeFileAtomically(folder.file("link"), "text");
  EXPECT_EQ(arrived(terminal), "text");
  EXPECT_TRUE(std::filesystem::is_character_file(device));
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link")));
  ::close(terminal);
}

TEST(WriteFileAtomically, SaysThatADeviceIsFull) {
  const ScratchFolder folder;
  std::filesystem::create_symlink("/dev/full", folder.file("link"));
  EXPECT_EQ(errorOf([&] { writeFileAtomically(folder.file("link"), "text"); }),
            folder.file("link") + ": cannot be written: No space left on device");
}

TEST(WriteFileAtomically, WritesNoBytesIntoAFifo) {
  const ScratchFolder folder;
  const std::string fifo = folder.file("fifo");
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_EQ(writeError(fifo, Bytes(5)),
            fifo + ": must be a file, not a device, a FIFO or the standard output");
  EXPECT_TRUE(std::filesystem::is_fifo(fifo));
  EXPECT_EQ(folder.names().size(), 1u);
}

TEST(WriteFileAtomically, ReplacesTheFileBehindLinks) {
  const ScratchFolder folder, other;
  const std::string target = other.save("target", Bytes(3));
  std::filesystem::create_symlink(target, folder.file("inner"));
  std::filesystem::create_symlink("inner", folder.file("outer"));
  const Bytes bytes(100, std::byte{2});
  EXPECT_EQ(writeError(folder.file("outer"), bytes), "no error");
  EXPECT_EQ(readBytes(target), bytes);
  EXPECT_EQ(std::filesystem::read_symlink(folder.file("outer")), "inner");
  EXPECT_EQ(std::filesystem::read_symlink(folder.file("inner")), target);
  EXPECT_EQ(folder.names().size() + other.names().size(), 3u);
}

TEST(WriteFileAtomically, MakesWhatALinkLeadsTo) {
  const ScratchFolder folder;
  std::filesystem::create_symlink("new", folder.file("link"));
  EXPECT_EQ(writeError(folder.file("link"), Bytes(5)), "no error");
  EXPECT_EQ(readBytes(folder.file("new")), Bytes(5));
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link")));
  std::filesystem::create_symlink("circle", folder.file("circle"));
  EXPECT_EQ(writeError(folder.file("circle"), Bytes(5)),
            folder.file("circle") + ": Too many levels of symbolic links");
}

TEST(WriteFileAtomically, LeavesWhoMayReadAFile) {
  const ScratchFolder folder;
  const std::string path = folder.save("private", Bytes(3));
  ASSERT_EQ(::chmod(path.c_str(), 0640), 0);
  EXPECT_EQ(writeError(path, Bytes(5)), "no error");
  struct stat info = {};
  ASSERT_EQ(::stat(path.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777u, 0640u);
}

TEST(WriteFileAtomically, LeavesAFileThatMayNotBeWritten) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const ScratchFolder folder;
  const std::string path = folder.save("protected", Bytes(3));
  ASSERT_EQ(::chmod(path.c_str(), 0444), 0);
  EXPECT_EQ(writeError(path, Bytes(5)), path + ": cannot be written: Permission denied");
  EXPECT_EQ(readBytes(path), Bytes(3));
}

// Its descriptor goes on where it stands, so that both are read in the order in which they were written.
TEST(WriteFileAtomically, AppendsToTheFileOfTheStandardOutput) {
  const ScratchFolder folder;
  const std::string path = folder.file("out");
  std::fflush(stdout);
  const int before = ::dup(STDOUT_FILENO);
  const int out = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ASSERT_EQ(::dup2(out, STDOUT_FILENO), STDOUT_FILENO);
  std::filesystem::create_symlink("/dev/stdout", folder.file("link"));
  std::printf("before ");
  writeFileAtomically(folder.file("link"), "text");
  std::printf(" after");
  std::fflush(stdout);
  ::dup2(before, STDOUT_FILENO);
  ::close(before);
  ::close(out);
  EXPECT_EQ(fileText(path), "before text after");
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link")));
}

TEST(MapImage, HoldsTheBytesOfTheFileAlsoWhenItMoves) {
  const MapContent content = makeSmallMap();
  MapImage image(content);
  EXPECT_EQ(image.bytes(), layOut(content));
  const RegionMap map = image.view("small");
  const MapImage moved = std::move(image);
  EXPECT_EQ(moved.bytes(), layOut(content));
  const double theta[] = {0.5, 0.5};
  EXPECT_EQ(map.locate(theta).status, LookupStatus::kInside);
  EXPECT_EQ(map.checksum(), moved.view("small").checksum());
  EXPECT_EQ(map.path(), "small");
}

TEST(MapImage, RefusesWhatTheFormatForbids) {
  MapContent content = makeSmallMap();
  content.tolerance = 1.0;
  EXPECT_THROW(MapImage{content}, Error);
}

}  // namespace
}  // namespace polyfly
