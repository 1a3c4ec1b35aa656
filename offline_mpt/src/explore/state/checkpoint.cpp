#include "explore/state/checkpoint.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#include "polyfly_base/error.hpp"
#include "polyfly_base/file_draft.hpp"
#include "region_maps/read_file.hpp"
#include "support/byte_stream.hpp"

// Compiles XXH64 into this file; nothing to link.
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace polyfly {
namespace {

constexpr char kMagic[8] = {'P', 'L', 'Y', 'F', 'C', 'K', 'P', 'T'};
constexpr std::uint32_t kByteOrder = 0x01020304;
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kPiece = std::size_t{1} << 20;  // [bytes] written, and hashed, at a time

struct Header {
  char magic[8];
  std::uint32_t byte_order;
  std::uint32_t version;
  std::uint64_t file_size;
  std::uint64_t checksum;
  std::uint64_t fingerprint;
  std::uint64_t sets;
  std::uint64_t described;
  std::uint64_t regions;
};
static_assert(sizeof(Header) == 64 && sizeof(Header) <= kHeadBytes);

std::uint64_t hashOf(const std::vector<std::byte>& bytes) { return XXH64(bytes.data(), bytes.size(), 0); }

std::uint64_t checksum(Header header, std::uint64_t payload_hash) {
  header.checksum = 0;
  std::vector<std::byte> bytes(sizeof header);
  std::memcpy(bytes.data(), &header, sizeof header);
  return XXH64(bytes.data(), bytes.size(), payload_hash);
}

// The payload's hash: of each piece, seeded with that of the piece before.
std::uint64_t hashPieces(const std::byte* payload, std::size_t bytes) {
  std::uint64_t hash = 0;
  for (std::size_t first = 0; first < bytes; first += kPiece) {
    hash = XXH64(payload + first, std::min(kPiece, bytes - first), hash);
  }
  return hash;
}

template <typename Matrix>
void putMatrix(const Matrix& matrix, ByteWriter& out) {
  out.put(static_cast<std::int64_t>(matrix.rows()));
  out.put(static_cast<std::int64_t>(matrix.cols()));
  out.putArray(matrix.data(), static_cast<std::size_t>(matrix.size()));
}

/// The bytes behind the header, hashed as they go to the file.
class Payload {
 public:
  explicit Payload(FileDraft& draft) : draft_(draft), out_(buffer_) { buffer_.reserve(2 * kPiece); }

  template <typename T>
  void put(const T& value) {
    putArray(&value, 1);
  }
  template <typename T>
  void putArray(const T* values, std::size_t count) {
    out_.putArray(values, count);
    while (buffer_.size() >= kPiece) flush(kPiece);
  }
  void putSets(const ActiveSetPool& pool) {
    for (std::uint32_t k = 0; k < pool.size(); ++k) {
      const RowSpan set = pool[k];
      put(static_cast<std::uint16_t>(set.count));
      putArray(set.rows, set.count);
    }
  }

  /// Writes the header too, when all else is on the disk.
  void finish(Header header) {
    if (!buffer_.empty()) flush(buffer_.size());
    draft_.sync();
    header.file_size = end_;
    header.checksum = checksum(header, hash_);
    draft_.write(&header, 0, sizeof header);
  }

 private:
  void flush(std::size_t bytes) {
    hash_ = XXH64(buffer_.data(), bytes, hash_);
    draft_.write(buffer_.data(), end_, bytes);
    end_ += bytes;
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(bytes));
  }

  FileDraft& draft_;
  std::uint64_t hash_ = 0;
  std::vector<std::byte> buffer_;
  ByteWriter out_;
  std::uint64_t end_ = sizeof(Header);
};

[[noreturn]] void refuse(const std::string& path, const std::string& rule) {
  throw Error(path + ": " + rule);
}

Header readHeader(const void* head, std::uint64_t file_size, const std::string& path) {
  Header header = {};
  if (file_size < sizeof header) refuse(path, "is no checkpoint: too short");
  std::memcpy(&header, head, sizeof header);
  if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0) refuse(path, "is no checkpoint");
  if (header.byte_order != kByteOrder) refuse(path, "was written on a machine of another byte order");
  if (header.version != kVersion) {
    refuse(path, "is a checkpoint of version " + std::to_string(header.version) + ", not " +
                     std::to_string(kVersion));
  }
  if (header.file_size != file_size) {
    refuse(path, "is cut off or has grown: " + std::to_string(file_size) + " bytes instead of " +
                     std::to_string(header.file_size));
  }
  return header;
}

// `pool` must get `count` different sets of at most `most` ascending rows below `row_count`.
void readSets(ByteReader& in, std::uint64_t count, std::size_t most, int row_count, const std::string& path,
              ActiveSetPool& pool) {
  std::vector<std::uint16_t> rows;
  in.need(count, sizeof(std::uint16_t));
  for (std::uint64_t k = 0; k < count; ++k) {
    rows.resize(in.get<std::uint16_t>());
    in.getArray(rows.data(), rows.size());
    bool right = rows.size() <= most;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      right = right && rows[i] < row_count && (i == 0 || rows[i - 1] < rows[i]);
    }
    if (!right || !pool.insert({rows.data(), rows.size()})) {
      refuse(path, "active set " + std::to_string(k) + " breaks a rule");
    }
  }
}

void readRegions(ByteReader& in, const Header& header, const std::string& path, ExplorationState& state) {
  for (std::uint64_t k = 0; k < header.regions; ++k) {
    const auto set = in.get<std::uint32_t>();
    const auto facets = in.get<std::uint32_t>();
    if (set >= header.described || (k > 0 && set <= state.regions[k - 1].set)) {
      refuse(path, "region " + std::to_string(k) + " breaks a rule");
    }
    const std::size_t numbers = state.regions.numberCount(facets);
    in.need(numbers, sizeof(double));
    in.getArray(state.regions.add(set, facets), numbers);
  }
}

}  // namespace

std::uint64_t fingerprint(const ParametricProgram& program, const ExploreOptions& options) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  for (const auto* const matrix :
       {&program.H, &program.F, &program.A, &program.S, &program.A_theta, &program.E, &program.C}) {
    putMatrix(*matrix, out);
  }
  for (const auto* const vector : {&program.f, &program.b, &program.b_theta, &program.c})
    putMatrix(*vector, out);
  out.put(static_cast<std::uint64_t>(program.equalities.size()));
  out.putArray(program.equalities.data(), program.equalities.size());
  for (const Signal& signal : program.parameters) {
    out.put(signal.lower);
    out.put(signal.upper);
  }
  out.put(options.facet_tolerance);
  out.put(options.radius_tolerance);
  return hashOf(bytes);
}

void saveCheckpoint(const std::string& path, std::uint64_t fingerprint, const ExplorationState& state) {
  FileDraft draft(path);
  Payload payload(draft);
  payload.put(state.degenerate_facets);
  payload.put(state.pivots);
  payload.put(static_cast<std::uint64_t>(state.failed));
  payload.put(static_cast<std::uint64_t>(state.tight.size()));
  payload.put(static_cast<std::uint64_t>(state.unresolved.size()));
  payload.putSets(state.found);
  for (std::size_t k = 0; k < state.regions.size(); ++k) {
    const RegionStore::Region& region = state.regions[k];
    payload.put(region.set);
    payload.put(region.facets);
    payload.putArray(region.numbers, state.regions.numberCount(region.facets));
  }
  payload.putSets(state.tight);
  payload.putArray(state.unresolved.data(), state.unresolved.size());
  Header header = {};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.byte_order = kByteOrder;
  header.version = kVersion;
  header.fingerprint = fingerprint;
  header.sets = state.found.size();
  header.described = state.described;
  header.regions = state.regions.size();
  payload.finish(header);
  draft.commit();
}

void loadCheckpoint(const std::string& path, std::uint64_t fingerprint, const NormalisedProgram& program,
                    ExplorationState& state) {
  Header header = {};
  const AlignedBytes file = readFile(
      path, [&](const void* head, std::uint64_t file_size) { header = readHeader(head, file_size, path); });
  const std::byte* const payload = file.data() + sizeof header;
  const std::size_t payload_size = file.size() - sizeof header;
  if (header.checksum != checksum(header, hashPieces(payload, payload_size)))
    refuse(path, "is damaged: its checksum is wrong");
  if (header.fingerprint != fingerprint) refuse(path, "belongs to another problem, or to other tolerances");
  ByteReader in(payload, payload_size, path);
  state.degenerate_facets = in.get<std::uint64_t>();
  state.pivots = in.get<std::uint64_t>();
  state.failed = in.get<std::uint64_t>() != 0;
  const auto tight = in.get<std::uint64_t>();
  const auto unresolved = in.get<std::uint64_t>();
  const auto rows = static_cast<std::size_t>(program.m);
  if (header.sets == 0 || header.described > header.sets) refuse(path, "counts of active sets break a rule");
  readSets(in, header.sets, rows, program.m, path, state.found);
  readRegions(in, header, path, state);
  readSets(in, tight, rows, program.m, path, state.tight);
  in.need(unresolved, sizeof(double));
  state.unresolved.resize(unresolved);
  in.getArray(state.unresolved.data(), unresolved);
  if (in.left() != 0 || unresolved % static_cast<std::size_t>(program.p) != 0) {
    refuse(path, "is longer than what it holds");
  }
  state.described = header.described;
}

}  // namespace polyfly
