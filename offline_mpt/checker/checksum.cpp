#include "checksum.hpp"

#include <cstdio>
#include <cstring>

#include "core/text.hpp"

namespace checker {
namespace {

constexpr std::uint64_t kPrime[] = {11400714785074694791ull, 14029467366897019727ull, 1609587929392839161ull,
                                    9650029242287828579ull, 2870177450012600261ull};

std::uint64_t rotate(std::uint64_t value, int bits) { return value << bits | value >> (64 - bits); }

std::uint64_t mix(std::uint64_t state, std::uint64_t input) {
  return rotate(state + input * kPrime[1], 31) * kPrime[0];
}

template <typename T>
T load(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

}  // namespace

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

std::string unsealed(const std::string& text) {
  require(text.compare(0, 8, "polyfly ") == 0, "not a certificate");
  const std::size_t end = text.rfind("\nend ");
  require(end != std::string::npos, "the certificate is cut off");
  require(text.substr(end + 1) == "end " + hexText(xxh64(text.substr(0, end + 1))) + "\n",
          "the certificate is damaged: its checksum does not match");
  return text.substr(0, end);
}

}  // namespace checker
