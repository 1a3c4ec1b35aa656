// Tracking problems in bad scales, unstable plants and heavy terminal weights: the law is right on the numbers of the problem
// file, or the problem is refused with its reason. The oracle condenses with 180 digits and tries all active sets.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <random>
#include <string>

#include "condensed_oracle.hpp"
#include "map_in_memory.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/online_program.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "offline_mpt/verify.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kRight = 1e-6;  // of the input's range
constexpr int kSamples = 300;

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
  for (int k = 0; k < 5; ++k) {
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

// In doubles H itself is wrong.
TEST(HeavyTerminalWeight, IsRefusedWhereRoundingOfTheCostDecides) {
  const std::string refusal = refusalOrRight(scalarPlant(0.9, 0.37, 4, {1e14}));
  EXPECT_NE(refusal.find("scaled.yaml: the condensed cost has the condition"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("terminal weight"), std::string::npos) << refusal;
}

TEST(UnstablePlant, IsRightOverALongHorizonOrRefusedByIt) {
  EXPECT_EQ(refusalOrRight(scalarPlant(3.0, 1.0, 7, {})), "");
  EXPECT_EQ(refusalOrRight(scalarPlant(2.0, 1.0, 7, {})), "");
  BoundedTracking plant = scalarPlant(2.0, 1.0, 60, {});
  try {
    condense(parseProblem(plant.text(), "long.yaml"));
    FAIL() << "not refused";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("horizon of 60"), std::string::npos) << error.what();
  }
}

// Near zero the law is that of the Riccati equation, whose solution is (a^2 + sqrt(a^4 + 4)) / 2 for weights and b of 1.
TEST(UnstablePlant, HasTheGainOfTheScalarRiccatiEquation) {
  for (const auto& [a, horizon] : std::vector<std::pair<double, int>>{{3.0, 10}, {2.0, 20}, {1.1, 60}}) {
    const BoundedTracking plant = scalarPlant(a, 1.0, horizon, {});
    const ParametricProgram program = condense(parseProblem(plant.text(), "long.yaml"));
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
