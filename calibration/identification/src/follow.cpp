#include "follow.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "polyfly_base/error.hpp"
#include "polyfly_base/quantile.hpp"

namespace polyfly {
namespace {

// Length of the cells in which energies are summed [s], and cells of a stretch that is judged, and of a short one.
constexpr double kCell = 0.5;
constexpr std::size_t kJudgedCells = 4;
constexpr std::size_t kShortCells = 2;
// Ratio of residual to response that counts as explained, and above which the response does not follow.
constexpr double kExplained = 0.5;
constexpr double kUnexplained = 0.75;
// Residual of a stretch that does not follow, relative to the usual one: where it is not explained at all, and where it
// is explained by less than half.
constexpr double kAway = 2.5;
constexpr double kFarAway = 5.0;
constexpr int kRounds = 4;
// Evaluations of each search: the model that judges need not be the best.
constexpr int kRoughSearch = 100;

// Energy of response and residual within a stretch of time.
struct Cell {
  TimeWindow window;
  double response = 0.0;
  double residual = 0.0;
  double samples = 0.0;

  // Residual, root mean square, and as a share of the response.
  double missed() const { return std::sqrt(residual / std::max(1.0, samples)); }
  double ratio() const { return residual > 0.0 ? std::sqrt(residual / response) : 0.0; }
};

// Cells of each segment.
using Cells = std::vector<std::vector<Cell>>;

// The response without a model is the level around which it moves.
Cells cellsOf(const LoopFit& fit, const std::vector<LoopSegment>& segments, double level) {
  const std::vector<std::vector<double>> prediction = predictLoop(fit, segments).prediction;
  Cells cells(segments.size());
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const LoopSegment& segment = segments[s];
    const double count = std::max(1.0, std::floor(segment.duration() / kCell));
    const double length = segment.duration() / count;
    for (double i = 0.0; i < count; ++i) {
      const double from = segment.time.front() + length * i;
      cells[s].push_back({{from, from + length}});
    }
    for (std::size_t i = 0; i < segment.time.size(); ++i) {
      const auto place = static_cast<std::size_t>((segment.time[i] - segment.time.front()) / length);
      Cell& cell = cells[s][std::min(cells[s].size() - 1, place)];
      cell.response += std::pow(segment.response[i] - level, 2);
      cell.residual += std::pow(segment.response[i] - prediction[s][i], 2);
      cell.samples += 1.0;
    }
  }
  return cells;
}

// The stretches of so many cells, by their first ones. A part that is shorter is one stretch.
std::vector<Cell> stretchesOf(const std::vector<Cell>& cells, std::size_t length) {
  std::vector<Cell> stretches;
  for (std::size_t first = 0; first == 0 || first + length <= cells.size(); ++first) {
    Cell sum = cells[first];
    for (std::size_t i = first + 1; i < std::min(cells.size(), first + length); ++i) {
      sum.response += cells[i].response;
      sum.residual += cells[i].residual;
      sum.samples += cells[i].samples;
    }
    stretches.push_back(sum);
  }
  return stretches;
}

std::optional<LoopFit> tryFit(const LoopRecord& record, const std::vector<TimeWindow>& windows,
                              const FitOptions& options) {
  const std::vector<LoopSegment> segments = cutSegments(record, windows, options.delay_greatest);
  if (segments.empty()) return std::nullopt;
  try {
    return fitLoop(segments, options);
  } catch (const Error&) {
    return std::nullopt;  // nothing moves
  }
}

// Residual of the stretches that the model explains by half, the middle one; none if there is none.
std::optional<double> usualResidual(const Cells& cells) {
  std::vector<double> residuals;
  for (const std::vector<Cell>& part : cells) {
    for (const Cell& stretch : stretchesOf(part, kJudgedCells)) {
      if (stretch.samples > 0.0 && stretch.response > 0.0 && stretch.ratio() < kExplained)
        residuals.push_back(stretch.missed());
    }
  }
  if (residuals.empty()) return std::nullopt;
  return quantileOf(std::move(residuals));
}

// The cells of stretches that do not follow, and those beside them in which the model misses by as much.
std::vector<bool> rejectedCells(const std::vector<Cell>& cells, double usual) {
  std::vector<bool> rejected(cells.size(), false);
  // Short stretches must miss by far.
  for (const std::size_t length : {kJudgedCells, kShortCells}) {
    const std::vector<Cell> stretches = stretchesOf(cells, length);
    for (std::size_t i = 0; i < stretches.size(); ++i) {
      const Cell& one = stretches[i];
      const bool away = length == kJudgedCells && one.ratio() > kUnexplained && one.missed() > kAway * usual;
      const bool far_away = one.ratio() > kExplained && one.missed() > kFarAway * usual;
      for (std::size_t k = i; k < std::min(cells.size(), i + length); ++k)
        rejected[k] = rejected[k] || away || far_away;
    }
  }
  const auto misses = [&](std::size_t i) { return cells[i].missed() > kAway * usual; };
  for (std::size_t i = 1; i < cells.size(); ++i) rejected[i] = rejected[i] || (rejected[i - 1] && misses(i));
  for (std::size_t i = cells.size() - 1; i > 0; --i)
    rejected[i - 1] = rejected[i - 1] || (rejected[i] && misses(i - 1));
  return rejected;
}

// What is left of the windows without these cells, as far as it is long enough to be used.
std::vector<TimeWindow> keptOf(const std::vector<TimeWindow>& windows, const Cells& cells, double usual) {
  std::vector<RejectedWindow> out;
  for (const std::vector<Cell>& part : cells) {
    const std::vector<bool> rejected = rejectedCells(part, usual);
    for (std::size_t i = 0; i < part.size(); ++i) {
      if (rejected[i]) out.push_back({part[i].window, ""});
    }
  }
  std::vector<TimeWindow> kept = windowsWithout(windows, out);
  kept.erase(std::remove_if(kept.begin(), kept.end(),
                            [](const TimeWindow& window) { return window.to - window.from < kLeastWindow; }),
             kept.end());
  return kept;
}

}  // namespace

void keepWhatFollows(const LoopRecord& record, const FitOptions& fit, ExcitationChoice* choice) {
  FitOptions options = fit;
  options.global_evaluations = options.local_evaluations = kRoughSearch;
  options.order = LoopOrder::kFirst;
  options.with_delay = true;
  const std::vector<LoopSegment> segments = cutSegments(record, choice->windows, options.delay_greatest);
  if (segments.empty()) return;
  std::vector<double> responses;
  for (const LoopSegment& segment : segments)
    responses.insert(responses.end(), segment.response.begin(), segment.response.end());
  const double level = quantileOf(std::move(responses));
  std::optional<LoopFit> model = tryFit(record, choice->windows, options);
  std::vector<TimeWindow> kept = choice->windows;
  for (int round = 0; round < kRounds && model; ++round) {
    const Cells cells = cellsOf(*model, segments, level);
    const std::optional<double> usual = usualResidual(cells);
    if (!usual) return;
    std::vector<TimeWindow> left = keptOf(choice->windows, cells, *usual);
    if (left.empty()) return;
    const bool same = left == kept;
    kept = std::move(left);
    if (same) break;
    model = tryFit(record, kept, options);
  }
  std::vector<RejectedWindow> used;
  for (const TimeWindow& window : kept) used.push_back({window, ""});
  for (const TimeWindow& window : windowsWithout(choice->windows, used))
    choice->rejected.push_back({window, kDoesNotFollow});
  choice->windows = kept;
}

}  // namespace polyfly
