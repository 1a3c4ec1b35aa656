#include "region_cover.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

#include "cone.hpp"
#include "region_maps/region_map.hpp"
#include "support/in_parallel.hpp"

namespace polyfly {
namespace {

// Number of cells that threads share.
constexpr std::size_t kTasks = 64;
constexpr int kWholeBits = 40;
// Value of the share counter when all is done.
constexpr double kWhole = 0x1p40;

}  // namespace

/// A cell of its own, and what became of it.
struct RegionCover::Task {
  std::optional<CoverCell> cell;
  std::vector<std::uint32_t> candidates;
  int depth = 0;
  bool settled = false;
  bool covered = false;
  std::uint64_t cells = 0;
  std::vector<Sliver> slivers;
  RationalVector gap;
};

RegionCover::RegionCover(const MapRegions& regions) : regions_(regions), parts_(regions) {
  for (std::vector<std::vector<IntegerRow>>& rows : insides_) rows.resize(regions.count());
}

// The rows of a region, as they are or moved outwards: made once.
const std::vector<RegionCover::IntegerRow>& RegionCover::insidesOf(std::uint32_t region, bool moved) {
  std::vector<IntegerRow>& rows = insides_[moved ? 1 : 0][region];
  const std::uint32_t count = regions_.map().region(region).row_count;
  while (rows.size() < count) {
    const auto row = static_cast<std::uint32_t>(rows.size());
    rows.push_back(parts_.plane(region, row, moved ? regions_.tolerance() : 0.0).inside);
  }
  return rows;
}

// The first cuts make tasks enough for all threads, whatever their number. Their order is that in which one
// thread would come to them, and so is that of all that is found.
bool RegionCover::covers(const ExactPolytope& set, const CoverOptions& options) {
  stop_ = options.stop;
  std::atomic<std::uint64_t> share{0};
  share_ = &share;
  std::vector<Task> tasks = firstCuts(set);
  std::vector<std::size_t> open;
  std::atomic<std::size_t> first_gap{tasks.size()};
  for (std::size_t k = tasks.size(); k-- > 0;) {
    if (!tasks[k].settled) open.push_back(k);
    if (tasks[k].settled && !tasks[k].covered) first_gap = k;
  }
  std::reverse(open.begin(), open.end());
  std::function<void(std::uint64_t, std::uint64_t)> progress;
  if (options.progress) {
    progress = [&](std::uint64_t, std::uint64_t) {
      options.progress(static_cast<double>(share.load()) / kWhole);
    };
  }
  std::vector<RegionCover> workers(static_cast<std::size_t>(std::max(1, options.threads)), *this);
  const bool finished = inParallel(
      open.size(), options.threads, options.stop, progress, [&](std::size_t thread, std::uint64_t i) {
        const std::size_t k = open[i];
        if (k > first_gap.load()) return;
        workers[thread].settle(tasks[k]);
        std::size_t before = first_gap.load();
        while (!tasks[k].covered && k < before && !first_gap.compare_exchange_weak(before, k)) {
        }
      });
  share_ = nullptr;
  stopped_ = !finished || (options.stop != nullptr && options.stop->load());
  return !stopped_ && merge(tasks);
}

std::vector<RegionCover::Task> RegionCover::firstCuts(const ExactPolytope& set) {
  std::vector<Task> tasks;
  const PolytopeCone polytope(set);
  if (polytope.isEmpty()) return tasks;
  tasks.emplace_back();
  tasks.front().cell = parts_.cell(polytope.cone);
  tasks.front().candidates = parts_.near(*tasks.front().cell);
  std::size_t open = 1;
  while (open > 0 && open < kTasks && (stop_ == nullptr || !stop_->load())) {
    std::vector<Task> next;
    open = 0;
    for (Task& task : tasks) {
      if (task.settled) {
        next.push_back(std::move(task));
        continue;
      }
      Task parts[2];
      if (step(*task.cell, task.candidates, parts) == Step::kCut) {
        for (Task& part : parts) {
          part.depth = task.depth + 1;
          next.push_back(std::move(part));
        }
        open += 2;
      } else {
        settle(task);
        next.push_back(std::move(task));
      }
    }
    tasks = std::move(next);
  }
  return tasks;
}

void RegionCover::settle(Task& task) {
  cells_ = 0;
  slivers_.clear();
  gap_.clear();
  task.covered = coverCell(*task.cell, task.candidates, task.depth);
  task.settled = true;
  task.cells = cells_;
  task.slivers = std::move(slivers_);
  task.gap = std::move(gap_);
  task.cell.reset();
}

// Up to the first gap.
bool RegionCover::merge(std::vector<Task>& tasks) {
  cells_ = 0;
  slivers_.clear();
  gap_.clear();
  for (Task& task : tasks) {
    cells_ += task.cells;
    std::move(task.slivers.begin(), task.slivers.end(), std::back_inserter(slivers_));
    if (task.covered) continue;
    gap_ = std::move(task.gap);
    return false;
  }
  return true;
}

// Rounded numbers sort out, exact ones decide.
bool RegionCover::liesIn(const CoverCell& cell, std::uint32_t region, bool moved) {
  if (parts_.reachesOut(cell, region, moved ? regions_.tolerance() : 0.0)) return false;
  for (const IntegerRow& row : insidesOf(region, moved)) {
    for (const DoubleDescription::Ray& ray : cell.cone.rays()) {
      if (dot(row, ray.value) < 0) return false;
    }
  }
  return true;
}

bool RegionCover::isCovered(const CoverCell& cell, const std::vector<std::uint32_t>& candidates) {
  for (const bool moved : {false, true}) {
    const auto found = std::find_if(candidates.begin(), candidates.end(),
                                    [&](std::uint32_t region) { return liesIn(cell, region, moved); });
    if (found == candidates.end()) continue;
    ++cells_;
    if (moved) {
      slivers_.push_back({*found, {}});
      for (const DoubleDescription::Ray& ray : cell.cone.rays())
        slivers_.back().vertices.push_back(ray.value);
    }
    return true;
  }
  return false;
}

void RegionCover::storeGap(const CoverCell& cell) {
  gap_.assign(static_cast<std::size_t>(regions_.parameters()), Rational(0));
  const Rational share(1, static_cast<unsigned long>(cell.cone.rays().size()));
  for (const DoubleDescription::Ray& ray : cell.cone.rays()) {
    for (std::size_t j = 0; j < gap_.size(); ++j) {
      Rational value(ray.value[j + 1], ray.value[0]);
      value.canonicalize();
      gap_[j] += share * value;
    }
  }
}

// Looks at one cell. If it must be cut, `parts` are its two sides.
RegionCover::Step RegionCover::step(const CoverCell& cell, const std::vector<std::uint32_t>& candidates,
                                    Task* parts) {
  if (isCovered(cell, candidates)) return Step::kCovered;
  std::optional<CellPlane> plane = parts_.bestCut(cell, candidates);
  if (!plane) {
    if (isCovered(cell, regions_.shaped())) return Step::kCovered;
    plane = parts_.anyCut(cell);
    if (!plane) return Step::kGap;
  }
  for (const bool inside : {true, false}) {
    Task& part = parts[inside ? 0 : 1];
    part.candidates = parts_.reaching(candidates, *plane, inside);
    part.cell = parts_.part(cell, *plane, inside);
  }
  return Step::kCut;
}

bool RegionCover::coverCell(const CoverCell& cell, const std::vector<std::uint32_t>& candidates, int depth) {
  if (stop_ != nullptr && stop_->load()) {
    stopped_ = true;
    return false;
  }
  Task parts[2];
  switch (step(cell, candidates, parts)) {
    case Step::kCovered:
      if (share_ != nullptr && depth <= kWholeBits) *share_ += std::uint64_t{1} << (kWholeBits - depth);
      return true;
    case Step::kGap:
      storeGap(cell);
      return false;
    case Step::kCut:
      break;
  }
  return coverCell(*parts[0].cell, parts[0].candidates, depth + 1) &&
         coverCell(*parts[1].cell, parts[1].candidates, depth + 1);
}

}  // namespace polyfly
