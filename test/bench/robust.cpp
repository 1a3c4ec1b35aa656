// The minimum-peak robust MPC: CPU time to solve and to prove, look-up, and peaks of flights beside others.
// Usage: bench_robust PROBLEMS SCRATCH; both folders.
#include <cstdio>
#include <exception>
#include <random>
#include <string>
#include <vector>

#include "offline_mpt/encode.hpp"
#include "online_timing.hpp"
#include "polyfly_test/robust_campaign.hpp"
#include "region_maps/map_image.hpp"
#include "region_maps/write_map.hpp"
#include "robust_mpc/prove_map.hpp"

namespace polyfly_bench {
namespace {

using polyfly_test::Adversary;
using polyfly_test::RobustCampaign;

polyfly::RobustLaw solve(const polyfly::RobustProblem& problem, bool exact) {
  const polyfly::RobustProgram program = polyfly::buildRobustProgram(problem);
  polyfly::ProjectOptions options;
  options.exact = exact;
  return polyfly::explicitLaw(problem, polyfly::projectFeasibleSet(program, options));
}

void solveRows(const std::string& name, const polyfly::RobustProblem& problem, double most,
               double most_exact) {
  double start = threadSeconds();
  const polyfly::RobustLaw law = solve(problem, false);
  printRow(
      {name + ": solved, vertices decided in floating point", threadSeconds() - start, "s", most, "", 0.0});
  printRow({name + ": regions", static_cast<double>(law.regions.size()), "", 0.0, "", 0.0});
  if (most_exact <= 0.0) return;
  start = threadSeconds();
  const polyfly::RoundedLaw rounded =
      polyfly::roundLaw(problem, solve(problem, true), polyfly::ExploreStatus::kComplete);
  const polyfly::MapImage image(polyfly::encode(rounded.program, rounded.partition));
  const polyfly::RobustProof proof = polyfly::proveRobustMap(image.view(name), problem);
  printRow({name + ": solved, and the map proven in fractions", threadSeconds() - start, "s", most_exact, "",
            0.0});
  if (!proof.passed()) throw std::runtime_error(name + ": not proven");
}

void lookupRow(const polyfly::RobustProblem& problem, const std::string& folder) {
  const polyfly::RoundedLaw law =
      polyfly::roundLaw(problem, solve(problem, true), polyfly::ExploreStatus::kComplete);
  const std::string path = folder + "/bench.map";
  polyfly::writeMap(polyfly::encode(law.program, law.partition), path);
  const polyfly::RegionMap map = polyfly::RegionMap::open(path);
  std::mt19937_64 engine(1);
  constexpr std::size_t kPoints = 4096;
  std::vector<double> thetas;
  while (thetas.size() < kPoints * problem.parameters.size()) {
    std::vector<double> theta;
    for (const auto& parameter : problem.parameters) {
      const double share = static_cast<double>(engine() >> 11U) * 0x1p-53;
      theta.push_back(parameter.signal.lower + share * (parameter.signal.upper - parameter.signal.lower));
    }
    double u = 0.0;
    if (map.evaluate(theta.data(), &u).status == polyfly::LookupStatus::kInside)
      thetas.insert(thetas.end(), theta.begin(), theta.end());
  }
  std::size_t next = 0;
  double sum = 0.0;
  const Times times = timeBatches(400, 1000, [&] {
    double u = 0.0;
    map.evaluate(&thetas[next * problem.parameters.size()], &u);
    next = (next + 1) % kPoints;
    sum += u;
  });
  // The sum is used, so that the compiler keeps the computation.
  if (sum == 0.5) std::fputs("", stderr);
  printRow({"N = 6, 3 states: look-up, median", 1000.0 * percentile(times.cpu, 0.5), "ns", 150.0, "", 0.0});
}

void flightRows(const std::string& problems, const std::string& folder) {
  const RobustCampaign campaign(problems + "/robust_lateral.yaml", folder + "/");
  const auto fly = [&](RobustCampaign::Options options, int flights) {
    RobustCampaign::Result all;
    for (const Adversary adversary :
         {Adversary::kRandom, Adversary::kTelegraph, Adversary::kWorst, Adversary::kGreedy}) {
      options.adversary = adversary;
      options.flights = flights / 4;
      all.add(campaign.fly(options));
    }
    return all;
  };
  RobustCampaign::Options options;
  const RobustCampaign::Result within = fly(options, 10000);
  printRow({"10,000 flights: steps with a violated bound", static_cast<double>(within.violations), "", 0.0,
            "", 0.0});
  printRow(
      {"10,000 flights: steps without a plan", static_cast<double>(within.infeasible), "", 0.0, "", 0.0});
  options.from_origin = true;
  const double robust = fly(options, 2000).peak;
  for (const auto& [controller, name] : {std::pair(RobustCampaign::Controller::kLqr, "LQR"),
                                         std::pair(RobustCampaign::Controller::kNominalMpc, "nominal MPC")}) {
    options.controller = controller;
    const double other = fly(options, 2000).peak;
    printRow({std::string("peak from rest, share of that of the ") + name, robust / other, "", 0.2, "", 0.0});
  }
  printRow({"peak from rest", robust, "m", 0.0, "", 0.0});
}

void run(const std::string& problems, const std::string& folder) {
  polyfly::RobustProblem three = polyfly::loadRobustProblem(problems + "/robust_lateral.yaml");
  solveRows("N = 6, 3 states", three, 0.5, 5.0);
  solveRows("N = 6, 4 states", polyfly::loadRobustProblem(problems + "/robust_lateral_4.yaml"), 2.0, 20.0);
  lookupRow(three, folder);
  flightRows(problems, folder);
  three.horizon = 10;
  solveRows("N = 10, 3 states", three, 30.0, 0.0);
}

}  // namespace
}  // namespace polyfly_bench

int main(int count, char** words) {
  if (count != 3) {
    std::fputs("usage: bench_robust PROBLEMS SCRATCH\n", stderr);
    return 2;
  }
  try {
    polyfly_bench::run(words[1], words[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_robust: %s\n", error.what());
    return 1;
  }
  std::puts("]");
  return 0;
}
