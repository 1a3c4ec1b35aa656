#include "polyfly_base/outputs.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "error_of.hpp"
#include "scratch_folder.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;
using Kind = Output::Kind;
using Folder = Output::Folder;

const char* const kTaken = ": is read or written by this command already: the output needs a name of its own";
const char* const kNoFile = ": must be a file, not a device, a FIFO or the standard output";

std::string refusal(const std::vector<Output>& outputs, const std::vector<std::string>& inputs = {}) {
  return errorOf([&] { checkOutputs(outputs, inputs); });
}

class Outputs : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.file(name); }

  ScratchFolder folder_;
  const std::string input_ = folder_.save("input", std::vector<std::byte>(3));
};

TEST_F(Outputs, LeaveNothingBehind) {
  EXPECT_EQ(refusal({{path("new")}, {path("map"), Kind::kFile}, {""}}, {input_, ""}), "no error");
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"input"});
}

TEST_F(Outputs, AreNoInputUnderAnySpelling) {
  fs::create_symlink("input", path("link"));
  fs::create_hard_link(input_, path("hard"));
  fs::create_directory_symlink(".", path("here"));
  for (const std::string name : {"input", "./input", "link", "hard", "here/input", "here/link"})
    EXPECT_EQ(refusal({{path(name)}}, {input_}), path(name) + kTaken);
  EXPECT_EQ(refusal({{input_}}, {path("hard")}), input_ + kTaken);
}

TEST_F(Outputs, AreDifferentFilesBeforeTheyExist) {
  fs::create_directory_symlink(".", path("here"));
  fs::create_symlink("new", path("link"));
  for (const std::string name : {"new", "./new", "here/new", "link", "here/link"})
    EXPECT_EQ(refusal({{path("new")}, {path(name)}}), path(name) + kTaken);
  EXPECT_EQ(refusal({{path("report/new"), Kind::kText, Folder::kIsMade}, {path("report/./new")}}),
            path("report/./new") + kTaken);
  EXPECT_EQ(refusal({{path("new")}, {path("newer")}}), "no error");
}

TEST_F(Outputs, OfTextMayBeAFifoOrADevice) {
  ASSERT_EQ(::mkfifo(path("fifo").c_str(), 0600), 0);
  EXPECT_EQ(refusal({{path("fifo")}}), "no error");
  EXPECT_EQ(refusal({{path("fifo"), Kind::kFile}}), path("fifo") + kNoFile);
  fs::create_symlink("/dev/full", path("link"));
  EXPECT_EQ(refusal({{path("link")}, {path("link")}}, {"/dev/full"}), "no error")
      << "a device is not used up";
  EXPECT_EQ(refusal({{path("link"), Kind::kFile}}), path("link") + kNoFile);
  EXPECT_TRUE(fs::is_fifo(path("fifo")));
}

TEST_F(Outputs, AreNoFolder) {
  fs::create_directory(path("folder"));
  fs::create_directory_symlink("folder", path("link"));
  for (const std::string name : {"folder", "folder/", "link"})
    EXPECT_EQ(refusal({{path(name)}}), path(name) + ": is a folder, not a file");
}

TEST_F(Outputs, NeedTheirFolder) {
  fs::create_symlink("missing/file", path("link"));
  for (const std::string name : {"missing/file", "input/file"})
    EXPECT_EQ(refusal({{path(name)}}), path(name) + ": folder '" +
                                           fs::path(path(name)).parent_path().string() +
                                           "' does not exist or cannot be written");
  EXPECT_EQ(refusal({{path("link")}}),
            path("link") + ": folder '" + path("missing") + "' does not exist or cannot be written");
}

TEST_F(Outputs, OfAReportNeedAPlaceForItsFolder) {
  fs::create_symlink("nowhere", path("link"));
  EXPECT_EQ(refusal({{path("a/b/index.html"), Kind::kText, Folder::kIsMade}}), "no error");
  EXPECT_FALSE(fs::exists(path("a")));
  EXPECT_EQ(refusal({{path("a/b/index.html"), Kind::kText, Folder::kIsMade}, {path("./a/other")}}),
            "no error");
  EXPECT_NE(refusal({{path("a/other")}, {path("a/b/index.html"), Kind::kText, Folder::kIsMade}}), "no error");
  EXPECT_NE(refusal({{path("a/index.html"), Kind::kText, Folder::kIsMade}, {path("a/b/other")}}), "no error");
  for (const std::string name : {"input", "link"}) {
    const std::string page = path(name) + "/deeper/index.html";
    EXPECT_EQ(refusal({{page, Kind::kText, Folder::kIsMade}}),
              page + ": folder '" + path(name) + "' does not exist or cannot be written");
  }
}

TEST_F(Outputs, NeedAFolderThatMayBeWritten) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  fs::create_directory(path("closed"));
  ASSERT_EQ(::chmod(path("closed").c_str(), 0555), 0);
  EXPECT_NE(refusal({{path("closed/file")}}), "no error");
  EXPECT_NE(refusal({{path("closed/report/index.html"), Kind::kText, Folder::kIsMade}}), "no error");
}

TEST_F(Outputs, AreTriedWithTheNameOfTheirDraft) {
  const std::string longest(255, 'x');
  EXPECT_EQ(refusal({{path(longest)}}), path(longest) + ": cannot be written: File name too long");
}

}  // namespace
}  // namespace polyfly
