// What readFile gives back and refuses. The check of the head runs after the file is opened and before it is read: the tests
// change the file there.
#include "region_maps/read_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "error_of.hpp"
#include "region_maps/format.hpp"
#include "scratch_folder.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kSize = 100'000;
constexpr std::uint64_t kHuge = 20'000'000'000;

std::vector<std::byte> pattern(std::size_t size) {
  std::vector<std::byte> bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * i >> 3);
  return bytes;
}

class ReadFile : public testing::Test {
 protected:
  ReadFile() : path_(folder_.save("some.bin", pattern(kSize))) {}

  /// What is said about a file that `change` was done to after it was opened.
  std::string refusal(const std::function<void()>& change) const {
    return errorOf([&] { readFile(path_, [&](const void*, std::uint64_t) { change(); }); });
  }

  const ScratchFolder folder_;
  const std::string path_;
};

TEST_F(ReadFile, GivesTheBytesAligned) {
  for (const std::size_t size : {std::size_t{1}, kHeadBytes - 1, kHeadBytes, kHeadBytes + 1, kSize}) {
    const std::vector<std::byte> bytes = pattern(size);
    const std::string path = folder_.save("sized.bin", bytes);
    std::uint64_t told = 0;
    const AlignedBytes read = readFile(path, [&](const void* head, std::uint64_t file_size) {
      told = file_size;
      EXPECT_EQ(std::memcmp(head, bytes.data(), std::min(size, kHeadBytes)), 0);
    });
    EXPECT_EQ(told, size);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(read.data()) % format::kAlignment, 0u);
    EXPECT_EQ(std::vector<std::byte>(read.data(), read.data() + read.size()), bytes);
  }
}

TEST_F(ReadFile, RefusesAFileThatBecomesShorter) {
  EXPECT_EQ(refusal([&] { std::filesystem::resize_file(path_, kSize / 2); }),
            path_ + ": became shorter while it was read");
}

TEST_F(ReadFile, RefusesAFileThatIsTruncatedToNothing) {
  EXPECT_EQ(refusal([&] { std::filesystem::resize_file(path_, 0); }),
            path_ + ": became shorter while it was read");
}

TEST_F(ReadFile, RefusesAFileThatGrows) {
  EXPECT_EQ(refusal([&] { std::filesystem::resize_file(path_, 2 * kSize); }),
            path_ + ": changed while it was read");
}

// The time of the last write is set apart, since a file system may count in coarser steps than a test takes.
TEST_F(ReadFile, RefusesAFileThatIsWrittenInPlace) {
  EXPECT_EQ(refusal([&] {
              std::fstream(path_, std::ios::in | std::ios::out | std::ios::binary).seekp(kSize / 2).put('x');
              const auto written = std::filesystem::last_write_time(path_);
              std::filesystem::last_write_time(path_, written + std::chrono::seconds(1));
            }),
            path_ + ": changed while it was read");
}

TEST_F(ReadFile, ReadsTheOldFileWhereItIsReplaced) {
  const AlignedBytes read = readFile(path_, [&](const void*, std::uint64_t) {
    std::filesystem::rename(folder_.save("new.bin", pattern(10)), path_);
  });
  EXPECT_EQ(read.size(), kSize);
}

// 20 GB, of which the disk holds nothing.
TEST_F(ReadFile, TakesNoMemoryForAFileThatTheCheckRefuses) {
  std::filesystem::resize_file(path_, kHuge);
  EXPECT_EQ(refusal([] { throw Error("no such file is wanted"); }), "no such file is wanted");
}

TEST_F(ReadFile, SaysThatAFileDoesNotFitIntoMemory) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer's allocator ends the program itself";
#endif
  std::filesystem::resize_file(path_, kHuge);
  rlimit limit = {};
  ASSERT_EQ(::getrlimit(RLIMIT_AS, &limit), 0);
  const rlim_t before = limit.rlim_cur;
  limit.rlim_cur = kHuge / 2;
  ASSERT_EQ(::setrlimit(RLIMIT_AS, &limit), 0);
  const std::string text = refusal([] {});
  limit.rlim_cur = before;
  ASSERT_EQ(::setrlimit(RLIMIT_AS, &limit), 0);
  EXPECT_EQ(text, path_ + ": does not fit into memory: 20000000000 bytes");
}

}  // namespace
}  // namespace polyfly
