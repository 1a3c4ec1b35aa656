// Tracking problems in bad scales, unstable plants, long horizons and heavy terminal weights: the law is right on the numbers
// of the problem file, or the problem is refused with its reason. The oracle condenses with 180 digits.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <string>

#include "condensed_oracle.hpp"
#include "error_of.hpp"
#include "holds.hpp"
#include "map_in_memory.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/online_program.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "offline_mpt/verify.hpp"
#include "polyfly_base/error.hpp"
#include "reference_data.hpp"

namespace polyfly {
namespace {

constexpr double kRight = 1e-6;  // of the input's range
constexpr int kSamples = 300;
constexpr int kLong = 60;  // horizon over which the oracle takes a second for one state

BoundedTracking scalarPlant(double a, double b, int horizon, std::vector<double> terminal) {
  BoundedTracking plant;
  plant.A = {{a}};
  plant.B = {b};
  plant.Q = {1.0};
  plant.terminal = std::move(terminal);
  plant.horizon = horizon;
  plant.limit = 2.0;
  plant.ranges = {1.0};
  return plant;
}

/// Why the problem is refused; empty where map and online law are right at some states. Samples and proof then agree.
std::string refusalOrRight(const BoundedTracking& plant) {
  ParametricProgram program;
  try {
    program = condense(parseProblem(plant.text(), "scaled.yaml"));
  } catch (const Error& error) {
    return error.what();
  }
  const Partition partition = explore(program);
  EXPECT_EQ(partition.status, ExploreStatus::kComplete) << plant.text();
  if (partition.status != ExploreStatus::kComplete) return "";
  const MapInMemory map(encode(program, partition));
  VerifyOptions sampling;
  sampling.samples = kSamples;
  const VerifyReport sampled = verify(map.map(), program, sampling);
  EXPECT_TRUE(sampled.passed()) << plant.text() << verifyText(sampled);
  const CertifyReport proof = certify(map.map(), program);
  EXPECT_TRUE(proof.passed()) << plant.text() << certifyText(proof);
  OnlineProgram online(program);
  std::mt19937 random(1);
  for (int k = 0; k < (plant.horizon > kLong ? 1 : 5); ++k) {
    std::vector<double> x;
    for (const double range : plant.ranges)
      x.push_back(range * std::uniform_real_distribution<double>(-1.0, 1.0)(random));
    const double expected = plant.law(x);
    double u = 0.0;
    EXPECT_EQ(map.map().evaluate(x.data(), &u).status, LookupStatus::kInside) << plant.text();
    EXPECT_LE(std::abs(u - expected), kRight * 2.0 * plant.limit) << plant.text() << u << " for " << expected;
    EXPECT_EQ(online.solve(x.data(), &u), QpStatus::kOptimal) << plant.text();
    EXPECT_LE(std::abs(u - expected), kRight * 2.0 * plant.limit)
        << "online " << plant.text() << u << " for " << expected;
  }
  return "";
}

// By hand: the state is forced to 0 in two steps, so u = -2/3 x.
TEST(HeavyTerminalWeight, LeavesTheLawOfADeadBeatController) {
  for (const double weight : {1e9, 1e10, 1e11, 1e12, 1e13, 1e14}) {
    const BoundedTracking plant = scalarPlant(1.0, 1.0, 2, {weight});
    EXPECT_NEAR(plant.law({1.0}), -2.0 / 3.0, 1.0 / weight);
    EXPECT_EQ(refusalOrRight(plant), "") << weight;
    const ParametricProgram program = condense(parseProblem(plant.text(), "mini.yaml"));
    const MapInMemory map(encode(program, explore(program)));
    const CertifyReport report = certify(map.map(), program);
    EXPECT_TRUE(report.passed()) << certifyText(report);
    EXPECT_EQ(report.certificate.find("\ncounts "), std::string::npos);
  }
}

/// Whether the variables are what the inputs add to a feedback: then no two stages share a term of the cost.
bool isBesideFeedback(const ParametricProgram& program) {
  const Eigen::MatrixXd diagonal = program.H.diagonal().asDiagonal();
  return program.H == diagonal;
}

ParametricProgram condensed(const BoundedTracking& plant) {
  return condense(parseProblem(plant.text(), "long.yaml"));
}

// In the inputs themselves, doubles would not hold H.
TEST(HeavyTerminalWeight, IsRightWhereRoundingOfTheInputsCostWouldDecide) {
  const BoundedTracking plant = scalarPlant(0.9, 0.37, 4, {1e14});
  EXPECT_TRUE(isBesideFeedback(condensed(plant)));
  EXPECT_EQ(refusalOrRight(plant), "");
}

TEST(UnstablePlant, IsRightOverALongHorizonUnderAnyTerminalWeight) {
  for (int decade = 0; decade <= 12; ++decade) {
    const BoundedTracking plant = scalarPlant(2.0, 1.0, 20, {std::pow(10.0, decade)});
    EXPECT_TRUE(isBesideFeedback(condensed(plant)));
    EXPECT_EQ(refusalOrRight(plant), "") << decade;
  }
  for (const auto& [a, horizon] :
       std::vector<std::pair<double, int>>{{3.0, 7}, {2.0, 20}, {2.0, 60}, {1.1, 150}})
    EXPECT_EQ(refusalOrRight(scalarPlant(a, 1.0, horizon, {})), "") << a;
}

/// An inverted pendulum over 5 s, held for 0.1 s each.
BoundedTracking pendulum() {
  const double w = std::sqrt(19.62), b = 4.0, period = 0.1, c = std::cosh(w * period),
               s = std::sinh(w * period);
  BoundedTracking plant;
  plant.A = {{c, s / w}, {w * s, c}};
  plant.B = {b * (c - 1.0) / (w * w), b * s / w};
  plant.Q = {10.0, 1.0};
  plant.R = 0.1;
  plant.horizon = 50;
  plant.limit = 3.0;
  plant.ranges = {0.3, 1.0};
  return plant;
}

/// Four integrators.
BoundedTracking integrators() {
  const double h = 0.1;
  BoundedTracking plant;
  plant.A = {{1.0, h, h * h / 2.0, h * h * h / 6.0},
             {0.0, 1.0, h, h * h / 2.0},
             {0.0, 0.0, 1.0, h},
             {0.0, 0.0, 0.0, 1.0}};
  plant.B = {h * h * h * h / 24.0, h * h * h / 6.0, h * h / 2.0, h};
  plant.Q = {1.0, 0.1, 0.1, 0.1};
  plant.R = 0.1;
  plant.horizon = 50;
  plant.limit = 5.0;
  plant.ranges = {0.3, 0.3, 0.3, 0.3};
  return plant;
}

TEST(UnstablePlant, IsRightWithSeveralStates) {
  EXPECT_TRUE(isBesideFeedback(condensed(pendulum())));
  EXPECT_EQ(refusalOrRight(pendulum()), "");
  EXPECT_EQ(refusalOrRight(integrators()), "");
  for (const double weight : {1.0, 1e6, 1e12}) {
    BoundedTracking plant = pendulum();
    plant.terminal = {weight, weight};
    EXPECT_EQ(refusalOrRight(plant), "") << weight;
  }
}

TEST(TerminalEquality, IsRightForStableAndUnstablePlants) {
  for (BoundedTracking plant : {scalarPlant(0.9, 0.37, 4, {}), scalarPlant(2.0, 1.0, 20, {}), pendulum()}) {
    plant.ends_at_zero = true;
    EXPECT_EQ(condensed(plant).equalities.size(), plant.A.size());
    EXPECT_EQ(refusalOrRight(plant), "");
  }
}

// By hand: x+ = x + u, so the two inputs add up to -x, and u_0^2 + (x + u_0)^2 + u_1^2 is least at u_0 = -2/3 x.
TEST(TerminalEquality, IsTheLimitOfAHeavyWeight) {
  BoundedTracking plant = scalarPlant(1.0, 1.0, 2, {});
  plant.ends_at_zero = true;
  EXPECT_NEAR(plant.law({1.0}), -2.0 / 3.0, 1e-15);
  EXPECT_EQ(refusalOrRight(plant), "");
}

TEST(TerminalEquality, NeedsInputsThatReachEveryState) {
  BoundedTracking plant = integrators();
  plant.ends_at_zero = true;
  plant.horizon = 3;
  EXPECT_EQ(refusalOrRight(plant),
            "scaled.yaml: weights.terminal: equality needs inputs that reach every state within the horizon");
}

// Within a block the inputs are the same, whatever a feedback says.
TEST(UnstablePlant, IsRefusedWithBlockedMovesOverALongHorizon) {
  BoundedTracking plant = scalarPlant(2.0, 1.0, 60, {});
  std::string text = plant.text();
  text += "moves: [1, 59]\n";
  const std::string error = errorOf([&] { condense(parseProblem(text, "blocked.yaml")); });
  for (const char* part : {"horizon of 60", "without blocked moves"}) EXPECT_TRUE(holds(error, part));
}

// Near zero the law is that of the Riccati equation, whose solution is (a^2 + sqrt(a^4 + 4)) / 2 for weights and b of 1.
TEST(UnstablePlant, HasTheGainOfTheScalarRiccatiEquation) {
  for (const auto& [a, horizon] : std::vector<std::pair<double, int>>{{3.0, 10}, {2.0, 200}, {1.1, 60}}) {
    const ParametricProgram program = condensed(scalarPlant(a, 1.0, horizon, {}));
    const double P = 0.5 * (a * a + std::sqrt(a * a * a * a + 4.0)), K = a * P / (1.0 + P), x = 0.01;
    const MapInMemory map(encode(program, explore(program)));
    double u = 0.0;
    ASSERT_EQ(map.map().evaluate(&x, &u).status, LookupStatus::kInside);
    EXPECT_NEAR(u, -K * x, kRight * 4.0) << a;
    OnlineProgram online(program);
    ASSERT_EQ(online.solve(&x, &u), QpStatus::kOptimal);
    EXPECT_NEAR(u, -K * x, kRight * 4.0) << a;
  }
}

// Right gains of the infinite horizon: README.md beside the files.
TEST(LongHorizons, OfTheReferenceDataHaveTheirGains) {
  const std::map<std::string, std::vector<double>> gains{
      {"pend_N50", {9.8414119005975994, 2.4289010280260496}},
      {"chain4_N50", {2.6171635783349428, 5.5745275471990939, 5.8059807775255359, 3.4315720123504132}},
      {"a11_N150", {0.70342792885585207}}};
  for (const auto& [name, K] : gains) {
    const std::string path = referenceData("horizons/" + name + ".yaml");
    if (path.empty()) GTEST_SKIP() << "the reference data are absent";
    const ParametricProgram program = loadProgram(path);
    const MapInMemory map(encode(program, explore(program)));
    OnlineProgram online(program);
    const std::vector<double> x(K.size(), 0.01);
    const double expected = -0.01 * std::accumulate(K.begin(), K.end(), 0.0);
    const double range = program.inputs[0].upper - program.inputs[0].lower;
    double u = 0.0;
    ASSERT_EQ(map.map().evaluate(x.data(), &u).status, LookupStatus::kInside) << name;
    EXPECT_NEAR(u, expected, kRight * range) << name;
    ASSERT_EQ(online.solve(x.data(), &u), QpStatus::kOptimal) << name;
    EXPECT_NEAR(u, expected, kRight * range) << name;
  }
}

// Nine rows that meet in a vertex of eight variables, nearly dependent: by rounding the ninth was independent.
TEST(NearlyDependentRows, LeaveNoHoleBesideAVertex) {
  const ParametricProgram program = condense(parseProblem(R"(polyfly_problem: 1
name: vertex
type: tracking_mpc
model:
  time: discrete
  states: [{name: x0, unit: m}, {name: x1, unit: m}, {name: x2, unit: m}, {name: x3, unit: m}]
  inputs: [{name: u, unit: m, range: [-10.417496282661201, 10.417496282661201]}]
  A: [[-0.08394918799526609, -129.25449761997362, 84.89304325850003, 2.7813754882924573], [0.0013579581063316456, 0.062492066569457716, 0.10854658551069638, 7.491683092290917e-05], [-0.003972074845599453, 0.33272793816722296, -0.42000531066915303, -0.01998180410031761], [-0.17828940538493032, 24.479589036749356, -33.394542928443784, -1.0257194196710975]]
  B: [[7.452650920042332], [0.0071153330248092525], [-0.05526445670841369], [0.2722409018256179]]
  C: [[0.008547906525372332, 0, 0, 0]]
sampling_time: 1
horizon: 8
weights:
  Q: [0.015285801708992392, 43.10794010247352, 0.003323836455539687, 4.866152588987735]
  R: [0.00047755274057202]
  terminal: [204.71116793246316, 2273.4860472986275, 22.413927513479766, 3206156.9449372045]
constraints:
  - {of: x0, range: [-69.69783528207357, 84.06345634864483]}
parameters:
  - {name: e0, role: error, of: x0, unit: m, range: [-116.98770886552737, 116.98770886552737]}
  - {name: e1, role: error, of: x1, unit: m, range: [-0.37816302074585245, 0.37816302074585245]}
  - {name: e2, role: error, of: x2, unit: m, range: [-0.7193476662120174, 0.7193476662120174]}
  - {name: e3, role: error, of: x3, unit: m, range: [-34.72610190152257, 34.72610190152257]}
)",
                                                          "vertex.yaml"));
  const Partition partition = explore(program);
  ASSERT_EQ(partition.status, ExploreStatus::kComplete);
  const MapInMemory map(encode(program, partition));
  const CertifyReport report = certify(map.map(), program);
  EXPECT_TRUE(report.passed()) << certifyText(report);
}

/// Two masses between walls and each other, moved by a force: regions of four parameters that touch in many ways.
constexpr char kChain[] = R"(polyfly_problem: 1
name: chain
type: tracking_mpc
model:
  states: [{name: p0, unit: m}, {name: p1, unit: m}, {name: v0, unit: m/s}, {name: v1, unit: m/s}]
  inputs: [{name: u, unit: N, range: [-0.5, 0.5]}]
  A: [[0, 0, 1, 0], [0, 0, 0, 1], [-2, 1, 0, 0], [1, -2, 0, 0]]
  B: [[0], [0], [1], [0]]
  C: [[0, 1, 0, 0]]
sampling_time: 0.5
horizon: 5
weights: {Q: [1, 1, 1, 1], R: [1]}
constraints:
  - {of: p0, range: [-4, 4]}
  - {of: p1, range: [-4, 4]}
parameters:
  - {name: e_p0, role: error, of: p0, unit: m, range: [-4, 4]}
  - {name: e_p1, role: error, of: p1, unit: m, range: [-4, 4]}
  - {name: e_v0, role: error, of: v0, unit: m/s, range: [-4, 4]}
  - {name: e_v1, role: error, of: v1, unit: m/s, range: [-4, 4]}
)";

// As the reference problem mass_spring4_N5, where that is absent.
TEST(Chain, IsProvenAndItsSamplesPass) {
  const ParametricProgram program = condense(parseProblem(kChain, "chain.yaml"));
  const Partition partition = explore(program);
  ASSERT_EQ(partition.status, ExploreStatus::kComplete);
  EXPECT_GT(partition.regions.size(), 400U);
  const MapInMemory map(encode(program, partition));
  const CertifyReport proof = certify(map.map(), program);
  EXPECT_TRUE(proof.passed()) << certifyText(proof);
  const VerifyReport samples = verify(map.map(), program, {});
  EXPECT_TRUE(samples.passed()) << verifyText(samples);
}

BoundedTracking randomPlant(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  };
  const auto scale = [&](double decades) { return std::pow(10.0, uniform(-decades, decades)); };
  const double decades = seed % 2 == 0 ? 12.0 : 6.0;
  BoundedTracking plant;
  const std::size_t nx = 1 + random() % 2;
  plant.horizon = 2 + static_cast<int>(random() % 3);
  plant.limit = scale(decades);
  for (std::size_t i = 0; i < nx; ++i) {
    plant.A.emplace_back();
    for (std::size_t j = 0; j < nx; ++j) plant.A.back().push_back(uniform(-1.5, 1.5));
    plant.ranges.push_back(scale(decades));
    plant.Q.push_back(scale(decades));
  }
  // Units of the states, then of the input.
  for (std::size_t i = 0; i < nx; ++i) {
    for (std::size_t j = 0; j < nx; ++j) plant.A[i][j] *= plant.ranges[i] / plant.ranges[j];
    plant.B.push_back(uniform(-1.0, 1.0) * plant.ranges[i] / plant.limit);
    plant.Q[i] /= plant.ranges[i] * plant.ranges[i];
  }
  plant.R = scale(decades) / (plant.limit * plant.limit);
  if (random() % 2 == 0) {
    for (std::size_t i = 0; i < nx; ++i) plant.terminal.push_back(plant.Q[i] * scale(decades));
  }
  return plant;
}

/// 0: right. 1: refused. 2: wrong. Else a signal or an exception of another kind.
int outcomeInAProcess(unsigned seed) {
  const pid_t child = fork();
  if (child == 0) {
    const std::string refusal = refusalOrRight(randomPlant(seed));
    _exit(testing::Test::HasFailure() ? 2 : refusal.empty() ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

TEST(BadlyScaledProblems, AreRightOrRefused) {
  int right = 0;
  for (unsigned seed = 1; seed <= 150; ++seed) {
    const int outcome = outcomeInAProcess(seed);
    EXPECT_TRUE(outcome == 0 || outcome == 1) << "seed " << seed << ": " << outcome;
    right += outcome == 0 ? 1 : 0;
  }
  EXPECT_GE(right, 100);
  std::printf("%d of 150 right, the others refused\n", right);
}

}  // namespace
}  // namespace polyfly
