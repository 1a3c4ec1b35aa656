#include "unpack_chunk.hpp"

#include <bzlib.h>
#include <lz4frame.h>

#include <limits>
#include <memory>

namespace polyfly {
namespace {

std::string unpackBz2(const std::uint8_t* data, std::size_t packed, std::vector<std::uint8_t>* out) {
  auto length = static_cast<unsigned>(out->size());
  // The library takes its input through a pointer that is not const, and leaves it as it is.
  auto* source = const_cast<char*>(reinterpret_cast<const char*>(data));
  const int result = BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(out->data()), &length, source,
                                                static_cast<unsigned>(packed), 0, 0);
  if (result != BZ_OK) return "has damaged bz2 data";
  return length == out->size() ? "" : "holds fewer bytes than it says";
}

std::string unpackLz4(const std::uint8_t* data, std::size_t packed, std::vector<std::uint8_t>* out) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0)
    return "needs more memory than there is";
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> guard(
      context, &LZ4F_freeDecompressionContext);
  std::size_t read = 0;
  std::size_t written = 0;
  std::size_t hint = 1;
  while (hint != 0 && read < packed) {
    std::size_t source = packed - read;
    std::size_t target = out->size() - written;
    hint = LZ4F_decompress(context, out->data() + written, &target, data + read, &source, nullptr);
    if (LZ4F_isError(hint) != 0) return "has damaged lz4 data";
    if (source == 0 && target == 0) return "has lz4 data that are longer than it says";
    read += source;
    written += target;
  }
  if (hint != 0) return "has lz4 data that end too early";
  return written == out->size() ? "" : "holds fewer bytes than it says";
}

}  // namespace

std::string unpackChunk(const std::string& compression, const std::uint8_t* data, std::size_t packed,
                        std::size_t size, std::vector<std::uint8_t>* out) {
  if (size > kGreatestChunk || packed > std::numeric_limits<unsigned>::max())
    return "is larger than any recorder makes";
  if (compression == "none") {
    if (packed != size) return "holds another number of bytes than it says";
    out->assign(data, data + packed);
    return "";
  }
  if (size == 0) {
    out->clear();
    return "";
  }
  out->resize(size);
  if (compression == "bz2") return unpackBz2(data, packed, out);
  if (compression == "lz4") return unpackLz4(data, packed, out);
  return "is packed in a way that is not known: " + compression;
}

}  // namespace polyfly
