#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace polyfly {

/// Layout of a serialised ROS message, computed from the message definition in the bag. Reads number
/// fields by name without compiled message headers, and checks whether bytes are one complete message.
class MessageLayout {
 public:
  /// Parses a definition as `rosmsg show --raw` prints it: nested types follow after a line of `=`. Throws
  /// Error naming the type and the line: unknown type, not a definition, nested too deep.
  MessageLayout(const std::string& type, const std::string& definition);

  /// Whether the bytes hold one message from begin to end, every array and string inside them.
  bool fits(const std::uint8_t* data, std::size_t size) const;

  /// Values of number fields by path, for example `pose.orientation.x` or `header.stamp` (a time, in
  /// seconds). NaN where the message has no such field, or it is no number. Paths do not lead into arrays.
  /// Nothing if the bytes do not fit.
  std::optional<std::vector<double>> numbers(const std::uint8_t* data, std::size_t size,
                                             const std::vector<std::string>& paths) const;

  /// Whether a number stands at this path.
  bool has(const std::string& path) const;

 private:
  struct Field {
    /// Builtin type, or a key of types_.
    std::string type;
    std::string name;
    bool array = false;
    /// Length of a fixed-length array.
    std::optional<std::uint32_t> length;
  };
  using Fields = std::vector<Field>;

  struct Reader;
  void parse(const std::string& type, const std::string& definition);
  void resolve(const std::string& type, int depth);
  bool visit(const std::string& type, const std::string& prefix, Reader* reader) const;
  bool visitField(const Field& field, const std::string& prefix, Reader* reader) const;
  bool hasIn(const std::string& type, const std::string& path) const;
  std::optional<std::size_t> fixedSize(const std::string& type) const;

  std::string type_;
  std::map<std::string, Fields> types_;
  // Sizes of the types without variable-length arrays and strings.
  std::map<std::string, std::size_t> sizes_;
};

}  // namespace polyfly
