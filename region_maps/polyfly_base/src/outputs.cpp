#include "polyfly_base/outputs.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "polyfly_base/error.hpp"
#include "polyfly_base/file_draft.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;

// Greatest number of symbolic links that are followed, as in the kernel.
constexpr int kMaxLinks = 40;

bool isSame(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

bool isStandardStream(const struct stat& status) {
  for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO}) {
    struct stat open = {};
    if (::fstat(descriptor, &open) == 0 && isSame(open, status)) return true;
  }
  return false;
}

fs::path folderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// With the folder's links followed; the file itself need not exist.
fs::path wholeName(const std::string& target) {
  std::error_code ignored;
  const fs::path folder = fs::weakly_canonical(fs::absolute(folderOf(target), ignored), ignored);
  return folder / fs::path(target).filename();
}

bool isSameFile(const std::string& a, const std::string& b) {
  struct stat first = {}, second = {};
  const bool there = ::stat(a.c_str(), &first) == 0;
  if (there && S_ISCHR(first.st_mode)) return false;  // a device may be read and written, by several
  if (there && ::stat(b.c_str(), &second) == 0) return isSame(first, second);
  return wholeName(followLinks(a)) == wholeName(followLinks(b));
}

[[noreturn]] void refuse(const std::string& path, const std::string& rule) {
  throw Error(path + ": " + rule);
}

/// Whether `output` makes the folder of the file `target`.
bool makesFolderOf(const Output& output, const std::string& target) {
  if (output.folder != Output::Folder::kIsMade) return false;
  const fs::path wanted = wholeName(target).parent_path();
  const fs::path made = wholeName(output.path).parent_path();
  return std::mismatch(wanted.begin(), wanted.end(), made.begin(), made.end()).first == wanted.end();
}

/// The folder that is to hold `target`; where it is made, of those above it the first that exists.
void checkFolder(const Output& output, const std::string& target, bool is_made) {
  fs::path folder = folderOf(target);
  std::error_code ignored;
  while (is_made && !fs::exists(fs::symlink_status(folder, ignored)) && folder != folderOf(folder))
    folder = folderOf(folder);
  if (fs::is_directory(folder, ignored) && ::access(folder.c_str(), W_OK | X_OK) == 0) return;
  refuse(output.path, "folder '" + folder.string() + "' does not exist or cannot be written");
}

/// The last of `outputs`; the others come before it.
void checkLast(const std::vector<Output>& outputs) {
  const Output& output = outputs.back();
  const std::string target = followLinks(output.path);
  struct stat status = {};
  const bool there = ::stat(output.path.c_str(), &status) == 0;
  if (there && S_ISDIR(status.st_mode)) refuse(output.path, "is a folder, not a file");
  if (output.kind == Output::Kind::kText && isStream(output.path)) {
    if (::access(output.path.c_str(), W_OK) != 0)
      refuse(output.path, std::string("cannot be written: ") + std::strerror(errno));
    return;
  }
  if (!there || S_ISREG(status.st_mode)) {
    const bool is_made = std::any_of(outputs.begin(), outputs.end(),
                                     [&target](const Output& one) { return makesFolderOf(one, target); });
    checkFolder(output, target, is_made);
  }
  std::error_code ignored;
  // What a permission, a quota or a name's length forbids shows when a draft is begun.
  if (fs::exists(folderOf(target), ignored)) FileDraft(output.path);
}

}  // namespace

std::string followLinks(const std::string& path) {
  fs::path target = path;
  std::error_code failure;
  for (int links = 0; fs::is_symlink(fs::symlink_status(target, failure)); ++links) {
    if (links == kMaxLinks) refuse(path, std::strerror(ELOOP));
    target = target.parent_path() / fs::read_symlink(target, failure);
    if (failure) refuse(path, failure.message());
  }
  return target.string();
}

bool isStream(const std::string& path) {
  struct stat status = {};
  if (::stat(path.c_str(), &status) != 0 || S_ISDIR(status.st_mode)) return false;
  return S_ISCHR(status.st_mode) || S_ISFIFO(status.st_mode) || isStandardStream(status);
}

void makeFolder(const std::string& path) {
  std::error_code failure;
  fs::create_directories(path, failure);
  if (failure) refuse(path, "cannot be made: " + failure.message());
}

void checkOutputs(const std::vector<Output>& outputs, const std::vector<std::string>& inputs) {
  std::vector<std::string> taken = inputs;
  std::vector<Output> done;
  for (const Output& output : outputs) {
    if (output.path.empty()) continue;
    for (const std::string& other : taken) {
      if (!other.empty() && isSameFile(output.path, other))
        refuse(output.path, "is read or written by this command already: the output needs a name of its own");
    }
    done.push_back(output);
    checkLast(done);
    taken.push_back(output.path);
  }
}

}  // namespace polyfly
