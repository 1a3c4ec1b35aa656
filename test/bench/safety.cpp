// The safety filter of TinyMPC's microcontroller benchmark (RoboticExplorationLab/mcu-solver-benchmarks) flown with two
// filters: the benchmark's program of 10 stages without a terminal set, solved exactly, and the map of
// region_maps/problems/safety/double_integrator.yaml. Argument: MAP. Prints rows as JSON.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "mpc_core/dense_qp.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

constexpr double kPeriod = 0.05;   // [s]
constexpr double kGreatest = 1.5;  // |p| [m], |v| [m/s]
constexpr double kStrength = 2.0;  // |a| [m/s^2]
constexpr int kStages = 10;
constexpr int kInputs = kStages - 1;
constexpr int kSoftRows = 4 * kInputs;
constexpr double kViolationWeight = 1e8;  // beside 1 of the inputs
constexpr int kPrograms = 190;
constexpr double kNoise = 0.01;
constexpr double kFirstNoise = 0.1;

using State = Eigen::Vector2d;

State successor(const State& x, double a) {
  return {x[0] + kPeriod * x[1] + 0.5 * kPeriod * kPeriod * a, x[1] + kPeriod * a};
}

/// The PD law (7, 3) towards 2 sin t.
double wishAt(const State& x, int sample) {
  return 7.0 * (2.0 * std::sin(kPeriod * sample) - x[0]) - 3.0 * x[1];
}

/// One axis of the benchmark's program: least |u - wish|^2 with |x_k| <= 1.5 for k = 0..9.
class HorizonFilter {
 public:
  HorizonFilter()
      : qp_(Eigen::MatrixXd::Identity(kInputs, kInputs), rows()), soft_(softWeights(), softRows()) {}

  /// The first input. Where no input sequence keeps the ranges, `kept` is false, and the input is that of the least
  /// sum of squared violations.
  double input(const State& x, int sample, bool& kept) {
    Eigen::VectorXd g = Eigen::VectorXd::Zero(kInputs + kSoftRows), b(kSoftRows + 2 * kInputs);
    State nominal = x, free = x;
    for (int k = 0; k < kInputs; ++k) {
      g[k] = -wishAt(nominal, sample + k);
      nominal = successor(nominal, -g[k]);
      free = successor(free, 0.0);
      for (int i = 0; i < 2; ++i) {
        b[4 * k + 2 * i] = kGreatest - free[i];
        b[4 * k + 2 * i + 1] = kGreatest + free[i];
      }
    }
    b.tail(2 * kInputs).setConstant(kStrength);
    kept = x.cwiseAbs().maxCoeff() <= kGreatest && qp_.solve(g.data(), b.data()) == QpStatus::kOptimal;
    if (kept) return qp_.z()[0];
    if (soft_.solve(g.data(), b.data()) != QpStatus::kOptimal)
      throw Error("bench_safety: least violation: no solution");
    return soft_.z()[0];
  }

 private:
  static Eigen::MatrixXd rows() {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6 * kInputs, kInputs);
    for (int j = 0; j < kInputs; ++j) {
      State x = State::Zero();
      for (int k = j; k < kInputs; ++k) {
        x = successor(x, k == j ? 1.0 : 0.0);
        for (int i = 0; i < 2; ++i) {
          A(4 * k + 2 * i, j) = x[i];
          A(4 * k + 2 * i + 1, j) = -x[i];
        }
      }
      A(4 * kInputs + 2 * j, j) = 1.0;
      A(4 * kInputs + 2 * j + 1, j) = -1.0;
    }
    return A;
  }

  // A violation of its own for each row of a state, after the inputs.
  static Eigen::MatrixXd softRows() {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(kSoftRows + 2 * kInputs, kInputs + kSoftRows);
    A.leftCols(kInputs) = rows();
    A.block(0, kInputs, kSoftRows, kSoftRows) = -Eigen::MatrixXd::Identity(kSoftRows, kSoftRows);
    return A;
  }
  static Eigen::MatrixXd softWeights() {
    Eigen::VectorXd weights = Eigen::VectorXd::Constant(kInputs + kSoftRows, kViolationWeight);
    weights.head(kInputs).setOnes();
    return weights.asDiagonal();
  }

  DenseQp qp_;
  DenseQp soft_;
};

struct Flight {
  int unanswered = 0;
  int outside = 0;
};

double noise(double size) { return size * 2.0 * (std::rand() / static_cast<double>(RAND_MAX) - 0.5); }

/// The benchmark's loop and its noise. A filter returns the input, and whether it had an answer.
Flight fly(const std::function<double(const State&, int, bool&)>& filter) {
  Flight flight;
  std::srand(1);
  State x;
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = noise(kFirstNoise);
  for (int sample = 0; sample < kPrograms; ++sample) {
    bool answered = false;
    const double a = filter(x, sample, answered);
    if (!answered) ++flight.unanswered;
    x = successor(x, a);
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] += noise(kNoise);
    if (x.cwiseAbs().maxCoeff() > kGreatest) ++flight.outside;
  }
  return flight;
}

void row(const char* name, double value, const char* unit, double mark) {
  std::printf(" {\"name\": \"%s\", \"value\": %.17g, \"unit\": \"%s\", \"mark\": %g, \"reached\": %s}", name,
              value, unit, mark, value <= mark ? "true" : "false");
}

void plainRow(const char* name, int value) {
  std::printf(" {\"name\": \"%s\", \"value\": %d, \"unit\": \"of 190\"},\n", name, value);
}

int run(const char* path) {
  const RegionMap map = RegionMap::open(path);
  HorizonFilter horizon;
  const Flight without =
      fly([&](const State& x, int sample, bool& kept) { return horizon.input(x, sample, kept); });
  const Flight with = fly([&](const State& x, int sample, bool& answered) {
    const double theta[] = {x[0], x[1], wishAt(x, sample)};
    double u = 0.0;
    answered = map.evaluate(theta, &u).status == LookupStatus::kInside;
    return std::clamp(u, -kStrength, kStrength);
  });
  std::printf("[\n");
  plainRow("10 stages, no terminal set: programs without a solution", without.unanswered);
  plainRow("10 stages, no terminal set: states out of their ranges", without.outside);
  plainRow("map of the safe set: states without an answer", with.unanswered);
  row("map of the safe set: states out of their ranges", with.outside, "of 190", 0);
  std::printf(",\n");
  row("map of the safe set: regions of an axis", static_cast<double>(map.regionCount()), "regions", 200);
  std::printf("\n]\n");
  return with.outside + with.unanswered > 0 ? 1 : 0;
}

}  // namespace
}  // namespace polyfly

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw polyfly::Error("bench_safety: MAP");
    return polyfly::run(argv[1]);
  } catch (const polyfly::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
