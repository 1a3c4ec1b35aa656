#include "region_cover.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "cone.hpp"
#include "in_parallel.hpp"

namespace polyfly {
namespace {

constexpr double kTouches = 1e-9;         // [scaled] by which a region must reach over a plane to count there
constexpr std::size_t kPlanesTried = 48;  // planes weighed against each other to cut one cell
constexpr std::size_t kTasks = 64;        // cells that threads share out
constexpr int kWholeBits = 40;
constexpr double kWhole = 0x1p40;  // of a share that is done

/// Least and greatest a . y - c over points, times sign.
struct Reach {
  double least = std::numeric_limits<double>::infinity();
  double greatest = -std::numeric_limits<double>::infinity();
};

Reach reachOf(const std::vector<double>& points, const double* plane, double sign, int p) {
  Reach reach;
  for (std::size_t k = 0; k < points.size(); k += static_cast<std::size_t>(p)) {
    double value = -plane[p];
    for (int j = 0; j < p; ++j) value += plane[j] * points[k + static_cast<std::size_t>(j)];
    value *= sign;
    reach.least = std::min(reach.least, value);
    reach.greatest = std::max(reach.greatest, value);
  }
  return reach;
}

}  // namespace

/// A plane of the map: in the space of parameters rounded, in that of the cell exact.
struct RegionCover::Plane {
  const double* row = nullptr;  // into the map, p + 1 numbers
  double sign = 1.0;
  std::vector<Integer> inside;  // >= 0 where the half-space holds
};

/// A polytope by its generators, with their images, rounded.
struct RegionCover::Cell {
  DoubleDescription cone;
  std::vector<double> images;  // p numbers for each vertex
};

/// A cell of its own, and what became of it.
struct RegionCover::Task {
  std::optional<Cell> cell;
  std::vector<std::uint32_t> candidates;
  int depth = 0;
  bool settled = false;
  bool covered = false;
  std::uint64_t cells = 0;
  std::vector<Sliver> slivers;
  RationalVector gap;
};

RegionCover::RegionCover(const MapRegions& regions, RationalMatrix M, RationalVector m)
    : regions_(regions), M_(std::move(M)), m_(std::move(m)) {
  for (std::vector<std::vector<IntegerRow>>& rows : insides_) rows.resize(regions.count());
  for (int i = 0; i < M_.rows(); ++i) {
    for (int j = 0; j < M_.columns(); ++j) rounded_M_.push_back(M_(i, j).get_d());
    rounded_m_.push_back(m_[static_cast<std::size_t>(i)].get_d());
  }
}

// The rows of a region, as they are or moved outwards, in the space of the cells: made once.
const std::vector<RegionCover::IntegerRow>& RegionCover::insidesOf(std::uint32_t region, bool moved) {
  std::vector<IntegerRow>& rows = insides_[moved ? 1 : 0][region];
  const std::uint32_t count = regions_.map().region(region).row_count;
  while (rows.size() < count) {
    const auto row = static_cast<std::uint32_t>(rows.size());
    rows.push_back(planeOf(region, row, moved ? regions_.tolerance() : 0.0).inside);
  }
  return rows;
}

RegionCover::Plane RegionCover::planeOf(std::uint32_t region, std::uint32_t row, double move) const {
  const std::int32_t number = regions_.map().region(region).rows[row];
  Plane plane;
  plane.row = regions_.map().plane(static_cast<std::size_t>(std::abs(number)) - 1);
  plane.sign = number > 0 ? 1.0 : -1.0;
  const ExactHalfSpace half_space = regions_.row(region, row);
  RationalVector values{half_space.b + Rational(move) - dot(half_space.a, m_)};
  for (const Rational& value : applyTransposed(M_, half_space.a)) values.emplace_back(-value);
  plane.inside = wholeNumbers(values);
  return plane;
}

RegionCover::Cell RegionCover::cellOf(DoubleDescription cone) const {
  Cell cell{std::move(cone), {}};
  for (const DoubleDescription::Ray& ray : cell.cone.rays()) {
    for (int i = 0; i < M_.rows(); ++i) {
      double sum = rounded_m_[static_cast<std::size_t>(i)];
      for (int j = 0; j < M_.columns(); ++j) {
        const double factor = rounded_M_[static_cast<std::size_t>(i * M_.columns() + j)];
        if (factor != 0.0) sum += factor * ratio(ray.value[static_cast<std::size_t>(j) + 1], ray.value[0]);
      }
      cell.images.push_back(sum);
    }
  }
  return cell;
}

std::vector<std::uint32_t> RegionCover::all() const {
  std::vector<std::uint32_t> result;
  for (std::uint32_t r = 0; r < regions_.count(); ++r) {
    if (!regions_.shape(r).empty()) result.push_back(r);
  }
  return result;
}

// Regions whose bounding boxes meet that of the cell, so far as rounded numbers tell.
std::vector<std::uint32_t> RegionCover::near(const Cell& cell) const {
  const int p = regions_.parameters();
  std::vector<std::uint32_t> result;
  for (const std::uint32_t region : all()) {
    bool apart = false;
    for (int j = 0; j < p && !apart; ++j) {
      std::vector<double> axis(static_cast<std::size_t>(p) + 1, 0.0);
      axis[static_cast<std::size_t>(j)] = 1.0;
      const Reach mine = reachOf(cell.images, axis.data(), 1.0, p);
      const Reach other = reachOf(regions_.shape(region), axis.data(), 1.0, p);
      apart = mine.least > other.greatest || other.least > mine.greatest;
    }
    if (!apart) result.push_back(region);
  }
  return result;
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
  tasks.front().cell = cellOf(polytope.cone);
  tasks.front().candidates = near(*tasks.front().cell);
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
bool RegionCover::liesIn(const Cell& cell, std::uint32_t region, bool moved) {
  const double move = moved ? regions_.tolerance() : 0.0;
  const RegionView view = regions_.map().region(region);
  for (std::uint32_t i = 0; i < view.row_count; ++i) {
    const double* plane = regions_.map().plane(static_cast<std::size_t>(std::abs(view.rows[i])) - 1);
    const double sign = view.rows[i] > 0 ? 1.0 : -1.0;
    if (reachOf(cell.images, plane, sign, regions_.parameters()).greatest > move + kTouches) return false;
  }
  for (const IntegerRow& row : insidesOf(region, moved)) {
    for (const DoubleDescription::Ray& ray : cell.cone.rays()) {
      if (dot(row, ray.value) < 0) return false;
    }
  }
  return true;
}

// Whether a plane has points of the cell strictly on both sides.
bool RegionCover::cuts(const Cell& cell, const Plane& plane) {
  bool in = false, out = false;
  for (const DoubleDescription::Ray& ray : cell.cone.rays()) {
    const Integer value = dot(plane.inside, ray.value);
    in = in || value > 0;
    out = out || value < 0;
    if (in && out) return true;
  }
  return false;
}

// Rows of candidates whose planes seem to cut the cell, each plane once.
std::vector<RegionCover::RowOf> RegionCover::cuttingRows(const Cell& cell,
                                                         const std::vector<std::uint32_t>& candidates) const {
  std::vector<RowOf> rows;
  std::vector<std::int32_t> seen;
  for (const std::uint32_t region : candidates) {
    const RegionView view = regions_.map().region(region);
    for (std::uint32_t i = 0; i < view.row_count; ++i) {
      const std::int32_t index = std::abs(view.rows[i]) - 1;
      if (std::find(seen.begin(), seen.end(), index) != seen.end()) continue;
      const double* plane = regions_.map().plane(static_cast<std::size_t>(index));
      const Reach reach = reachOf(cell.images, plane, 1.0, regions_.parameters());
      if (reach.least >= 0.0 || reach.greatest <= 0.0) continue;
      seen.push_back(index);
      rows.push_back({region, i});
    }
    if (rows.size() > 8 * kPlanesTried) break;
  }
  return rows;
}

// Of the candidates' planes that cut the cell, the one that leaves the fewest candidates on its fuller side.
bool RegionCover::choosePlane(const Cell& cell, const std::vector<std::uint32_t>& candidates,
                              Plane& plane) const {
  const int p = regions_.parameters();
  const std::vector<RowOf> rows = cuttingRows(cell, candidates);
  const std::size_t stride = rows.size() / kPlanesTried + 1;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  double widest = 0.0;
  bool found = false;
  for (std::size_t k = 0; k < rows.size(); k += stride) {
    const std::int32_t number = regions_.map().region(rows[k].region).rows[rows[k].row];
    const double* numbers = regions_.map().plane(static_cast<std::size_t>(std::abs(number)) - 1);
    std::size_t below = 0, above = 0;
    for (const std::uint32_t other : candidates) {
      const Reach reach = reachOf(regions_.shape(other), numbers, 1.0, p);
      below += reach.least < -kTouches ? 1 : 0;
      above += reach.greatest > kTouches ? 1 : 0;
    }
    const Reach reach = reachOf(cell.images, numbers, 1.0, p);
    const double width = std::min(-reach.least, reach.greatest);
    const std::size_t fuller = std::max(below, above);
    if (fuller > fewest || (fuller == fewest && width <= widest)) continue;
    const Plane candidate = planeOf(rows[k].region, rows[k].row, 0.0);
    if (!cuts(cell, candidate)) continue;
    fewest = fuller;
    widest = width;
    plane = candidate;
    found = true;
  }
  return found;
}

// The last resort, without rounded guesses: any plane of any region that cuts the cell, or one moved
// outwards.
bool RegionCover::anyPlane(const Cell& cell, Plane& plane) const {
  for (const double move : {0.0, regions_.tolerance()}) {
    for (std::uint32_t region = 0; region < regions_.count(); ++region) {
      const RegionView view = regions_.map().region(region);
      bool apart = false;  // some half-space has none of the cell
      std::vector<Plane> across;
      for (std::uint32_t i = 0; i < view.row_count && !apart; ++i) {
        const double* numbers = regions_.map().plane(static_cast<std::size_t>(std::abs(view.rows[i])) - 1);
        const double sign = view.rows[i] > 0 ? 1.0 : -1.0;
        const Reach reach = reachOf(cell.images, numbers, sign, regions_.parameters());
        apart = reach.least > regions_.tolerance() + kTouches;
        if (apart) break;
        Plane candidate = planeOf(region, i, move);
        if (cuts(cell, candidate)) across.push_back(std::move(candidate));
      }
      if (apart || across.empty()) continue;
      plane = std::move(across.front());
      plane.row = nullptr;
      return true;
    }
  }
  return false;
}

bool RegionCover::isCovered(const Cell& cell, const std::vector<std::uint32_t>& candidates) {
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

void RegionCover::storeGap(const Cell& cell) {
  gap_.assign(static_cast<std::size_t>(M_.columns()), Rational(0));
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
RegionCover::Step RegionCover::step(const Cell& cell, const std::vector<std::uint32_t>& candidates,
                                    Task* parts) {
  if (isCovered(cell, candidates)) return Step::kCovered;
  Plane plane;
  if (!choosePlane(cell, candidates, plane)) {
    if (isCovered(cell, all())) return Step::kCovered;
    if (!anyPlane(cell, plane)) return Step::kGap;
  }
  for (const bool inside : {true, false}) {
    DoubleDescription cone = cell.cone;
    std::vector<Integer> row = plane.inside;
    if (!inside) {
      for (Integer& value : row) value = -value;
    }
    cone.add(row);
    const double sign = inside ? plane.sign : -plane.sign;
    Task& part = parts[inside ? 0 : 1];
    for (const std::uint32_t region : candidates) {
      if (plane.row == nullptr ||
          reachOf(regions_.shape(region), plane.row, sign, regions_.parameters()).least < -kTouches)
        part.candidates.push_back(region);
    }
    part.cell = cellOf(std::move(cone));
  }
  return Step::kCut;
}

bool RegionCover::coverCell(const Cell& cell, const std::vector<std::uint32_t>& candidates, int depth) {
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
