#include "explore/parallel/region_round.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <thread>

#include "explore/parallel/result_message.hpp"
#include "polyfly_base/error.hpp"
#include "support/byte_stream.hpp"
#include "support/in_parallel.hpp"

namespace polyfly {
namespace {

// Sets of a round for each thread: enough that the last ones keep few threads waiting.
constexpr std::uint64_t kSetsOfThread = 32;

int threadsOf(const ExploreOptions& options) {
  return std::clamp(options.threads, 1, static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
}

std::vector<std::byte> greeting(int threads, std::uint64_t fingerprint) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  out.put(static_cast<std::uint32_t>(threads));
  out.put(fingerprint);
  return bytes;
}

}  // namespace

RegionThreads::RegionThreads(const NormalisedProgram& program, const ExploreOptions& options) {
  for (int k = 0; k < threadsOf(options); ++k)
    workspaces_.push_back(std::make_unique<RegionWorkspace>(program, options));
}

void RegionThreads::forEach(std::uint64_t count,
                            const std::function<void(std::uint64_t, std::uint64_t)>& progress,
                            const std::function<void(RegionWorkspace&, std::uint64_t)>& work) {
  if (count <= 1 || (this->count() == 1 && !progress)) {
    for (std::uint64_t i = 0; i < count; ++i) work(*workspaces_.front(), i);
    return;
  }
  const int threads = static_cast<int>(std::min<std::uint64_t>(count, workspaces_.size()));
  inParallel(count, threads, nullptr, progress,
             [&](std::size_t thread, std::uint64_t i) { work(*workspaces_[thread], i); });
}

RegionRound::RegionRound(const NormalisedProgram& program, const ExploreOptions& options,
                         std::uint64_t fingerprint, RegionThreads& threads)
    : program_(program), threads_(threads), exchange_(options.group) {
  const std::vector<std::vector<std::byte>> all =
      exchange_.gather(greeting(threads.count(), fingerprint), exchange_.everyone());
  for (std::size_t rank = 0; rank < all.size(); ++rank) {
    const std::string name = "process " + std::to_string(rank);
    ByteReader in(all[rank].data(), all[rank].size(), "message of " + name);
    slots_.insert(slots_.end(), in.get<std::uint32_t>(), static_cast<int>(rank));
    if (in.get<std::uint64_t>() != fingerprint) throw Error(name + ": has read another problem");
  }
}

RegionRound::~RegionRound() {
  for (int rank = 1; rank < exchange_.size(); ++rank) exchange_.give(rank, {});
}

std::uint64_t RegionRound::size() const { return kSetsOfThread * slots_.size(); }

void RegionRound::give(int to, const ActiveSetPool& sets, std::uint32_t first, std::uint64_t count) {
  std::vector<std::byte> task;
  ByteWriter out(task);
  for (std::uint64_t k = 0; k < count; ++k) {
    if (processOf(k) == to) writeSet(sets[first + static_cast<std::uint32_t>(k)], out);
  }
  exchange_.give(to, task);
}

std::uint64_t RegionRound::compute(const ActiveSetPool& sets, std::uint32_t first, std::uint64_t count,
                                   const std::function<bool()>& isOver, std::vector<RegionResult>& results) {
  if (results.size() < count) results.resize(count);
  std::vector<std::uint64_t> own;
  std::vector<char> asked(static_cast<std::size_t>(exchange_.size()), 0), is_done(count, 0);
  for (std::uint64_t k = 0; k < count; ++k) {
    if (processOf(k) == 0) own.push_back(k);
    asked[static_cast<std::size_t>(processOf(k))] = 1;
  }
  for (int rank = 1; rank < exchange_.size(); ++rank) {
    if (asked[static_cast<std::size_t>(rank)] != 0) give(rank, sets, first, count);
  }
  threads_.forEach(own.size(), {}, [&](RegionWorkspace& workspace, std::uint64_t i) {
    if (isOver()) return;
    const RowSpan rows = sets[first + static_cast<std::uint32_t>(own[i])];
    computeRegion(program_, workspace, ActiveSet(rows.begin(), rows.end()), results[own[i]]);
    is_done[own[i]] = 1;
  });
  const auto done = [&] {
    return static_cast<std::uint64_t>(std::find(is_done.begin(), is_done.end(), 0) - is_done.begin());
  };
  // Whoever is interrupted does not wait for the others.
  if (exchange_.size() == 1 || isOver()) return done();
  const std::vector<std::vector<std::byte>> all = exchange_.gather({}, asked);
  std::vector<ByteReader> in;
  for (std::size_t rank = 0; rank < all.size(); ++rank)
    in.emplace_back(all[rank].data(), all[rank].size(), "message of process " + std::to_string(rank));
  for (std::uint64_t k = 0; k < count; ++k) {
    if (processOf(k) == 0) continue;
    readResult(program_, in[static_cast<std::size_t>(processOf(k))], results[k]);
    is_done[k] = 1;
  }
  return done();
}

void assistRounds(const NormalisedProgram& program, std::uint64_t fingerprint, RegionThreads& threads,
                  ProcessGroup& group) {
  GroupExchange exchange(&group);
  exchange.contribute(greeting(threads.count(), fingerprint));
  std::vector<RegionResult> results;
  std::vector<ActiveSet> sets;
  while (const auto task = GroupExchange::task(group)) {
    if (task->empty()) return;
    ByteReader in(task->data(), task->size(), "message of process 0");
    for (sets.clear(); in.left() > 0;) {
      sets.emplace_back(in.get<std::uint16_t>());
      in.getArray(sets.back().data(), sets.back().size());
    }
    if (results.size() < sets.size()) results.resize(sets.size());
    threads.forEach(sets.size(), {}, [&](RegionWorkspace& workspace, std::uint64_t i) {
      computeRegion(program, workspace, sets[i], results[i]);
    });
    std::vector<std::byte> mine;
    ByteWriter out(mine);
    for (std::size_t i = 0; i < sets.size(); ++i) writeResult(results[i], out);
    exchange.contribute(mine);
  }
}

}  // namespace polyfly
