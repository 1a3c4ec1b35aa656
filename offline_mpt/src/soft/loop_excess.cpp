#include "offline_mpt/loop_excess.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "soft/active_solution.hpp"
#include "soft/excess_text.hpp"
#include "soft/loop_cells.hpp"

namespace polyfly {
namespace {

// Levels of an excess that are told apart.
constexpr double kLevels = 1024.0;
// Pairs of regions that are looked at.
constexpr int kMostPairs = 1000000;

/// Functions over (s, 1) whose greatest value is bounded within a region.
struct Measure {
  Eigen::MatrixXd functions;
  double greatest = 0.0;  ///< over the whole region, at least 0
  double level = 0.0;     ///< of the parameters that the loop reaches
};

/// A region, with functions over (s, 1).
struct Piece {
  Eigen::MatrixXd sides;      ///< each at most 0 within the region
  Eigen::MatrixXd successor;  ///< the next theta, scaled
  Eigen::MatrixXd excess;     ///< of the bound after the step, one row for each side of it
  /// The excess before the step, and that of the prediction.
  std::array<Measure, 2> measures;
  Eigen::VectorXd lower, upper;            ///< box around the region, scaled
  Eigen::VectorXd next_lower, next_upper;  ///< box around its successors
  bool reached = false;
  bool changed = false;

  bool full() const {
    return reached && std::all_of(measures.begin(), measures.end(),
                                  [](const Measure& measure) { return measure.level >= measure.greatest; });
  }
};

double valueAt(const Eigen::RowVectorXd& function, const Eigen::VectorXd& s) {
  return function.head(s.size()).dot(s) + function(s.size());
}

/// What the loop reaches of each region.
class Loop {
 public:
  Loop(const MpcProblem& problem, const ParametricProgram& program, const Partition& partition)
      : scale_(problem),
        step_(loopStep(problem)),
        cell_(scale_.size()),
        program_(program),
        partition_(partition) {}

  /// Of constraint `index`.
  LoopExcess solve(const MpcProblem& problem, std::size_t index) {
    const StageConstraint& constraint = problem.constraints[index];
    LoopExcess result;
    result.name = constraint.signal.name;
    result.unit = constraint.signal.unit;
    pieces_.clear();
    for (const CriticalRegion& region : partition_.regions)
      pieces_.push_back(pieceOf(region, constraint, static_cast<Eigen::Index>(index)));
    start();
    if (!spread())
      result.unknown = "it takes more than " + std::to_string(kMostPairs) + " pairs of regions";
    else
      setExcess(&result);
    return result;
  }

 private:
  Piece pieceOf(const CriticalRegion& region, const StageConstraint& constraint, Eigen::Index index) {
    const Eigen::MatrixXd w = scale_.loop(region);
    Piece piece;
    piece.sides.resize(region.G.rows(), scale_.size() + 1);
    for (Eigen::Index i = 0; i < region.G.rows(); ++i)
      piece.sides.row(i) = scale_.ofTheta(region.G.row(i), -region.g(i));
    piece.successor = scale_.scaled(step_.successor * w);
    piece.excess = excessOf(step_.after.row(index) * w, constraint.signal);
    piece.measures[0].functions = excessOf(step_.before.row(index) * w, constraint.signal);
    piece.measures[1].functions = slacksOf(region, constraint.signal.name);
    setBoxes(&piece);
    return piece;
  }

  static Eigen::MatrixXd excessOf(const Eigen::RowVectorXd& value, const Signal& bounds) {
    const Eigen::Index last = value.size() - 1;
    Eigen::MatrixXd excess(2, value.size());
    Eigen::Index rows = 0;
    for (const double sign : {1.0, -1.0}) {
      const double bound = sign > 0.0 ? bounds.upper : -bounds.lower;
      if (!std::isfinite(bound)) continue;
      excess.row(rows) = sign * value;
      excess(rows++, last) -= bound;
    }
    return excess.topRows(rows);
  }

  /// Those that are not at their floor.
  Eigen::MatrixXd slacksOf(const CriticalRegion& region, const std::string& name) const {
    const ActiveSolution solution = solveActiveSet(program_, region.active);
    Eigen::MatrixXd slacks(static_cast<Eigen::Index>(program_.slacks.size()), scale_.size() + 1);
    Eigen::Index rows = 0;
    for (const SlackVariable& slack : program_.slacks) {
      const bool is_zero = std::binary_search(region.active.begin(), region.active.end(), slack.floor);
      if (slack.name != name || is_zero) continue;
      slacks.row(rows++) =
          scale_.ofTheta(solution.on_theta.row(slack.variable), solution.constant(slack.variable));
    }
    return slacks.topRows(rows);
  }

  double greatestOf(const Eigen::RowVectorXd& function) {
    return valueAt(function, cell_.greatest(function));
  }

  /// A region without interior has an empty box, and no pairs.
  void setBoxes(Piece* piece) {
    const Eigen::Index p = scale_.parameters();
    piece->lower = piece->next_lower = Eigen::VectorXd::Constant(p, std::numeric_limits<double>::infinity());
    piece->upper = piece->next_upper = -piece->lower;
    cell_.reset();
    cell_.add(piece->sides);
    if (!cell_.enter()) return;
    for (Eigen::Index j = 0; j < p; ++j) {
      const Eigen::RowVectorXd entry = Eigen::RowVectorXd::Unit(scale_.size() + 1, j);
      piece->upper(j) = greatestOf(entry);
      piece->lower(j) = -greatestOf(-entry);
      piece->next_upper(j) = greatestOf(piece->successor.row(j));
      piece->next_lower(j) = -greatestOf(-piece->successor.row(j));
    }
    for (Measure& measure : piece->measures)
      for (Eigen::Index i = 0; i < measure.functions.rows(); ++i)
        measure.greatest = std::max(measure.greatest, greatestOf(measure.functions.row(i)));
  }

  /// The part of a region that the loop reaches, as the cell.
  void setReached(const Piece& piece) {
    cell_.reset();
    cell_.add(piece.sides);
    for (const Measure& measure : piece.measures) {
      if (measure.level >= measure.greatest) continue;
      Eigen::MatrixXd functions = measure.functions;
      functions.col(scale_.size()).array() -= measure.level;
      cell_.add(functions);
    }
  }

  /// Where the bound is met now and in the prediction.
  void start() {
    steps_.fill(0.0);
    for (const Piece& piece : pieces_)
      for (std::size_t k = 0; k < steps_.size(); ++k)
        steps_[k] = std::max(steps_[k], piece.measures[k].greatest / kLevels);
    for (Piece& piece : pieces_) {
      setReached(piece);
      piece.reached = piece.changed = cell_.enter();
    }
  }

  /// Functions of the next theta, over (s, 1) before the step.
  Eigen::MatrixXd beforeStep(const Eigen::MatrixXd& functions, const Piece& from) const {
    Eigen::MatrixXd result = functions.leftCols(scale_.parameters()) * from.successor;
    result.col(scale_.size()) += functions.col(scale_.size());
    return result;
  }

  /// Lets the parameters reached grow until no step leaves them. False where that takes too many pairs.
  bool spread() {
    int pairs = 0;
    for (bool grows = true; grows;) {
      grows = false;
      for (Piece& from : pieces_) {
        if (!from.changed) continue;
        grows = true;
        from.changed = false;  // until a step, perhaps into itself, changes it again
        for (Piece& to : pieces_) {
          if (to.full() || (from.next_lower.array() > to.upper.array()).any() ||
              (from.next_upper.array() < to.lower.array()).any())
            continue;
          if (++pairs > kMostPairs) return false;
          reach(from, &to);
        }
      }
    }
    return true;
  }

  void reach(const Piece& from, Piece* to) {
    setReached(from);
    cell_.add(beforeStep(to->sides, from));
    if (!cell_.enter()) return;
    to->changed = to->changed || !to->reached;
    to->reached = true;
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      Measure& measure = to->measures[k];
      const Eigen::MatrixXd functions = beforeStep(measure.functions, from);
      for (Eigen::Index i = 0; i < functions.rows() && measure.level < measure.greatest; ++i) {
        const double value = greatestOf(functions.row(i));
        if (value <= measure.level) continue;
        measure.level = std::min(measure.greatest, steps_[k] * std::ceil(value / steps_[k]));
        to->changed = true;
      }
    }
  }

  void setExcess(LoopExcess* result) {
    result->excess = negligibleExcess(program_);
    for (const Piece& piece : pieces_) {
      setReached(piece);
      if (!piece.reached || !cell_.enter()) continue;
      for (Eigen::Index i = 0; i < piece.excess.rows(); ++i) {
        const Eigen::VectorXd s = cell_.greatest(piece.excess.row(i));
        const double excess = valueAt(piece.excess.row(i), s);
        if (excess <= result->excess) continue;
        result->excess = excess;
        result->theta = scale_.theta(s);
        result->d = scale_.disturbance(s);
      }
    }
    if (result->theta.size() == 0) result->excess = 0.0;
  }

  const LoopScale scale_;
  const LoopStep step_;
  LoopCell cell_;
  const ParametricProgram& program_;
  const Partition& partition_;
  std::vector<Piece> pieces_;
  // Steps of the levels of both measures.
  std::array<double, 2> steps_{};
};

std::string reasonAgainst(const MpcProblem& problem) {
  const std::string fixed = changingFixedParameter(problem);
  if (!fixed.empty()) return "the fixed parameter " + fixed + " changes with the loop";
  if (LoopScale(problem).size() > PolytopeSolver::kMaxDimension)
    return "parameters and disturbances are more than " + std::to_string(PolytopeSolver::kMaxDimension);
  return {};
}

}  // namespace

std::string disturbanceText(const MpcProblem& problem) {
  std::string text;
  for (const Signal& signal : problem.disturbances) {
    if (!std::isfinite(signal.lower)) continue;
    text += (text.empty() ? "" : ", ") + signal.name + " in [" + numberText(signal.lower) + ", " +
            numberText(signal.upper) + "] " + signal.unit;
  }
  return text;
}

std::vector<LoopExcess> loopExcess(const MpcProblem& problem, const Partition& partition) {
  std::vector<LoopExcess> result;
  if (disturbanceText(problem).empty()) return result;
  const std::string reason = reasonAgainst(problem);
  const ParametricProgram program = condense(problem);
  for (std::size_t i = 0; i < problem.constraints.size(); ++i) {
    const StageConstraint& constraint = problem.constraints[i];
    if (!constraint.soft) continue;
    if (!reason.empty()) {
      result.push_back({constraint.signal.name, constraint.signal.unit, reason, 0.0, {}, {}});
      continue;
    }
    result.push_back(Loop(problem, program, partition).solve(problem, i));
  }
  return result;
}

std::string loopExcessText(const MpcProblem& problem, const LoopExcess& excess) {
  const std::string text = "soft bound " + excess.name + " with " + disturbanceText(problem) + ": ";
  if (!excess.unknown.empty()) return text + "not computed, because " + excess.unknown;
  const std::string promise = excess.excess > 0.0
                                  ? "exceeded by at most " + numberText(excess.excess) + " " + excess.unit
                                  : std::string("never exceeded");
  return text + promise +
         " from where it is met, also in the prediction, while references are held and the parameters stay "
         "in the map";
}

}  // namespace polyfly
