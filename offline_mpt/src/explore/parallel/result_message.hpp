#pragma once

#include "explore/region/compute_region.hpp"
#include "program/normalised_program.hpp"
#include "support/byte_stream.hpp"

namespace polyfly {

/// Appends what ExplorationState::merge needs of a result, for the messages between processes.
void writeResult(const RegionResult& result, ByteWriter& out);

/// Reads what writeResult wrote; origins of facets and the points beyond them are not filled in. Throws Error where
/// the message is cut off.
void readResult(const NormalisedProgram& program, ByteReader& in, RegionResult& result);

/// The rows of a set, and their number.
void writeSet(RowSpan set, ByteWriter& out);

}  // namespace polyfly
