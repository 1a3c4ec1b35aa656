// The tool validate_filter on bags that are made here. Its replay is tested in test/filter_replay_test.cpp.
#include <gtest/gtest.h>
#include <mav_msgs/RollPitchYawrateThrust.h>
#include <nav_msgs/Odometry.h>
#include <online_controller/CommandFilterStatus.h>
#include <rosbag/bag.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "made_fence.hpp"
#include "online_controller/flight/command_filter.hpp"
#include "region_maps/region_map.hpp"
#include "synthetic_flight.hpp"

namespace polyfly_ros {
namespace {

constexpr double kPeriod = 0.05;
constexpr int kPeriods = 100;
constexpr double kPitch = 0.15;

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class ValidateFilter : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new polyfly::ScratchFolder;
    polyfly::MadeFence{kPeriod}.writeMap(map());
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string map() { return *folder_ / "fence_x.map"; }

  // A controller that pitches forward all the time, flown through the filter or past it.
  static void writeBag(const std::string& path, bool filtered, double record_error = 0.0) {
    rosbag::Bag bag(path, rosbag::bagmode::Write);
    std::vector<polyfly::RegionMap> maps;
    maps.push_back(polyfly::RegionMap::open(map()));
    const polyfly::MultirotorOptions options;
    polyfly::CommandFilter filter(std::move(maps), options);
    polyfly::VehicleState state;
    for (int k = 0; k < kPeriods; ++k) {
      const ros::Time now(100.0 + kPeriod * k);
      nav_msgs::Odometry odometry;
      odometry.header.stamp = now;
      odometry.pose.pose.orientation.w = 1.0;
      odometry.pose.pose.position.x = state.position.x();
      odometry.twist.twist.linear.x = state.velocity.x();
      bag.write("/firefly/odometry", now, odometry);
      mav_msgs::RollPitchYawrateThrust wish;
      wish.header.stamp = now;
      wish.pitch = kPitch;
      wish.thrust.z = options.mass * options.gravity;
      bag.write("/firefly/wished/roll_pitch_yawrate_thrust", now, wish);
      double a = options.gravity * std::sin(kPitch);
      if (filtered) {
        const polyfly::FilterReport& report = filter.step(state, {0.0, kPitch, 0.0, wish.thrust.z});
        a = report.axes[0].input;
        online_controller::CommandFilterStatus status;
        status.header.stamp = now;
        status.status = static_cast<std::uint8_t>(report.status);
        status.x.input = a + record_error;
        status.y.input = report.axes[1].input;
        status.z.input = report.axes[2].input;
        bag.write("/firefly/filter_status", now, status);
      }
      state.position.x() += kPeriod * state.velocity.x() + 0.5 * kPeriod * kPeriod * a;
      state.velocity.x() += kPeriod * a;
    }
    bag.close();
  }

  // Exit code; what the tool wrote is in output().
  static int run(const std::string& arguments) {
    const std::string command =
        std::string(VALIDATE_FILTER) + " " + arguments + " > " + *folder_ / "output.txt" + " 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));
  }
  static std::string output() { return contents(*folder_ / "output.txt"); }

  static polyfly::ScratchFolder* folder_;
};

polyfly::ScratchFolder* ValidateFilter::folder_ = nullptr;

TEST_F(ValidateFilter, passesWhereTheFilterFlew) {
  const std::string bag = *folder_ / "flown.bag", report = *folder_ / "report";
  writeBag(bag, true);
  EXPECT_EQ(run("--strict --bag " + bag + " --map " + map() + " --report " + report), 0) << output();
  EXPECT_NE(output().find("0  recorded answers that differ, of 100"), std::string::npos) << output();
  const auto json = nlohmann::json::parse(contents(report + "/summary.json"));
  EXPECT_EQ(json["verdict"], "passed");
  EXPECT_GT(json["axes"][0]["changed"], 10);
  EXPECT_EQ(json["axes"][0]["outside_s"], 0.0);
  EXPECT_NE(contents(report + "/index.html").find("Axis x: fence_x"), std::string::npos);
  // The same input gives the same bytes.
  const std::string page = contents(report + "/index.html");
  EXPECT_EQ(run("--quiet --bag " + bag + " --map " + map() + " --report " + report), 0);
  EXPECT_EQ(output(), "");
  EXPECT_EQ(contents(report + "/index.html"), page);
}

TEST_F(ValidateFilter, saysWhatIsToBeLookedAt) {
  const std::string bag = *folder_ / "past.bag";
  writeBag(bag, false);
  EXPECT_EQ(run("--bag " + bag + " --map " + map()), 0) << output();
  EXPECT_NE(output().find("x: the state was outside of the safe set for"), std::string::npos) << output();
  EXPECT_EQ(run("--strict --bag " + bag + " --map " + map()), 1);
  writeBag(bag, true, 0.1);
  EXPECT_EQ(run("--strict --bag " + bag + " --map " + map()), 1);
  EXPECT_NE(output().find("100 of 100 recorded answers are not those"), std::string::npos) << output();
}

TEST_F(ValidateFilter, badInputHasItsOwnExitCode) {
  const std::string bag = *folder_ / "bad.bag";
  writeBag(bag, true);
  EXPECT_EQ(run("--bag " + bag), 2);
  EXPECT_EQ(run("--bag " + bag + " --map " + bag), 2);
  EXPECT_NE(output().find("is not a region map"), std::string::npos) << output();
  EXPECT_EQ(run("--bag " + bag + " --map " + map() + " --wish nothing"), 2);
  EXPECT_NE(output().find("choose with --wish"), std::string::npos) << output();
  EXPECT_EQ(run("--bag " + bag + " --map " + map() + " --odometry filter_status"), 2);
  EXPECT_NE(output().find("must be nav_msgs/Odometry"), std::string::npos) << output();
  EXPECT_EQ(run("--bag " + bag + " --map " + map() + " --json " + bag), 2);
  EXPECT_NE(output().find("name of its own"), std::string::npos) << output();
}

}  // namespace
}  // namespace polyfly_ros

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
