#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "certify/result_bytes.hpp"
#include "explore/parallel/group_exchange.hpp"
#include "offline_mpt/certify.hpp"
#include "support/in_parallel.hpp"

namespace polyfly {

/// results[i] = work(i) for all i: divided among the threads of all processes, each of which then has all results.
/// `progress` counts to the number of results. False when stopped, then in all processes.
template <typename Result>
bool fillShared(std::vector<Result>& results, const CertifyOptions& options,
                const std::function<void(std::uint64_t, std::uint64_t)>& progress,
                const std::function<Result(std::uint32_t)>& work) {
  GroupExchange exchange(options.group);
  const auto size = static_cast<std::uint64_t>(exchange.size()),
             rank = static_cast<std::uint64_t>(exchange.rank());
  const std::uint64_t own = results.size() > rank ? (results.size() - rank + size - 1) / size : 0;
  const auto shown = [&](std::uint64_t done, std::uint64_t) {
    progress(std::min<std::uint64_t>(size * done, results.size()), results.size());
  };
  bool finished = inParallel(own, options.threads, options.stop,
                             progress ? shown : std::function<void(std::uint64_t, std::uint64_t)>(),
                             [&](std::size_t, std::uint64_t k) {
                               const std::uint64_t i = rank + size * k;
                               results[i] = work(static_cast<std::uint32_t>(i));
                             });
  finished = finished && (options.stop == nullptr || !options.stop->load());
  if (size == 1) return finished;
  std::vector<std::byte> mine;
  ResultArchive out = ResultArchive::writing(mine);
  out(finished);
  for (std::uint64_t i = rank; i < results.size() && finished; i += size) out(results[i]);
  const std::vector<std::vector<std::byte>> all = exchange.round(std::move(mine));
  for (std::uint64_t other = 0; other < size; ++other) {
    ResultArchive in = ResultArchive::reading(all[other]);
    bool theirs = false;
    in(theirs);
    if (!theirs) return false;
    for (std::uint64_t i = other; i < results.size() && other != rank; i += size) in(results[i]);
  }
  return true;
}

}  // namespace polyfly
