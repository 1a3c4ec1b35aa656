// Times the parts that solve in flight; prints rows as JSON. usage: bench_online PROBLEMS REFERENCE_QPS
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mpc_core/bounded_qp.hpp"
#include "online_laws.hpp"
#include "online_timing.hpp"

namespace {

using namespace polyfly_bench;

// Number of batches for each problem.
constexpr int kBatches = 300;
constexpr int kCalls = 8;

struct Set {
  const char* name;
  const char* title;
  bool warm;  // each problem from the active set of the one before
  double most;
  const char* peer;
  double peer_value;
};

// Peers as measured on two shared cores with their own interfaces, wall-clock medians.
constexpr Set kSets[] = {
    {"lin_seq", "linear MPC QP, n 57, closed loop, warm", true, 2.5, "DAQP warm, as recorded", 2.5},
    {"lin_rand", "linear MPC QP, n 57, random, cold", false, 8.0, "DAQP, as recorded", 8.2},
    {"fw_seq", "fixed-wing QP with new H, n 40, closed loop, warm", true, 6.0, "qpOASES, as recorded", 8.2},
    {"fw_rand", "fixed-wing QP with new H, n 40, random, cold", false, 0.0, "", 0.0},
    {"fw_hard", "fixed-wing QP with new H, n 40, stiff, cold", false, 20.0, "HPIPM dense, as recorded", 24.0},
};

struct Instance {
  std::vector<double> H, g, lower, upper, expected;
};

std::vector<Instance> readInstances(const nlohmann::json& file) {
  std::vector<Instance> instances;
  for (const auto& entry : file["instances"]) {
    instances.push_back({entry["H"], entry["g"], entry["lb"], entry["ub"], entry["x_ref"]});
  }
  return instances;
}

void measure(const Set& set, const std::string& path) {
  std::ifstream stream(path);
  if (!stream) {
    std::fprintf(stderr, "left out, not at hand: %s\n", path.c_str());
    return;
  }
  const nlohmann::json file = nlohmann::json::parse(stream);
  const int n = file["n"];
  const bool constant = file["h_const"] == 1;
  const std::vector<Instance> instances = readInstances(file);
  polyfly::BoundedQp solver(n);
  std::vector<polyfly::QpSide> start(static_cast<std::size_t>(n), polyfly::QpSide::kInactive);
  if (constant) solver.setConstantHessian(instances.front().H.data());
  Times times;
  double error = 0.0;
  int most = 0;
  for (const Instance& instance : instances) {
    const polyfly::QpVectors vectors{instance.g.data(), instance.lower.data(), instance.upper.data(), nullptr,
                                     nullptr};
    const auto solve = [&] {
      if (!constant) solver.setHessian(instance.H.data());
      solver.solve(vectors, set.warm ? start.data() : nullptr);
    };
    solve();  // once to warm the caches
    times.add(timeBatches(kBatches, kCalls, solve));
    for (int i = 0; i < n; ++i) {
      error = std::max(error, std::abs(solver.x()[i] - instance.expected[static_cast<std::size_t>(i)]));
    }
    most = std::max(most, solver.iterations());
    start.assign(solver.activeSet(), solver.activeSet() + n);
  }
  const std::string title = std::string(set.name) + ": " + set.title;
  printTimes(times, {title, 0.0, "us", set.most, set.peer, set.peer_value});
  printRow({title + ", greatest error", error, "", 1e-9, "", 0.0});
  printRow({title + ", most working sets", static_cast<double>(most), "", 0.0, "", 0.0});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: bench_online FOLDER_OF_PROBLEMS FOLDER_OF_REFERENCE_QPS\n");
    return 2;
  }
  try {
    for (const Set& set : kSets) measure(set, std::string(argv[2]) + "/" + set.name + ".json");
    measureLaws(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_online: %s\n", error.what());
    return 1;
  }
  std::printf("]\n");
  return 0;
}
