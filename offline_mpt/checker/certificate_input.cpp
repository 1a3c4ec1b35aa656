#include "certificate_input.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace checker {
namespace {

constexpr std::uint64_t kPrime[] = {11400714785074694791ull, 14029467366897019727ull, 1609587929392839161ull,
                                    9650029242287828579ull, 2870177450012600261ull};

// Greatest size of a file that is read whole.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 33;
// Greatest tolerance of a map, see region_maps/FORMAT.md.
constexpr double kMaxTolerance = 1e-8;

std::uint64_t rotate(std::uint64_t value, int bits) { return value << bits | value >> (64 - bits); }

std::uint64_t mix(std::uint64_t state, std::uint64_t input) {
  return rotate(state + input * kPrime[1], 31) * kPrime[0];
}

template <typename T>
T load(const std::string& bytes, std::size_t at) {
  T value;
  require(at + sizeof(T) <= bytes.size(), "the map is cut off");
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

template <typename T>
std::vector<T> section(const std::string& bytes, std::size_t index, std::size_t per_element) {
  const auto offset = load<std::uint64_t>(bytes, 96 + 16 * index);
  const auto count = load<std::uint64_t>(bytes, 104 + 16 * index);
  require(offset <= bytes.size() && count <= (bytes.size() - offset) / (per_element * sizeof(T)),
          "a section of the map lies outside of it");
  std::vector<T> result(count * per_element);
  if (!result.empty()) std::memcpy(result.data(), bytes.data() + offset, result.size() * sizeof(T));
  return result;
}

}  // namespace

void requireFile(const std::string& path) {
  std::error_code failure;
  const std::filesystem::file_status status = std::filesystem::status(path, failure);
  if (!std::filesystem::exists(status)) throw Unreadable(path + ": no such file");
  if (!std::filesystem::is_regular_file(status) && !std::filesystem::is_fifo(status))
    throw Unreadable(path + ": is no file");
}

std::string readFile(const std::string& path) {
  requireFile(path);
  // A pipe has no size, which counts as a failure.
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (!failure && size > kMostBytes)
    throw Unreadable(path + ": is larger than " + std::to_string(kMostBytes) + " bytes");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content.exceptions(std::ios::badbit);  // else a stream keeps to itself that memory ran out
  try {
    content << file.rdbuf();
  } catch (const std::ios_base::failure&) {  // a folder, say
    file.setstate(std::ios::badbit);
  }
  if (!file.good() || !content.good()) throw Unreadable(path + ": cannot be read, or is empty");
  return content.str();
}

std::uint64_t xxh64(const std::string& bytes) {
  const std::size_t size = bytes.size();
  std::size_t at = 0;
  std::uint64_t hash = kPrime[4];
  if (size >= 32) {
    std::uint64_t lane[] = {kPrime[0] + kPrime[1], kPrime[1], 0, 0 - kPrime[0]};
    for (; at + 32 <= size; at += 32) {
      for (std::size_t k = 0; k < 4; ++k) lane[k] = mix(lane[k], load<std::uint64_t>(bytes, at + 8 * k));
    }
    hash = rotate(lane[0], 1) + rotate(lane[1], 7) + rotate(lane[2], 12) + rotate(lane[3], 18);
    for (const std::uint64_t value : lane) hash = (hash ^ mix(0, value)) * kPrime[0] + kPrime[3];
  }
  hash += size;
  for (; at + 8 <= size; at += 8)
    hash = rotate(hash ^ mix(0, load<std::uint64_t>(bytes, at)), 27) * kPrime[0] + kPrime[3];
  for (; at + 4 <= size; at += 4)
    hash = rotate(hash ^ load<std::uint32_t>(bytes, at) * kPrime[0], 23) * kPrime[1] + kPrime[2];
  for (; at < size; ++at)
    hash = rotate(hash ^ static_cast<unsigned char>(bytes[at]) * kPrime[4], 11) * kPrime[0];
  hash = (hash ^ hash >> 33) * kPrime[1];
  hash = (hash ^ hash >> 29) * kPrime[2];
  return hash ^ hash >> 32;
}

std::string hexText(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

Map::Map(const std::string& file) {
  require(file.size() >= 256 && file.compare(0, 8, "PFLYMAP\n") == 0, "not a region map");
  require(load<std::uint32_t>(file, 8) == 0x01020304u, "the byte order of the map is not this machine's");
  const auto version = load<std::uint32_t>(file, 12);
  require(version == 1 || version == 2, "the version of the map is unknown");
  require(version == 1 || file.size() >= 272, "the map is cut off");
  size = load<std::uint64_t>(file, 16);
  checksum = load<std::uint64_t>(file, 24);
  require(size == file.size(), "the map is cut off");
  std::string blank = file;
  blank.replace(24, 8, 8, '\0');
  require(xxh64(blank) == checksum, "the map is damaged: its checksum does not match");
  p = load<std::uint32_t>(file, 32);
  q = load<std::uint32_t>(file, 36);
  root = load<std::uint32_t>(file, 40);
  tolerance = load<double>(file, 56);
  reduced_from = load<std::uint64_t>(file, 80);
  first_fallback = load<std::uint32_t>(file, 88);
  require(tolerance >= 0.0 && tolerance <= kMaxTolerance, "the map's tolerance is out of range");
  require(p >= 1 && p <= 256 && q >= 1 && q <= 256, "the map's sizes are out of range");
  readText(file);
  bounds = section<double>(file, 1, 2);
  require(bounds.size() == 2 * std::size_t{p + q}, "the map's bounds are not as they must be");
  planes = section<double>(file, 2, p + 1);
  laws = section<double>(file, 3, q * (p + 1));
  regions = section<Region>(file, 4, 1);
  rows = section<std::int32_t>(file, 5, 1);
  active = section<std::int32_t>(file, 6, 1);
  nodes = section<Node>(file, 7, 1);
  leaves = section<Leaf>(file, 8, 1);
  candidates = section<std::uint32_t>(file, 9, 1);
  if (version == 2) tests = section<std::uint32_t>(file, 10, 1);
  checkTables();
  checkTree();
}

void Map::readText(const std::string& file) {
  const std::vector<char> text = section<char>(file, 0, 1);
  for (auto at = text.begin(); at != text.end();) {
    const auto end = std::find(at, text.end(), '\0');
    require(end != text.end(), "the map's text is not as it must be");
    words.emplace_back(at, end);
    at = end + 1;
  }
  require(words.size() == 5 + 2 * (std::size_t{p} + q), "the map's text is not as it must be");
  problem = words[1];
}

void Map::checkTables() const {
  for (const std::int32_t row : rows)
    require(row != 0 && row != INT32_MIN && std::size_t(std::abs(row)) * (p + 1) <= planes.size(),
            "a row of the map names no plane");
  for (const Region& region : regions) {
    require(std::uint64_t{region.first_row} + region.row_count <= rows.size() &&
                std::uint64_t{region.first_active} + region.active_count <= active.size() &&
                (std::uint64_t{region.law} + 1) * q * (p + 1) <= laws.size(),
            "a region of the map reaches beyond its tables");
  }
  for (const auto* table : {&planes, &laws, &bounds}) {
    const std::size_t finite =
        table == &bounds ? 2 * std::size_t{p} : table->size();  // inputs may have no bounds
    for (std::size_t k = 0; k < finite; ++k)
      require(std::isfinite((*table)[k]), "the map has an entry that is no number");
  }
}

void Map::checkTree() const {
  const auto require_child = [&](std::uint32_t child) {
    require((child & kLeaf) != 0 ? (child & ~kLeaf) < leaves.size() : child < nodes.size(),
            "the map's tree leads to no leaf");
  };
  require_child(root);
  for (const Node& node : nodes) {
    require((std::size_t{node.plane} + 1) * (p + 1) <= planes.size(), "a node of the map names no plane");
    require_child(node.below);
    require_child(node.above);
  }
  for (const Leaf& leaf : leaves)
    require(std::uint64_t{leaf.first} + leaf.count <= candidates.size(), "a leaf reaches beyond its table");
  for (const std::uint32_t candidate : candidates)
    require(candidate < regions.size(), "a candidate of the map is no region");
}

std::string Line::word() {
  std::string result;
  require(static_cast<bool>(words_ >> result), "a line is shorter than its rule");
  return result;
}

bool Line::next(const std::string& expected) {
  if (done()) return false;
  const auto before = words_.tellg();
  std::string found;
  if (words_ >> found && found == expected) return true;
  words_.clear();
  words_.seekg(before);
  return false;
}

std::string Line::rest() {
  std::string result;
  std::getline(words_ >> std::ws, result);
  return result;
}

std::size_t Line::count(std::size_t limit) {
  const std::string text = word();
  require(text.size() <= 18 && text.find_first_not_of("0123456789") == std::string::npos,
          text + " is no count");
  const std::size_t value = std::stoull(text);
  require(value <= limit, text + " is out of range");
  return value;
}

mpz_class Line::integer() {
  mpz_class value;
  const std::string text = word();
  require(text.find_first_not_of("-0123456789abcdef") == std::string::npos && value.set_str(text, 16) == 0,
          text + " is no whole number");
  return value;
}

mpq_class Line::fraction() {
  mpq_class value;
  const std::string text = word();
  require(text.find_first_not_of("-/0123456789abcdef") == std::string::npos && value.set_str(text, 16) == 0 &&
              value.get_den() > 0,
          text + " is no fraction");
  value.canonicalize();
  return value;
}

mpq_class Line::real() {
  const std::string text = word();
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  require(end == text.c_str() + text.size() && std::isfinite(value), text + " is no finite number");
  return mpq_class(value);
}

std::vector<double> jsonNumbers(const std::string& text, const std::string& key) {
  std::vector<double> numbers;
  int depth = 0;
  bool wanted = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '"') {
      const std::size_t first = at + 1;
      for (++at; at < text.size() && text[at] != '"'; ++at) at += text[at] == '\\' ? 1 : 0;
      const std::size_t colon = text.find_first_not_of(" \t\r\n", at + 1);
      const bool is_key = depth == 1 && colon != std::string::npos && text[colon] == ':';
      if (is_key) wanted = text.compare(first, at - first, key) == 0;
    } else if (c == '{' || c == '[') {
      ++depth;
    } else if (c == '}' || c == ']') {
      --depth;
    } else if (wanted && (c == '-' || (c >= '0' && c <= '9'))) {
      char* end = nullptr;
      numbers.push_back(std::strtod(text.c_str() + at, &end));
      at = static_cast<std::size_t>(end - text.c_str()) - 1;
    }
  }
  return numbers;
}

}  // namespace checker
