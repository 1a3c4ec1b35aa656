#include "region_maps/aligned_bytes.hpp"

#include <algorithm>
#include <new>

#include "region_maps/format.hpp"

namespace polyfly {
namespace {

constexpr std::align_val_t kPlace{format::kAlignment};

}  // namespace

AlignedBytes::AlignedBytes(std::size_t size)
    : place_(static_cast<std::byte*>(::operator new(size, kPlace))), size_(size) {}

AlignedBytes::AlignedBytes(const std::vector<std::byte>& bytes) : AlignedBytes(bytes.size()) {
  std::copy(bytes.begin(), bytes.end(), place_.get());
}

void AlignedBytes::Release::operator()(std::byte* place) const noexcept { ::operator delete(place, kPlace); }

}  // namespace polyfly
