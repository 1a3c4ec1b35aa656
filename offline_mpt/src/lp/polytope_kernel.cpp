#include "lp/polytope_kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "lp/dictionary.hpp"
#include "lp/tolerances.hpp"

namespace polyfly {
namespace {

enum class RowState : char { kUnknown, kFacet, kRedundant };

template <int N>
class KernelOf final : public PolytopeSolver::Kernel {
 public:
  bool minimal(const double* rows, int count, const double* interior, double tolerance,
               MinimalRows& result) override {
    if (!dictionary_.start(rows, count, interior)) return false;
    begin(0, count, tolerance, {});
    sweep();
    return decideAll(0, count, result) && isPrecise(rows);
  }

  // Straight towards the rows in question: some are decided before a vertex is reached.
  bool minimalBeside(int kept, const double* rows, int count, const double* interior, double tolerance,
                     MinimalRows& result, const LooseRows& loose) override {
    dictionary_.startFree(rows, count, interior);
    begin(kept, count, tolerance, loose);
    return decideAll(kept, count, result) && isPrecise(rows);
  }

  bool maximise(const double* rows, int count, const double* start, const double* direction,
                double* point) override {
    return dictionary_.start(rows, count, start) && climbFromHere(direction, point);
  }

  bool climb(const double* rows, int count, const double* start, const double* direction,
             double* point) override {
    dictionary_.startFree(rows, count, start);
    return climbFromHere(direction, point) && isPrecise(rows);
  }

  // The dual simplex, from the corner of the box. Pivots lose digits where rows meet at sharp angles. So it counts only
  // where it stops without a pivot at a vertex that was factorised anew.
  BoxOptimum::Status maximiseInBox(const double* rows, int count, const double* direction,
                                   BoxOptimum& optimum) override {
    constexpr int kMostVertices = 20;
    std::array<int, N> basis;
    for (int j = 0; j < N; ++j) basis[j] = count + 2 * j + (direction[j] >= 0.0 ? 0 : 1);
    int left = 50 + 10 * (count + N);
    for (int vertex = 0; vertex < kMostVertices; ++vertex) {
      if (!dictionary_.startAt(rows, count, basis)) break;
      const auto before = dictionary_.pivots();
      const BoxOptimum::Status status = descend(direction, left, optimum);
      if (status == BoxOptimum::Status::kFailed) break;
      for (int j = 0; j < N; ++j) basis[j] = dictionary_.nonbasic(j);
      if (dictionary_.pivots() == before) {
        readVertex(optimum);
        return status;
      }
    }
    return BoxOptimum::Status::kFailed;
  }

  // A ball has a radius and at least one coordinate.
  Ball ballInBox([[maybe_unused]] const double* rows, [[maybe_unused]] int count,
                 [[maybe_unused]] double* ball) override {
    if constexpr (N > 1) {
      return largestBall(rows, count, ball);
    } else {
      return Ball::kFailed;
    }
  }

  unsigned long long pivots() const override { return dictionary_.pivots(); }

 private:
  static constexpr int kDualPivotLimit = 40 * (N + 1);

  bool isPrecise(const double* rows) const { return dictionary_.drift(rows) <= tolerance::kDrift; }

  // -direction . t in terms of the columns.
  typename Dictionary<N>::Row objectiveOf(const double* direction) const {
    typename Dictionary<N>::Row objective;
    objective.fill(0.0);
    for (int q = 0; q < N; ++q) {
      if (direction[q] == 0.0) continue;
      for (int k = 0; k <= N; ++k) objective[k] -= direction[q] * dictionary_.coordinate(q, k);
    }
    return objective;
  }

  bool climbFromHere(const double* direction, double* point) {
    int stalled = 0;
    for (int round = 0; round < Dictionary<N>::kPivotLimit; ++round) {
      const auto objective = objectiveOf(direction);
      double way = Dictionary<N>::kGrowing;
      const int column = stalled > Dictionary<N>::kStallLimit ? dictionary_.fallingColumn(objective, true)
                                                              : dictionary_.steepestColumn(objective, way);
      if (column < 0) {
        dictionary_.point(0, 0.0, point);
        return true;
      }
      const auto [step, blocking] = dictionary_.ratio(column, way);
      if (blocking < 0) return false;
      stalled = step > tolerance::kDegenerateStep ? 0 : stalled + 1;
      dictionary_.pivot(blocking, column);
    }
    return false;
  }

  // Pivots, at most `left`, until no row is violated, or one is by all points.
  BoxOptimum::Status descend(const double* direction, int& left, BoxOptimum& optimum) {
    for (; left > 0; --left) {
      const auto objective = objectiveOf(direction);
      optimum.weights.clear();
      const int place = dictionary_.worstPlace(tolerance::kEnteringViolation);
      if (place < 0) {
        for (int j = 0; j < N; ++j) addWeight(dictionary_.nonbasic(j), objective[j + 1], optimum);
        return BoxOptimum::Status::kOptimal;
      }
      const auto row = dictionary_.slack(place);
      const int column =
          enteringColumn(row, tolerance::kLeavingWeight, [&](int j) { return objective[j + 1]; });
      if (column < 0) {
        addWeight(dictionary_.rowAt(place), 1.0, optimum);
        for (int j = 0; j < N; ++j) addWeight(dictionary_.nonbasic(j), -row[j + 1], optimum);
        return BoxOptimum::Status::kInfeasible;
      }
      dictionary_.pivot(place, column);
    }
    return BoxOptimum::Status::kFailed;
  }

  static void addWeight(int row, double weight, BoxOptimum& optimum) {
    if (weight > 0.0) optimum.weights.emplace_back(row, weight);
  }

  void readVertex(BoxOptimum& optimum) const {
    optimum.t.resize(N);
    dictionary_.point(0, 0.0, optimum.t.data());
    optimum.basis.clear();
    for (int j = 0; j < N; ++j) optimum.basis.push_back(dictionary_.nonbasic(j));
  }

  // The dual simplex: what the rows looked at so far allow bounds the radius from above.
  Ball largestBall(const double* rows, int count, double* ball) {
    dictionary_.startInBox(rows, count);
    for (int round = 0; round < kDualPivotLimit; ++round) {
      const int place = dictionary_.worstPlace(tolerance::kNegativeSlack);
      if (place < 0) {
        dictionary_.point(0, 0.0, ball);
        return Ball::kFound;
      }
      const int column = enteringColumn(dictionary_.slack(place), tolerance::kPivot,
                                        [&](int j) { return -dictionary_.coordinate(N - 1, j + 1); });
      if (column < 0) return Ball::kFailed;
      dictionary_.pivot(place, column);
      if (dictionary_.coordinate(N - 1, 0) >= -2.0 * tolerance::kHopelessRadius) continue;
      ball[N - 1] = radiusBound(rows);
      if (ball[N - 1] < -tolerance::kHopelessRadius) return Ball::kHopeless;
    }
    return Ball::kFailed;
  }

  // Along which the row grows while the objective falls least; `fall` tells how much it falls along a column.
  template <typename Fall>
  static int enteringColumn(const typename Dictionary<N>::Row& row, double threshold, const Fall& fall) {
    int best = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int j = 0; j < N; ++j) {
      if (row[j + 1] <= threshold) continue;
      const double price = std::max(fall(j), 0.0) / row[j + 1];
      if (price > least || (price == least && best >= 0 && row[j + 1] <= row[best + 1])) continue;
      least = price;
      best = j;
    }
    return best;
  }

  // What the rows that are zero here allow, whatever rounding did before: weights w of rows, none negative,
  // with sum w a = v bound the radius by (sum w b + |v|_1) / sum w, since |t_j| <= 1.
  double radiusBound(const double* rows) const {
    double total = 0.0, bound = 0.0;
    std::array<double, N> left{};
    for (int j = 0; j < N; ++j) {
      const double weight = std::max(-dictionary_.coordinate(N - 1, j + 1), 0.0);
      const double* row = rows + static_cast<std::ptrdiff_t>(dictionary_.nonbasic(j)) * N;
      total += weight;
      bound += weight * row[N - 1];
      for (int q = 0; q + 1 < N; ++q) left[q] += weight * row[q];
    }
    for (int q = 0; q + 1 < N; ++q) bound += std::abs(left[q]);
    return total > 0.0 ? bound / total : std::numeric_limits<double>::infinity();
  }

  void begin(int kept, int count, double tolerance, const LooseRows& loose) {
    state_.assign(count, RowState::kUnknown);
    std::fill_n(state_.begin(), kept, RowState::kFacet);
    beyond_.resize(static_cast<std::size_t>(count) * N);
    tolerance_ = tolerance;
    loose_ = loose;
    excess_ = 1.0;
    leaves_reach_ = false;
  }

  bool decideAll(int kept, int count, MinimalRows& result) {
    for (int i = kept; i < count; ++i) {
      if (state_[i] == RowState::kUnknown && !decide(i)) return false;
    }
    result.facets.clear();
    result.beyond.clear();
    result.excess = excess_;
    result.leaves_reach = leaves_reach_;
    for (int i = kept; i < count; ++i) {
      if (state_[i] != RowState::kFacet) continue;
      result.facets.push_back(i);
      const double* point = beyond_.data() + static_cast<std::size_t>(i) * N;
      result.beyond.insert(result.beyond.end(), point, point + N);
    }
    return true;
  }

  // Reads off the current dictionary what it proves. A slack that grows along every column never
  // falls below its value here; a tight row whose column can go negative is needed.
  void sweep() {
    int found = 0;
    const int* growing = dictionary_.growingPlaces(found);
    for (int c = found - 1; c >= 0; --c) {  // downwards: what takes a place was looked at before
      const int row = dictionary_.rowAt(growing[c]);
      if (state_[row] == RowState::kUnknown && dictionary_.value(growing[c]) >= 0.0) markRedundant(row);
    }
    for (int j = 0; j < N; ++j) {
      const int i = dictionary_.nonbasic(j);
      if (state_[i] == RowState::kUnknown) provedByColumn(i, j);
    }
  }

  // Whether row i, tight in column j, can be violated alone by more than the tolerance.
  bool provedByColumn(int i, int j) {
    const double step =
        std::min(dictionary_.ratio(j, Dictionary<N>::kShrinking).step, tolerance::kMostBeyond);
    if (step <= tolerance_) return false;
    markFacet(i, j, -step);
    return true;
  }

  // Minimises slack i over the other rows until it is negative or at its minimum.
  bool decide(int i) {
    int stalled = 0;
    for (int round = 0; round < Dictionary<N>::kPivotLimit; ++round) {
      const int place = dictionary_.place(i);
      if (place < 0) {
        const int own = dictionary_.column(i);
        const Blocking found = dictionary_.ratio(own, Dictionary<N>::kShrinking);
        const double step = std::min(found.step, tolerance::kMostBeyond);
        if (step > tolerance_) {
          markFacet(i, own, -step);
          return true;
        }
        dictionary_.pivot(found.place, own);
        ++stalled;
        continue;
      }
      const auto row = dictionary_.slack(place);
      double way = Dictionary<N>::kGrowing;
      const int column = stalled > Dictionary<N>::kStallLimit ? dictionary_.fallingColumn(row, true)
                                                              : dictionary_.steepestColumn(row, way);
      if (column < 0) {
        leaves_reach_ = leaves_reach_ || row[0] < -tolerance::kNegativeSlack;
        markRedundant(i);
        return true;
      }
      const auto [step, blocking] = dictionary_.ratio(column, way, place);
      const double fall = std::abs(row[column + 1]);
      if (row[0] - fall * step < -tolerance_) {
        const double reach = std::min(step, (row[0] + tolerance::kMostBeyond) / fall);
        markFacet(i, column, way == Dictionary<N>::kGrowing ? reach : -reach);
        return true;
      }
      if (blocking < 0) return false;
      stalled = step > tolerance::kDegenerateStep ? 0 : stalled + 1;
      dictionary_.pivot(blocking, column);
      if (stalled == 0 && dictionary_.isVertex()) sweep();
      if (state_[i] != RowState::kUnknown) return true;
    }
    return false;
  }

  void markRedundant(int i) {
    state_[i] = RowState::kRedundant;
    if (loose_.is_asked != nullptr && loose_.is_asked[i] != 0)
      loosen(dictionary_.slack(dictionary_.place(i)));
    dictionary_.remove(dictionary_.place(i));
  }

  // Of a row that is left out: what its slack loses where loose rows are violated. Where that may make it negative, all that
  // was left out before may rest on this row.
  void loosen(const typename Dictionary<N>::Row& slack) {
    constexpr double kWidest = 2.0 * N;
    double loss = 0.0;
    for (int j = 0; j < N; ++j) {
      const int row = dictionary_.nonbasic(j);
      if (slack[j + 1] < 0.0 || row < 0)
        loss += std::abs(slack[j + 1]) * kWidest;
      else
        loss += slack[j + 1] * loose_.amounts[row];
    }
    if (slack[0] >= loose_.most * loss) return;
    excess_ *= std::max(1.0, loss / loose_.unit);
  }

  void markFacet(int i, int column, double step) {
    state_[i] = RowState::kFacet;
    dictionary_.point(column, step, beyond_.data() + static_cast<std::size_t>(i) * N);
  }

  Dictionary<N> dictionary_;
  std::vector<RowState> state_;
  std::vector<double> beyond_;
  double tolerance_ = 0.0;
  LooseRows loose_;
  double excess_ = 1.0;
  bool leaves_reach_ = false;
};

template <int N>
std::unique_ptr<PolytopeSolver::Kernel> makeFrom(int dimension) {
  if (dimension == N) return std::make_unique<KernelOf<N>>();
  if constexpr (N <= PolytopeSolver::kMaxDimension) {
    return makeFrom<N + 1>(dimension);
  } else {
    return nullptr;
  }
}

}  // namespace

std::unique_ptr<PolytopeSolver::Kernel> makeKernel(int dimension) { return makeFrom<1>(dimension); }

}  // namespace polyfly
