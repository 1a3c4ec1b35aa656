#pragma once

#include <functional>
#include <memory>

#include "explore/parallel/dispatcher.hpp"
#include "offline_mpt/explore_options.hpp"
#include "program/least_distance.hpp"

namespace polyfly {

/// Threads of a crew: those asked for, at most the machine's.
int crewSize(const ExploreOptions& options);

/// What a thread of a crew does with active sets.
class Describer {
 public:
  virtual ~Describer() = default;
  /// Appends what the queue that the set came from reads.
  virtual void answer(RowSpan set, ByteWriter& out) = 0;
};
using MakeDescriber = std::function<std::unique_ptr<Describer>()>;

/// Makes describers that answer in the form that ExplorationState::merge reads.
MakeDescriber regionDescribers(const LeastDistance& program, const ExploreOptions& options);

/// Describes what the desk hands out until it hands out nothing, on `threads` threads, the calling one among
/// them. Each has a describer of its own.
void runCrew(const MakeDescriber& make, int threads, Desk& desk);

}  // namespace polyfly
