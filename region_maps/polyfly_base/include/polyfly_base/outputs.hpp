#pragma once

#include <string>
#include <vector>

namespace polyfly {

/// A file that a tool is asked to write.
struct Output {
  enum class Kind {
    /// Written from its first byte to its last. A device or a FIFO is allowed.
    kText,
    /// Read back, resumed or written in any order. It must be a file, or not exist yet.
    kFile,
  };
  enum class Folder { kExists, kIsMade };

  /// Empty: no output is asked for.
  std::string path;
  Kind kind = Kind::kText;
  Folder folder = Folder::kExists;
};

/// To be called before the work whose results go to `outputs`. They are in the order in which they will be written:
/// the folder that one makes is there for the next. Throws Error, naming the path, where one of them cannot be
/// written: no folder, no permission, or not of its kind. Throws also where one is a file that is read (`inputs`,
/// empty names apart) or another output, through links and other spellings. Nothing is left behind; of a file that is
/// there, nothing changes.
void checkOutputs(const std::vector<Output>& outputs, const std::vector<std::string>& inputs);

/// Makes the folder and those above it where they are missing. Throws Error naming it.
void makeFolder(const std::string& path);

/// The name behind symbolic links: a file, or one that does not exist yet. Throws Error for links in a
/// circle.
std::string followLinks(const std::string& path);

/// Whether a text goes into `path` as it comes: a device, a FIFO, or where the standard output or the
/// standard error goes already.
bool isStream(const std::string& path);

}  // namespace polyfly
