#include "follow.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "polyfly_base/error.hpp"
#include "polyfly_base/quantile.hpp"

namespace polyfly {
namespace {

// Length of the cells in which energies are summed, and cells of a stretch that is judged.
constexpr double kCell = 0.5;  // [s]
constexpr std::size_t kJudgedCells = 4;
// Cells of a short stretch.
constexpr std::size_t kPairCells = 2;
// Parts of the windows that a model is fitted to: most of them, and least length [s].
constexpr double kMostParts = 10.0;
constexpr double kLeastPart = 6.0;
// Ratio of residual to response that counts as explained, and above which the response does not follow.
constexpr double kExplained = 0.5;
constexpr double kUnexplained = 0.75;
// Residual of a stretch that does not follow, relative to the usual one: where it is not explained at all, and where it
// is explained by less than half.
constexpr double kAway = 2.5;
constexpr double kFarAway = 5.0;
// Keeps the ratio finite where the response rests at its level.
constexpr double kTiny = 1e-12;
constexpr int kRounds = 4;
// Evaluations of each search: the model that judges need not be the best.
constexpr int kRoughSearch = 100;

// Energy of response and residual within a cell.
struct Cell {
  double from = 0.0;  ///< [s]
  double to = 0.0;    ///< [s]
  double response = 0.0;
  double residual = 0.0;
  double samples = 0.0;
};

// Response without a model: level around which it moves.
double levelOf(const std::vector<LoopSegment>& segments) {
  std::vector<double> all;
  for (const LoopSegment& segment : segments)
    all.insert(all.end(), segment.response.begin(), segment.response.end());
  return quantileOf(std::move(all));
}

// Cells of each segment.
using Cells = std::vector<std::vector<Cell>>;

Cells cellsOf(const LoopFit& fit, const std::vector<LoopSegment>& segments, double level) {
  const std::vector<std::vector<double>> prediction = predictLoop(fit, segments).prediction;
  Cells cells(segments.size());
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const LoopSegment& segment = segments[s];
    const auto count = std::max(1.0, std::floor(segment.duration() / kCell));
    const double length = segment.duration() / count;
    cells[s].resize(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < cells[s].size(); ++i) {
      cells[s][i].from = segment.time.front() + length * static_cast<double>(i);
      cells[s][i].to = cells[s][i].from + length;
    }
    for (std::size_t i = 0; i < segment.time.size(); ++i) {
      const double place = length > 0.0 ? (segment.time[i] - segment.time.front()) / length : 0.0;
      Cell& cell = cells[s][std::min(cells[s].size() - 1, static_cast<std::size_t>(place))];
      const double away = segment.response[i] - level;
      const double missed = segment.response[i] - prediction[s][i];
      cell.response += away * away;
      cell.residual += missed * missed;
      cell.samples += 1.0;
    }
  }
  return cells;
}

// Sum of neighbouring cells, first one `at`.
Cell stretchAt(const std::vector<Cell>& cells, std::size_t at, std::size_t count = kJudgedCells) {
  Cell sum = cells[at];
  for (std::size_t i = at + 1; i < std::min(cells.size(), at + count); ++i) {
    sum.to = cells[i].to;
    sum.response += cells[i].response;
    sum.residual += cells[i].residual;
    sum.samples += cells[i].samples;
  }
  return sum;
}

std::size_t stretchCount(const std::vector<Cell>& cells) {
  return cells.size() < kJudgedCells ? 1 : cells.size() - kJudgedCells + 1;
}

// Energy that a model explains, cell by cell: what it misses elsewhere does not count against it.
double explainedBy(const LoopFit& fit, const std::vector<LoopSegment>& segments, double level) {
  double sum = 0.0;
  for (const std::vector<Cell>& part : cellsOf(fit, segments, level)) {
    for (const Cell& cell : part) sum += std::max(0.0, cell.response - cell.residual);
  }
  return sum;
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

std::vector<TimeWindow> partsOf(const std::vector<TimeWindow>& windows) {
  double whole = 0.0;
  for (const TimeWindow& window : windows) whole += window.to - window.from;
  const double length = std::max(kLeastPart, whole / kMostParts);
  std::vector<TimeWindow> parts;
  for (const TimeWindow& window : windows) {
    const double count = std::max(1.0, std::round((window.to - window.from) / length));
    for (double i = 0.0; i < count; ++i) {
      parts.push_back({window.from + (window.to - window.from) * i / count,
                       window.from + (window.to - window.from) * (i + 1.0) / count});
    }
  }
  return parts;
}

// The model that most of the windows agree on.
std::optional<LoopFit> agreedModel(const LoopRecord& record, const std::vector<TimeWindow>& windows,
                                   const std::vector<LoopSegment>& segments, const FitOptions& options,
                                   double level) {
  std::optional<LoopFit> best = tryFit(record, windows, options);
  if (!best) return best;
  double most = explainedBy(*best, segments, level);
  for (const TimeWindow& part : partsOf(windows)) {
    std::optional<LoopFit> fit = tryFit(record, {part}, options);
    const double explained = fit ? explainedBy(*fit, segments, level) : 0.0;
    if (explained <= most) continue;
    most = explained;
    best = std::move(fit);
  }
  return best;
}

// Residual (root mean square) of the stretches that the model explains by half, the middle one; none if there is none.
std::optional<double> usualResidual(const Cells& cells) {
  std::vector<double> residuals;
  for (const std::vector<Cell>& part : cells) {
    for (std::size_t i = 0; i < stretchCount(part); ++i) {
      const Cell sum = stretchAt(part, i);
      if (sum.samples > 0.0 && sum.residual < kExplained * kExplained * sum.response)
        residuals.push_back(std::sqrt(sum.residual / sum.samples));
    }
  }
  if (residuals.empty()) return std::nullopt;
  return quantileOf(std::move(residuals));
}

double ratioOf(const Cell& stretch) {
  return std::sqrt(stretch.residual / std::max(stretch.response, stretch.residual * kTiny));
}

double missedBy(const Cell& stretch) { return std::sqrt(stretch.residual / std::max(1.0, stretch.samples)); }

bool missesByFar(const Cell& stretch, double usual) {
  return ratioOf(stretch) > kExplained && missedBy(stretch) > kFarAway * usual;
}

bool isStray(const Cell& stretch, double usual) {
  return missesByFar(stretch, usual) ||
         (ratioOf(stretch) > kUnexplained && missedBy(stretch) > kAway * usual);
}

// The cells of stray stretches, and those beside them in which the model misses by as much.
std::vector<bool> strayCells(const std::vector<Cell>& cells, double usual) {
  std::vector<bool> stray(cells.size(), false);
  for (std::size_t i = 0; i < stretchCount(cells); ++i) {
    if (!isStray(stretchAt(cells, i), usual)) continue;
    std::fill_n(stray.begin() + static_cast<std::ptrdiff_t>(i), std::min(kJudgedCells, cells.size() - i),
                true);
  }
  // Short stretches must miss by far.
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool at_end = i == 0 || i + 1 == cells.size();
    if (at_end && missesByFar(cells[i], usual)) stray[i] = true;
    if (i > 0 && missesByFar(stretchAt(cells, i - 1, kPairCells), usual)) stray[i - 1] = stray[i] = true;
  }
  const auto misses = [&](std::size_t i) { return missedBy(cells[i]) > kAway * usual; };
  for (std::size_t i = 1; i < cells.size(); ++i) {
    if (stray[i - 1] && misses(i)) stray[i] = true;
  }
  for (std::size_t i = cells.size() - 1; i > 0; --i) {
    if (stray[i] && misses(i - 1)) stray[i - 1] = true;
  }
  return stray;
}

std::vector<RejectedWindow> strays(const Cells& cells, double usual) {
  std::vector<RejectedWindow> found;
  for (const std::vector<Cell>& part : cells) {
    const std::vector<bool> stray = strayCells(part, usual);
    for (std::size_t i = 0; i < part.size(); ++i) {
      if (!stray[i]) continue;
      if (i > 0 && stray[i - 1]) {
        found.back().window.to = part[i].to;
      } else {
        found.push_back({{part[i].from, part[i].to}, kDoesNotFollow});
      }
    }
  }
  return found;
}

// What is left of a window must be long enough to be used.
std::vector<TimeWindow> keptOf(const std::vector<TimeWindow>& windows,
                               std::vector<RejectedWindow>* rejected) {
  std::vector<TimeWindow> kept;
  for (const TimeWindow& window : windowsWithout(windows, *rejected)) {
    if (window.to - window.from >= kLeastWindow) kept.push_back(window);
  }
  std::vector<RejectedWindow> others;
  for (const TimeWindow& window : kept) others.push_back({window, ""});
  // Too short pieces go with what they lie beside.
  std::vector<RejectedWindow> all;
  for (const TimeWindow& window : windowsWithout(windows, others)) all.push_back({window, kDoesNotFollow});
  *rejected = std::move(all);
  return kept;
}

}  // namespace

void keepWhatFollows(const LoopRecord& record, const FitOptions& fit, ExcitationChoice* choice) {
  FitOptions options = fit;
  options.global_evaluations = kRoughSearch;
  options.local_evaluations = kRoughSearch;
  options.order = LoopOrder::kFirst;
  options.with_delay = true;
  const std::vector<LoopSegment> segments = cutSegments(record, choice->windows, options.delay_greatest);
  if (segments.empty()) return;
  const double level = levelOf(segments);
  std::optional<LoopFit> model = agreedModel(record, choice->windows, segments, options, level);
  std::vector<RejectedWindow> rejected;
  std::vector<TimeWindow> kept = choice->windows;
  for (int round = 0; round < kRounds && model; ++round) {
    const Cells cells = cellsOf(*model, segments, level);
    const std::optional<double> usual = usualResidual(cells);
    if (!usual) return;
    std::vector<RejectedWindow> found = strays(cells, *usual);
    std::vector<TimeWindow> left = keptOf(choice->windows, &found);
    if (left.empty()) return;
    const bool same =
        found.size() == rejected.size() &&
        std::equal(found.begin(), found.end(), rejected.begin(), [](const auto& a, const auto& b) {
          return a.window.from == b.window.from && a.window.to == b.window.to;
        });
    rejected = std::move(found);
    kept = std::move(left);
    if (same) break;
    model = tryFit(record, kept, options);
  }
  choice->windows = kept;
  choice->rejected.insert(choice->rejected.end(), rejected.begin(), rejected.end());
}

}  // namespace polyfly
