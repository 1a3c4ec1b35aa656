#pragma once

#include "dispatcher.hpp"
#include "least_distance.hpp"
#include "offline_mpt/explore.hpp"

namespace polyfly {

/// Threads of a crew: those asked for, at most the machine's.
int crewSize(const ExploreOptions& options);

/// Describes what the desk hands out until it hands out nothing, on `threads` threads, the calling one among
/// them.
void runCrew(const LeastDistance& program, const ExploreOptions& options, int threads, Desk& desk);

}  // namespace polyfly
