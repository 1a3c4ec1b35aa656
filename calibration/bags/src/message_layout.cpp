#include "bags/message_layout.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <sstream>

#include "bag_record.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr int kDeepest = 32;  // types within types

struct Builtin {
  const char* name;
  std::size_t size;
  char type;  // see numberAt; a time is two of them
};

constexpr Builtin kBuiltins[] = {
    {"bool", 1, 'B'},  {"int8", 1, 'b'},   {"uint8", 1, 'B'},   {"byte", 1, 'b'},   {"char", 1, 'B'},
    {"int16", 2, 'h'}, {"uint16", 2, 'H'}, {"int32", 4, 'i'},   {"uint32", 4, 'I'}, {"float32", 4, 'f'},
    {"int64", 8, 'q'}, {"uint64", 8, 'Q'}, {"float64", 8, 'd'}, {"time", 8, 'I'},   {"duration", 8, 'i'}};

const Builtin* builtinOf(const std::string& type) {
  const auto* found = std::find_if(std::begin(kBuiltins), std::end(kBuiltins),
                                   [&type](const Builtin& builtin) { return type == builtin.name; });
  return found == std::end(kBuiltins) ? nullptr : found;
}

double valueOf(const Builtin& builtin, const std::uint8_t* data) {
  const double value = numberAt(data, builtin.type);
  const bool is_time = builtin.size == 8 && (builtin.type == 'I' || builtin.type == 'i');
  return is_time ? value + 1e-9 * numberAt(data + sizeof(std::uint32_t), builtin.type) : value;
}

std::string packageOf(const std::string& type) { return type.substr(0, type.find('/')); }

}  // namespace

// Where reading stands, and what is looked for.
struct MessageLayout::Reader {
  const std::uint8_t* data = nullptr;
  std::size_t left = 0;
  const std::vector<std::string>* paths = nullptr;
  std::vector<double> values;

  bool skip(std::size_t count) {
    if (count > left) return false;
    data += count;
    left -= count;
    return true;
  }
  std::optional<std::uint32_t> length() {
    if (left < sizeof(std::uint32_t)) return std::nullopt;
    const auto value = readNumber<std::uint32_t>(data);
    skip(sizeof(std::uint32_t));
    return value;
  }
  void note(const std::string& path, double value) {
    if (paths == nullptr) return;
    for (std::size_t i = 0; i < paths->size(); ++i) {
      if ((*paths)[i] == path) values[i] = value;
    }
  }
};

MessageLayout::MessageLayout(const std::string& type, const std::string& definition) : type_(type) {
  parse(type, definition);
  resolve(type, 0);
}

// Lines of the definition: `type name`, `type[] name`, `type[4] name`; constants and comments are left out.
// After a line of = comes `MSG: package/Type` and the definition of that.
void MessageLayout::parse(const std::string& type, const std::string& definition) {
  std::istringstream lines(definition);
  std::string line;
  std::string current = type;
  types_[current];
  while (std::getline(lines, line)) {
    line = line.substr(0, line.find('#'));
    std::istringstream words(line);
    std::string kind;
    std::string name;
    if (!(words >> kind)) continue;
    if (kind.find_first_not_of('=') == std::string::npos) continue;
    if (!(words >> name)) throw Error(type + ": definition: not understood: " + line);
    if (kind == "MSG:") {
      current = name;
      types_[current].clear();
      continue;
    }
    // A constant has no bytes.
    if (line.find('=') != std::string::npos) continue;
    Field field;
    field.name = name;
    const std::size_t bracket = kind.find('[');
    if (bracket != std::string::npos) {
      field.array = true;
      const std::string inside = kind.substr(bracket + 1, kind.find(']') - bracket - 1);
      if (inside.find_first_not_of("0123456789") != std::string::npos || inside.size() > 9) {
        throw Error(type + ": definition: not understood: " + line);
      }
      if (!inside.empty()) field.length = static_cast<std::uint32_t>(std::stoul(inside));
      kind.resize(bracket);
    }
    if (builtinOf(kind) != nullptr || kind == "string") {
      field.type = kind;
    } else if (kind == "Header") {
      field.type = "std_msgs/Header";
    } else {
      field.type = kind.find('/') == std::string::npos ? packageOf(current) + "/" + kind : kind;
    }
    types_[current].push_back(field);
  }
}

// Every type must be there, and none may hold itself; notes those of fixed size.
void MessageLayout::resolve(const std::string& type, int depth) {
  if (depth > kDeepest) throw Error(type_ + ": definition: types are nested too deep");
  if (builtinOf(type) != nullptr || type == "string" || sizes_.count(type) > 0) return;
  const auto found = types_.find(type);
  if (found == types_.end()) throw Error(type_ + ": definition: no definition of " + type);
  std::size_t sum = 0;
  bool fixed = true;
  for (const Field& field : found->second) {
    resolve(field.type, depth + 1);
    const std::optional<std::size_t> size = fixedSize(field.type);
    if (!size || (field.array && !field.length)) {
      fixed = false;
    } else {
      sum += *size * (field.array ? *field.length : 1);
    }
    fixed = fixed && sum < std::numeric_limits<std::uint32_t>::max();
  }
  if (fixed) sizes_[type] = sum;
}

std::optional<std::size_t> MessageLayout::fixedSize(const std::string& type) const {
  if (const Builtin* builtin = builtinOf(type)) return builtin->size;
  const auto found = sizes_.find(type);
  if (found == sizes_.end()) return std::nullopt;
  return found->second;
}

bool MessageLayout::visit(const std::string& type, const std::string& prefix, Reader* reader) const {
  for (const Field& field : types_.at(type)) {
    if (!visitField(field, prefix, reader)) return false;
  }
  return true;
}

bool MessageLayout::visitField(const Field& field, const std::string& prefix, Reader* reader) const {
  std::uint32_t count = 1;
  if (field.array) {
    const std::optional<std::uint32_t> length = field.length ? field.length : reader->length();
    if (!length) return false;
    count = *length;
    if (const auto size = fixedSize(field.type)) {
      return *size == 0 || (count <= reader->left / *size && reader->skip(count * *size));
    }
  }
  const std::string path = field.array ? "[]" : prefix + field.name;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (field.type == "string") {
      const std::optional<std::uint32_t> length = reader->length();
      if (!length || !reader->skip(*length)) return false;
    } else if (const Builtin* builtin = builtinOf(field.type)) {
      if (builtin->size > reader->left) return false;
      reader->note(path, valueOf(*builtin, reader->data));
      reader->skip(builtin->size);
    } else if (!visit(field.type, path + ".", reader)) {
      return false;
    }
  }
  return true;
}

bool MessageLayout::fits(const std::uint8_t* data, std::size_t size) const {
  Reader reader;
  reader.data = data;
  reader.left = size;
  return visit(type_, "", &reader) && reader.left == 0;
}

std::optional<std::vector<double>> MessageLayout::numbers(const std::uint8_t* data, std::size_t size,
                                                          const std::vector<std::string>& paths) const {
  Reader reader;
  reader.data = data;
  reader.left = size;
  reader.paths = &paths;
  reader.values.assign(paths.size(), std::numeric_limits<double>::quiet_NaN());
  if (!visit(type_, "", &reader) || reader.left != 0) return std::nullopt;
  return reader.values;
}

bool MessageLayout::has(const std::string& path) const { return hasIn(type_, path); }

bool MessageLayout::hasIn(const std::string& type, const std::string& path) const {
  const auto found = types_.find(type);
  if (found == types_.end()) return false;
  const std::size_t dot = path.find('.');
  for (const Field& field : found->second) {
    if (field.array || field.name != path.substr(0, dot)) continue;
    return dot == std::string::npos ? builtinOf(field.type) != nullptr
                                    : hasIn(field.type, path.substr(dot + 1));
  }
  return false;
}

}  // namespace polyfly
