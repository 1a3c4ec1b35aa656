// A soak through the node: odometry, references and requests over topics and services, commands as they are
// sent. Private parameters: map_folders, problem_folder, duration [s], seed, and json, a file for
// figures.
#include "node_soak.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "mpc_core/mpc_problem.hpp"

namespace {

using namespace polyfly_test;

// Laws on their way to and from the control thread, half a megabyte a set, and maps about to be swapped.
constexpr long kTransit = 2L << 20;  // [bytes]

polyfly_test::SoakTuning tuningOf(const std::string& folder) {
  std::array<polyfly::MpcProblem, 3> problems;
  const char* axes[] = {"longitudinal", "lateral", "vertical"};
  for (std::size_t i = 0; i < 3; ++i)
    problems[i] = polyfly::loadProblem(folder + "/multirotor_" + axes[i] + ".yaml");
  SoakTuning tuning;
  tuning.linear = polyfly::linearTuning(problems);
  tuning.options.robust_estimate_time = 1.0;
  return tuning;
}

void write(const std::string& path, const SoakOptions& options, const SoakResult& result, int swapped) {
  std::ofstream file(path);
  file << "{\"simulated_s\": " << options.duration << ", \"commands\": " << result.commands
       << ", \"silences\": " << result.silences << ", \"not_numbers\": " << result.not_numbers
       << ", \"jumps\": " << result.jumps << ", \"out_of_order\": " << result.out_of_order
       << ", \"wrong_frames\": " << result.wrong_frames << ", \"huge\": " << result.huge
       << ", \"reconfigurations\": " << result.reconfigurations << ", \"map_swaps\": " << result.swaps
       << ", \"map_swaps_granted\": " << swapped << ", \"law_selections\": " << result.selections
       << ", \"samples_without_answer\": " << result.failsafe << ", \"recoveries\": " << result.recoveries
       << ", \"slowest_recovery_s\": " << result.slowest
       << ", \"greatest_error_m\": " << result.greatest_error
       << ", \"allocated_growth_bytes\": " << result.allocated_growth
       << ", \"violations\": " << result.violations.size() << "}\n";
}

TEST(NodeSoak, BoundsHoldAndEveryFaultIsRecoveredFrom) {
  const ros::NodeHandle parameters("~");
  std::vector<std::string> folders;
  ASSERT_TRUE(parameters.getParam("map_folders", folders));
  const SoakTuning tuning = tuningOf(parameters.param<std::string>("problem_folder", ""));
  SoakOptions options;
  options.duration = parameters.param("duration", 100.0);
  options.seed = static_cast<std::uint32_t>(parameters.param("seed", 1));
  options.laws.emplace_back("robust_explicit");
  polyfly_ros::NodeSoak controller(folders, tuning);
  const SoakResult result = soak(controller, tuning, static_cast<int>(folders.size()), options);
  const std::string json = parameters.param<std::string>("json", "");
  if (!json.empty()) write(json, options, result, controller.swapped());

  EXPECT_TRUE(result.violations.empty())
      << result.violations.size() << ", first: " << result.violations.front();
  EXPECT_TRUE(controller.failures().empty())
      << controller.failures().size() << ", first: " << controller.failures().front();
  EXPECT_EQ(controller.unanswered(), 0);
  EXPECT_GT(result.commands, static_cast<long>(0.9 * static_cast<double>(result.samples)));
  EXPECT_GT(result.recoveries, static_cast<long>(options.duration / 20.0));
  EXPECT_GT(result.reconfigurations, static_cast<long>(options.duration / 10.0));
  EXPECT_GT(controller.swapped(), static_cast<int>(options.duration / 40.0));
  EXPECT_GT(controller.swappedRobust(), 0);
  EXPECT_GT(result.failsafe, static_cast<long>(options.duration / 5.0));
  EXPECT_LT(result.allocated_growth, kTransit);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "soak");
  ros::param::set("/use_sim_time", true);
  ros::start();
  const int result = RUN_ALL_TESTS();
  ros::shutdown();
  return result;
}
