#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

namespace polyfly {

class ProcessGroup;

struct ExploreProgress {
  /// Finished regions, including those of a checkpoint.
  std::uint64_t regions = 0;
  /// Active sets found, but not yet processed.
  std::uint64_t open = 0;
  /// Active sets processed. Some of them are regions.
  std::uint64_t described = 0;
  /// Accounted memory, see memory_limit.
  std::uint64_t memory = 0;  ///< [bytes]
  /// The checkpoint could not be written when it was last due.
  bool unsaved = false;
};

/// Default of ExploreOptions::radius_tolerance [scaled]. Maps derive tolerances of their own from it.
constexpr double kDefaultRadiusTolerance = 1e-9;

struct ExploreOptions {
  int threads = 1;  ///< worker threads, at most the machine's; the result does not depend on it
  std::uint64_t region_limit = 10'000'000;  ///< stop when so many regions are found
  double time_limit = 0.0;                  ///< [s], of this run, 0: none
  /// [bytes], 0: none. What grows with the exploration counts: regions, active sets, their hash tables,
  /// probes. Not the program, and not the Partition that regions are converted to at the end.
  std::uint64_t memory_limit = 0;
  double facet_tolerance = 1e-9;  ///< least violation that makes a half-space count as a facet [scaled]
  /// Regions with a smaller inscribed ball are left to their neighbours. Maps write planes once that are closer to
  /// each other than a tenth of it. Where rows nearly repeat each other, at most 1e-11 [scaled].
  double radius_tolerance = kDefaultRadiusTolerance;
  const std::atomic<bool>* stop = nullptr;               ///< set from outside to interrupt
  std::function<void(const ExploreProgress&)> progress;  ///< called now and then from the calling thread

  /// File to resume from; empty: none. It is written at the end of every exploration, since the steps that follow
  /// can be stopped too. The caller removes it.
  std::string checkpoint;
  /// Least time between two checkpoints [s]; 0: at the end only.
  double checkpoint_period = 300.0;
  bool resume = false;  ///< go on from `checkpoint`
  /// Other processes that process active sets, see process_group.hpp.
  ProcessGroup* group = nullptr;
};

}  // namespace polyfly
