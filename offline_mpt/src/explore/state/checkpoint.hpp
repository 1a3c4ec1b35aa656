#pragma once

#include <cstdint>
#include <string>

#include "explore/state/exploration_state.hpp"
#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/explore_options.hpp"

namespace polyfly {

/// What an exploration's course depends on: all numbers of the program, and the tolerances. Not its name, its
/// text, threads and limits.
std::uint64_t fingerprint(const ParametricProgram& program, const ExploreOptions& options);

/// Writes the state to a file that replaces `path` when it is whole. Throws Error.
///
/// The file: a header of 64 bytes (magic, byte order, version, size, checksum,
/// fingerprint, numbers of sets, merged sets, regions), then counters, sets in the order of the queue,
/// regions, tight sets and probes, all as they lie in memory. The checksum is the XXH64 of the header, that
/// field zero, seeded with a hash of all that follows.
void saveCheckpoint(const std::string& path, std::uint64_t fingerprint, const ExplorationState& state);

/// Reads a state back into a new one. Throws Error naming `path` when the file is damaged, cut off, of
/// another version or of another problem, or breaks a rule of the state.
void loadCheckpoint(const std::string& path, std::uint64_t fingerprint, const NormalisedProgram& program,
                    ExplorationState& state);

}  // namespace polyfly
