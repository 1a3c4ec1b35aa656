// `calibrate thrust`: from flights to the curve that flies.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "calibrate_tool.hpp"
#include "made_thrust.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;

// A made flight of a thrust curve; the voltage is held onto the rows of the others.
void writeThrust(const test::MadeThrust& made, std::uint32_t seed, const fs::path& path) {
  const FlightSignals signals = test::makeThrustFlight(made, seed);
  std::ofstream file(path);
  file << "t_s,thrust_cmd,az_mps2,roll_rad,pitch_rad,yaw_rad,vx_mps,vy_mps,vz_mps,battery_voltage_V";
  const TimeSeries& voltage = signals.at("voltage");
  std::size_t held = 0;
  for (std::size_t i = 0; i < signals.at("roll").time.size(); ++i) {
    const double time = signals.at("roll").time[i];
    while (held + 1 < voltage.time.size() && voltage.time[held + 1] <= time) ++held;
    file << "\n" << time;
    for (const char* signal : {"thrust_cmd", "specific_force_z", "roll", "pitch", "yaw", "vx", "vy", "vz"})
      file << "," << signals.at(signal).value[i];
    file << "," << voltage.value[held];
  }
}

// From flights to the options of a node, which say where the curve holds.
TEST_F(CalibrateTool, AThrustCurveGoesIntoTheOptions) {
  test::MadeThrust made;
  made.duration = 30.0;
  writeThrust(made, 1, folder_ / "one.csv");
  writeThrust(made, 2, folder_ / "two.csv");
  const std::string firefly = std::string(SOURCE_FOLDER) + "/launch/config/firefly.yaml";
  for (const std::string logs : {"one.csv", "one.csv two.csv"}) {
    ASSERT_EQ(run("thrust " + logs + " --mass 1.5 -o thrust.yaml"), 0) << err();
    EXPECT_NE(out().find("The curve holds from "), std::string::npos) << out();
    const YAML::Node curve = YAML::LoadFile(folder_ / "thrust.yaml")["curve"];
    EXPECT_EQ(curve["mass"].as<double>(), 1.5);
    EXPECT_TRUE(curve["voltage_matters"]);
    const bool several = logs.size() > 8;
    // Two flights have intervals of 12.7 standard errors.
    EXPECT_TRUE(curve["supported"].as<bool>() || several) << out();
    ASSERT_EQ(run("apply thrust.yaml --options " + firefly + " -o o.yaml" + (several ? " --force" : "")), 0)
        << err();
    const YAML::Node options = YAML::LoadFile(folder_ / "o.yaml");
    const auto polynomial = options["output"]["thrust_polynomial"].as<std::vector<double>>();
    ASSERT_EQ(polynomial.size(), curve["polynomial"].size());
    EXPECT_NEAR(polynomial[1], curve["polynomial"][1].as<double>(), 1e-5);
    EXPECT_NE(contents(folder_ / "o.yaml").find("  # flown at "), std::string::npos);
  }
  ASSERT_EQ(run("thrust one.csv --mass 1.5 --report report --quiet"), 0) << err();
  expectPage("report", {"thrust: curve", "command_1", "The curve holds from", "voltage_exponent"});
  made.excitation = 0.005;
  writeThrust(made, 3, folder_ / "calm.csv");
  EXPECT_EQ(run("thrust calm.csv --mass 1.5 -o thrust.yaml --strict"), 1);
  EXPECT_EQ(run("apply thrust.yaml --options " + firefly + " -o o.yaml"), 2);
  EXPECT_NE(err().find("Too little excitation"), std::string::npos) << err();
  EXPECT_EQ(run("thrust one.csv"), 2);
  EXPECT_EQ(run("thrust one.csv --mass 1.5 --degree 4"), 2);
}

}  // namespace
}  // namespace polyfly
