// Robust problems drawn by chance: their maps against Eq. 34 as printed, solved in rational arithmetic by
// GLPK, and against every vertex of the disturbances over one step. POLYFLY_ROBUST_PROBLEMS and
// POLYFLY_ROBUST_HORIZON ask for more of them, and longer ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>

#include "../../test/glpk_lp.hpp"
#include "../../test/map_in_memory.hpp"
#include "full_program.hpp"
#include "offline_mpt/encode.hpp"
#include "polyfly_base/error.hpp"
#include "random_robust.hpp"
#include "robust_mpc/prove_map.hpp"

namespace polyfly {
namespace {

// GLPK takes a double for the simplest fraction within a part in 1e9 of it: its optimum is that of nearly the
// same program.
constexpr double kPeak = 1e-8;
constexpr double kBound = 1e-9;
// Slack of tau at which the interval of optimal moves is computed.
constexpr double kSlack = 1e-7;

int asked(const char* name, int usual) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atoi(text) : usual;
}

struct Totals {
  int solved = 0;
  // Problems in which no parameter has a plan.
  int hopeless = 0;
  int feasible = 0;
  int infeasible = 0;
  // Parameters that the oracle could not decide.
  int undecided = 0;
  std::uint64_t regions = 0;
};

/// One problem with its map and its oracle.
class Drawn {
 public:
  explicit Drawn(const std::string& text)
      : problem_(parseRobustProblem(text, "drawn.yaml")), full_(buildFullProgram(problem_)) {}

  /// False: no parameter has a plan.
  bool solve() {
    try {
      const RobustProgram program = buildRobustProgram(problem_);
      const RobustLaw law = explicitLaw(problem_, projectFeasibleSet(program));
      regions_ = law.regions.size();
      const RoundedLaw rounded = roundLaw(problem_, law, ExploreStatus::kComplete);
      map_ = std::make_unique<MapInMemory>(encode(rounded.program, rounded.partition));
    } catch (const Error& error) {
      refusal_ = error.what();
      return false;
    }
    return true;
  }

  const std::string& refusal() const { return refusal_; }
  std::size_t regions() const { return regions_; }

  Eigen::VectorXd draw(Random& random, double share) const {
    Eigen::VectorXd theta(problem_.parameterCount());
    for (int j = 0; j < theta.size(); ++j) {
      const Signal& signal = problem_.parameters[static_cast<std::size_t>(j)].signal;
      theta[j] = share * random.uniform(signal.lower, signal.upper);
    }
    return theta;
  }

  bool oracleFeasible(const Eigen::VectorXd& theta) const { return oracle(theta).status == GLP_OPT; }

  /// Compares at theta; whether there is a plan, nothing where the oracle does not know.
  std::optional<bool> compare(const Eigen::VectorXd& theta) const {
    const LpAnswer answer = oracle(theta);
    if (answer.status != GLP_OPT && answer.status != GLP_NOFEAS) return std::nullopt;
    double output[2] = {0.0, 0.0};
    const Lookup lookup = map_->map().evaluate(theta.data(), output);
    const bool inside = lookup.status == LookupStatus::kInside;
    EXPECT_EQ(inside, answer.status == GLP_OPT) << theta.transpose();
    if (!inside || answer.status != GLP_OPT) return false;
    EXPECT_NEAR(output[1], answer.objective, kPeak * std::max(1.0, answer.objective)) << theta.transpose();
    const double shift = inputShift(theta);
    compareMove(theta, answer.objective, output[0] - shift);
    stepOnce(theta, output[0] - shift, output[1]);
    return true;
  }

 private:
  LpAnswer oracle(const Eigen::VectorXd& theta) const {
    return solveByGlpk(full_.c, full_.A, full_.b + full_.S * theta, {}, true);
  }

  double inputShift(const Eigen::VectorXd& theta) const {
    double shift = 0.0;
    for (int j = 0; j < problem_.parameterCount(); ++j) {
      const auto& parameter = problem_.parameters[static_cast<std::size_t>(j)];
      if (parameter.state < 0) shift += nearestDouble(parameter.input_shift[0]) * theta[j];
    }
    return shift;
  }

  /// Least and greatest move with tau at most `peak`.
  std::array<double, 2> moves(const Eigen::VectorXd& theta, double peak) const {
    const auto n = full_.A.cols();
    Eigen::MatrixXd A(full_.A.rows() + 1, n);
    A << full_.A, Eigen::RowVectorXd::Unit(n, full_.peak);
    Eigen::VectorXd right(A.rows());
    right << full_.b + full_.S * theta, peak;
    std::array<double, 2> ends{};
    for (int k = 0; k < 2; ++k) {
      const double sign = k == 0 ? 1.0 : -1.0;
      const LpAnswer answer =
          solveByGlpk(sign * Eigen::VectorXd::Unit(n, full_.first_input), A, right, {}, true);
      EXPECT_EQ(answer.status, GLP_OPT) << theta.transpose();
      ends[static_cast<std::size_t>(k)] = sign * answer.objective;
    }
    return ends;
  }

  /// The move is K e, or the nearest end of the interval of moves that reach tau. Some slack in tau is needed
  /// to ask for that interval, which it widens by its inverse slopes, of a thousand and more: so much as
  /// twice the slack adds is the room.
  void compareMove(const Eigen::VectorXd& theta, double peak, double move) const {
    const std::array<double, 2> ends = moves(theta, peak + kSlack), wider = moves(theta, peak + 2.0 * kSlack);
    const std::vector<int> errors = problem_.errorParameters();
    double preferred = 0.0;
    for (int i = 0; i < problem_.stateCount(); ++i)
      preferred += nearestDouble(problem_.tie_gain(0, i)) * theta[errors[static_cast<std::size_t>(i)]];
    const double room = 1e-8 + 4.0 * std::max(ends[0] - wider[0], wider[1] - ends[1]);
    EXPECT_LT(room, 1e-2) << theta.transpose();
    EXPECT_GE(move, ends[0] - 1e-8) << theta.transpose();
    EXPECT_LE(move, ends[1] + 1e-8) << theta.transpose();
    EXPECT_NEAR(move, std::clamp(preferred, ends[0], ends[1]), room) << theta.transpose();
  }

  /// Every vertex of the disturbances, after one step of the model.
  void stepOnce(const Eigen::VectorXd& theta, double move, double peak) const {
    const int nx = problem_.stateCount(), nw = problem_.channelCount();
    const std::vector<int> errors = problem_.errorParameters();
    Eigen::VectorXd e(nx), reference = Eigen::VectorXd::Zero(nx), drift(nx);
    for (int i = 0; i < nx; ++i) {
      e[i] = theta[errors[static_cast<std::size_t>(i)]];
      drift[i] = nearestDouble(problem_.drift[static_cast<std::size_t>(i)]);
      for (int j = 0; j < problem_.parameterCount(); ++j) {
        const auto& parameter = problem_.parameters[static_cast<std::size_t>(j)];
        if (parameter.state < 0)
          reference[i] += nearestDouble(parameter.state_shift[static_cast<std::size_t>(i)]) * theta[j];
      }
    }
    const double applied = move + inputShift(theta);
    EXPECT_LE(applied, problem_.inputs[0].upper + kBound);
    EXPECT_GE(applied, problem_.inputs[0].lower - kBound);
    const Eigen::MatrixXd A = toDoubles(problem_.A), B = toDoubles(problem_.B), G = toDoubles(problem_.G);
    const Eigen::MatrixXd C = toDoubles(problem_.C);
    for (unsigned corner = 0; corner < (1U << static_cast<unsigned>(nw)); ++corner) {
      Eigen::VectorXd w(nw);
      for (int c = 0; c < nw; ++c) w[c] = ((corner >> static_cast<unsigned>(c)) & 1U) != 0U ? 1.0 : -1.0;
      const Eigen::VectorXd next = A * e + B * move + G * w + drift;
      for (int i = 0; i < nx; ++i) {
        const auto& range = problem_.state_ranges[static_cast<std::size_t>(i)];
        if (!range) continue;
        EXPECT_LE(next[i] + reference[i], nearestDouble(range->upper) + kBound) << theta.transpose();
        EXPECT_GE(next[i] + reference[i], nearestDouble(range->lower) - kBound) << theta.transpose();
      }
      EXPECT_LE((C * next).cwiseAbs().maxCoeff(), peak + kBound) << theta.transpose();
    }
  }

  RobustProblem problem_;
  FullProgram full_;
  std::unique_ptr<MapInMemory> map_;
  std::size_t regions_ = 0;
  std::string refusal_;
};

void tryOne(std::uint64_t seed, int horizon, int samples, Totals& totals) {
  const RandomRobust made(seed, horizon);
  SCOPED_TRACE("seed " + std::to_string(seed) + "\n" + made.text());
  Drawn drawn(made.text());
  Random random(seed + 1000);
  if (!drawn.solve()) {
    ++totals.hopeless;
    // said only where it is so
    EXPECT_TRUE(drawn.refusal().find("no parameter in the box") != std::string::npos ||
                drawn.refusal().find("empty") != std::string::npos)
        << drawn.refusal();
    if (drawn.refusal().find("no parameter in the box") == std::string::npos) return;
    for (int k = 0; k < samples; ++k)
      EXPECT_FALSE(drawn.oracleFeasible(drawn.draw(random, k % 2 == 0 ? 0.2 : 1.0)));
    return;
  }
  ++totals.solved;
  totals.regions += drawn.regions();
  for (int k = 0; k < samples; ++k) {
    const std::optional<bool> feasible = drawn.compare(drawn.draw(random, k % 3 == 0 ? 0.15 : 1.0));
    ++(feasible ? (*feasible ? totals.feasible : totals.infeasible) : totals.undecided);
  }
}

// The invariant set of this one has whole numbers of more than 1024 bits, which no double holds.
TEST(RobustRandom, LongInvariantSetsAreReadInDoubles) {
  Totals totals;
  tryOne(1047, 5, 2, totals);
  EXPECT_EQ(totals.solved, 1);
}

TEST(RobustRandom, MapsAreTheExactOptimumOfEq34) {
  const int problems = asked("POLYFLY_ROBUST_PROBLEMS", 24), horizon = asked("POLYFLY_ROBUST_HORIZON", 3);
  const int first = asked("POLYFLY_ROBUST_FIRST", 1);
  Totals totals;
  for (int seed = first; seed < first + problems; ++seed) {
    const auto start = std::chrono::steady_clock::now();
    tryOne(static_cast<std::uint64_t>(seed), horizon, 5, totals);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (std::getenv("POLYFLY_ROBUST_PROBLEMS") != nullptr) std::printf("seed %d: %.2f s\n", seed, seconds);
  }
  std::printf(
      "%d solved with %llu regions, %d without a plan; %d parameters with a plan, %d without, %d undecided\n",
      totals.solved, static_cast<unsigned long long>(totals.regions), totals.hopeless, totals.feasible,
      totals.infeasible, totals.undecided);
  EXPECT_GT(totals.solved, problems / 2);
  EXPECT_GT(totals.feasible, problems);
  EXPECT_LE(totals.undecided, problems / 20);
}

}  // namespace
}  // namespace polyfly
