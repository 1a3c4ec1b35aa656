#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "region_maps/aligned_bytes.hpp"

namespace polyfly {

/// Number of bytes that a HeadCheck sees at most.
constexpr std::size_t kHeadBytes = 512;

/// Looks at the first bytes of a file: kHeadBytes, or all where the file has fewer. Throws Error where these cannot begin
/// the file that is wanted, or cannot begin a file of that size.
using HeadCheck = std::function<void(const void* head, std::uint64_t file_size)>;

/// All bytes of a regular file, read once. Nothing that happens to the file afterwards reaches them. `check_head` is called
/// before memory is taken for the file. Throws Error with the path where the file is missing, unreadable, empty, no regular
/// file, larger than memory, or changed while it was read.
AlignedBytes readFile(const std::string& path, const HeadCheck& check_head);

}  // namespace polyfly
