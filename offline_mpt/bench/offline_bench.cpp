// Times the parametric solver alone (explore, one thread) and prints rows as JSON (test/bench/README.md).
// Reference problems are read from POLYFLY_DATA or ../shared/data and left out, with a word, where absent.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/explore.hpp"

namespace {

namespace fs = std::filesystem;
using polyfly::ParametricProgram;

constexpr int kRuns = 5;

// CPU seconds and regions of peers as our notes record them: another machine and hour, so orders, not
// percents. Only runs that lost no region; "unpruned": without the pruning of pairs that loses some.
struct Peer {
  const char* problem;
  const char* tool;  // none where no peer finished
  double seconds;
  int regions;
};

constexpr const char* kDaqp = "ParametricDAQP 0.6.1, noted on another machine";
constexpr const char* kUnpruned = "ParametricDAQP 0.6.1 unpruned, noted on another machine";
constexpr const char* kPpopt = "PPOPT geometric, noted on another machine";

constexpr Peer kPeers[] = {
    {"bemporad2002", kDaqp, 0.000126, 9},
    {"di_N2", kDaqp, 0.000416, 7},
    {"di_N5", kDaqp, 0.00438, 25},
    {"di_N10", kDaqp, 0.038, 35},
    {"di_N15", kPpopt, 0.384, 35},
    {"di_N5_xf0_eq", kDaqp, 0.00308, 27},
    {"invpend_N5", kDaqp, 0.000448, 11},
    {"invpend_N5_x", kDaqp, 0.0676, 567},
    {"invpend_track_Np50_Nc5", kDaqp, 0.00317, 93},
    {"mass_spring4_N5", kDaqp, 0.0368, 453},
    {"mass_spring4_N10", kDaqp, 6.69, 6337},
    {"mass_spring6_N5", kDaqp, 0.388, 2020},
    {"multirotor_N5", kDaqp, 0.00189, 13},
    {"multirotor_N10", kDaqp, 0.0339, 23},
    {"multirotor_N20", kPpopt, 0.641, 43},
    {"multirotor_N10_soft", kPpopt, 0.306, 43},
    {"rnd_n3_m20_t4", kDaqp, 0.00156, 33},
    {"rnd_n5_m40_t3", kDaqp, 0.00944, 147},
    {"rnd_n6_m20_t3", kUnpruned, 0.0255, 407},
    {"rnd_n10_m20_t4", kDaqp, 0.211, 4664},
    {"deg_licq_ahmadi", kDaqp, 0.000172, 11},
    {"deg_facet_to_facet", kDaqp, 0.000313, 12},
    {"deg_di_N5_dup", nullptr, 0.0, 0},
    {"deg_di_N5_xf0_ineq", kPpopt, 0.0748, 27},
    {"mplp_di_inf_N3", kPpopt, 0.109, 30},
    {"mplp_di_inf_N5", kPpopt, 0.435, 76},
    {"mplp_multirotor_inf_N3", kPpopt, 0.744, 98},
};

double cpuSeconds() {
  timespec now = {};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// A strictly convex program with random rows; its parameters range over [-1, 1].
ParametricProgram randomProgram(std::uint64_t seed, int n, int m, int p) {
  std::mt19937_64 engine(seed);
  const auto matrix = [&engine](int rows, int cols) {
    Eigen::MatrixXd result(rows, cols);
    for (Eigen::Index i = 0; i < result.size(); ++i) {
      result.data()[i] = 2.0 * (static_cast<double>(engine() >> 11) * 0x1p-53) - 1.0;
    }
    return result;
  };
  ParametricProgram program;
  program.name = "random_n" + std::to_string(n) + "_m" + std::to_string(m) + "_p" + std::to_string(p);
  const Eigen::MatrixXd L = matrix(n, n);
  program.H = L * L.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
  program.f = Eigen::VectorXd::Zero(n);
  program.F = 2.0 * matrix(n, p);
  program.A = matrix(m, n);
  program.b = Eigen::VectorXd::Constant(m, 0.2) + 0.4 * matrix(m, 1).cwiseAbs();
  program.S = 0.3 * matrix(m, p);
  for (int i = 0; i < p; ++i) program.parameters.push_back({"t" + std::to_string(i), "1", -1.0, 1.0});
  program.A_theta.resize(0, p);
  program.b_theta.resize(0);
  program.inputs.push_back({"z0", "1", -1e3, 1e3});
  program.E = Eigen::MatrixXd::Identity(1, n);
  program.C = Eigen::MatrixXd::Zero(1, p);
  program.c = Eigen::VectorXd::Zero(1);
  return program;
}

void measure(const std::string& problem, const ParametricProgram& program, const Peer* peer,
             nlohmann::ordered_json& rows) {
  std::vector<double> seconds;
  polyfly::Partition partition;
  for (int run = 0; run < kRuns; ++run) {
    const double before = cpuSeconds();
    partition = polyfly::explore(program);
    seconds.push_back(cpuSeconds() - before);
  }
  const std::size_t regions = partition.regions.size();
  const bool complete = partition.status == polyfly::ExploreStatus::kComplete;
  const std::string name = complete ? problem : problem + " (" + toString(partition.status) + ")";
  std::sort(seconds.begin(), seconds.end());
  const double median = seconds[kRuns / 2];
  nlohmann::ordered_json time = {{"name", name + ": explore"}, {"value", median}, {"unit", "s"}};
  nlohmann::ordered_json count = {{"name", name + ": regions"}, {"value", regions}, {"unit", ""}};
  nlohmann::ordered_json rate = {
      {"name", name + ": rate"}, {"value", static_cast<double>(regions) / median}, {"unit", "regions/s"}};
  if (complete && peer != nullptr && peer->tool != nullptr) {
    time.update({{"peer", peer->tool}, {"peer_value", peer->seconds}});
    count.update({{"peer", peer->tool}, {"peer_value", peer->regions}});
    rate.update({{"peer", peer->tool}, {"peer_value", peer->regions / peer->seconds}});
  }
  rows.push_back(count);
  rows.push_back(time);
  rows.push_back(rate);
}

fs::path referenceFolder() {
  const char* data = std::getenv("POLYFLY_DATA");
  return (data != nullptr ? fs::path(data) : fs::path("..") / "shared" / "data") / "mp_problems";
}

void measureAll() {
  auto rows = nlohmann::ordered_json::array();
  constexpr int kSizes[][3] = {{4, 12, 3}, {6, 20, 3}, {8, 24, 4}};
  for (const auto& [n, m, p] : kSizes) {
    const ParametricProgram program = randomProgram(1, n, m, p);
    measure(program.name, program, nullptr, rows);
  }
  const fs::path folder = referenceFolder();
  if (!fs::is_directory(folder)) {
    std::fprintf(stderr, "the reference problems are not at hand (POLYFLY_DATA): generated problems only\n");
  } else {
    for (const Peer& peer : kPeers) {
      const fs::path file = folder / (std::string(peer.problem) + ".json");
      if (fs::exists(file)) {
        measure(peer.problem, polyfly::loadProgram(file.string()), &peer, rows);
      } else {
        std::fprintf(stderr, "left out, not at hand: %s\n", peer.problem);
      }
    }
  }
  std::printf("%s\n", rows.dump(1).c_str());
}

}  // namespace

int main() {
  try {
    measureAll();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_offline: %s\n", error.what());
    return 1;
  }
  return 0;
}
