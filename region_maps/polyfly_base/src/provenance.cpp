#define XXH_INLINE_ALL
#include "polyfly_base/provenance.hpp"

#include <xxhash.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

std::string withKind(XXH64_hash_t hash) { return "xxh64:" + hexDigits(hash); }

}  // namespace

std::string hexDigits(std::uint64_t checksum) {
  std::array<char, 17> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(checksum));
  return digits.data();
}

Provenance provenanceOf(const std::string& path) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;  // bytes read at once
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path + ": cannot be read");
  const std::unique_ptr<XXH64_state_t, decltype(&XXH64_freeState)> state(XXH64_createState(),
                                                                         &XXH64_freeState);
  XXH64_reset(state.get(), 0);
  std::vector<char> piece(kPiece);
  while (file) {
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    XXH64_update(state.get(), piece.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof()) throw Error(path + ": cannot be read to its end");
  return {std::filesystem::path(path).filename().string(), withKind(XXH64_digest(state.get())), ""};
}

std::string checksumOf(const std::string& text) { return withKind(XXH64(text.data(), text.size(), 0)); }

std::string yamlString(const std::string& text) {
  std::string result = "\"";
  for (const char character : text) {
    const auto code = static_cast<unsigned char>(character);
    if (character == '"' || character == '\\') {
      result += '\\';
      result += character;
    } else if (code < 0x20) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\x%02x", static_cast<unsigned>(code));
      result += escape;
    } else {
      result += character;
    }
  }
  return result + "\"";
}

}  // namespace polyfly
