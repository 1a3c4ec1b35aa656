// `calibrate apply`: what becomes of a calibration.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <utility>

#include "calibrate_tool.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;

// From a flight with a known loop to the numbers that fly: within the intervals, and by their source.
TEST_F(CalibrateTool, HandsOutWhatFlewWithinItsIntervals) {
  const test::MadeLoop made;
  ASSERT_EQ(run("attitude flight.csv -o roll.yaml --vehicle multirotor"), 0) << err();
  const YAML::Node roll = YAML::LoadFile(folder_ / "roll.yaml")["axes"]["roll"];
  const YAML::Node model = roll["model_without_delay"];
  EXPECT_TRUE(model["supported"].as<bool>());
  EXPECT_GT(model["validation_percent"].as<double>(), 50.0);
  const auto holds = [](const YAML::Node& interval, double truth, double margin) {
    EXPECT_LE(interval[0].as<double>() - margin, truth);
    EXPECT_GE(interval[1].as<double>() + margin, truth);
  };
  holds(model["intervals_95"]["gain"], made.gain, 0.0);
  // Holding the command onto the response's rows delays it by up to a row.
  holds(model["intervals_95"]["tau"], made.tau + made.delay, 0.012);
  const std::string problem = std::string(SOURCE_FOLDER) + "/region_maps/problems/multirotor_lateral.yaml";
  ASSERT_EQ(run("apply roll.yaml --problem " + problem + " -o lateral.yaml"), 0) << err();
  const YAML::Node a = YAML::LoadFile(folder_ / "lateral.yaml")["model"];
  EXPECT_NEAR(-1.0 / a["A"][2][2].as<double>(), model["tau"].as<double>(), 1e-6);
  EXPECT_NEAR(-a["B"][2][0].as<double>() / a["A"][2][2].as<double>(), model["gain"].as<double>(), 1e-6);
  ASSERT_EQ(run("apply roll.yaml --options multirotor"), 0) << err();
  const YAML::Node options = YAML::Load(out());
  EXPECT_NEAR(options["nonlinear"]["roll_time"].as<double>(), model["tau"].as<double>(), 1e-6);
  EXPECT_NEAR(options["nonlinear"]["roll_gain"].as<double>(), model["gain"].as<double>(), 1e-6);
  EXPECT_NE(options["provenance"].as<std::string>().find("flight.csv"), std::string::npos);
  // The same flight of a fixed wing goes into neither.
  EXPECT_EQ(run("apply roll.yaml --options fixed_wing"), 2);
  EXPECT_NE(err().find("vehicle.kind: must be fixed_wing"), std::string::npos) << err();
  EXPECT_EQ(run("apply roll.yaml -o x.yaml"), 2);
  EXPECT_EQ(run("apply roll.yaml --problem " + problem + " --options multirotor -o x.yaml"), 2);
  EXPECT_EQ(run("apply roll.yaml --options firefly.yaml"), 2);
  EXPECT_NE(err().find("--options firefly.yaml: writes no file any more; --options multirotor"),
            std::string::npos)
      << err();
}

// Eq. 45 of a made second-order roll loop, into the file of the fixed wing.
TEST_F(CalibrateTool, HandsOutEq45OfAFixedWing) {
  test::MadeLoop made;
  made.order = LoopOrder::kSecond;
  made.delay = 0.0;
  made.duration = 60.0;
  made.response_rate = made.command_rate = 100.0;
  writeFlight(made, 7, "wing.csv");
  ASSERT_EQ(run("attitude wing.csv -o roll.yaml --vehicle fixed_wing"), 0) << err();
  const YAML::Node model =
      YAML::LoadFile(folder_ / "roll.yaml")["axes"]["roll"]["model_second_order_without_delay"];
  ASSERT_EQ(run("apply roll.yaml --options fixed_wing"), 0) << err();
  const YAML::Node options = YAML::Load(out())["model"];
  for (const auto& [key, truth] : std::vector<std::pair<std::string, double>>{
           {"a0", made.a0}, {"a1", made.a1}, {"b0", made.gain * made.a0}}) {
    EXPECT_NEAR(options[key].as<double>(), model[key].as<double>(), 1e-4) << key;
    EXPECT_NEAR(options[key].as<double>(), truth, 0.05 * truth) << key;
  }
}

// A flight of every kind: what the tool writes, apply reads without an unknown key.
TEST_F(CalibrateTool, EveryKindThatIsWrittenIsRead) {
  for (const int flight : {0, 1, 2}) {
    std::ofstream file(folder_ / ("all" + std::to_string(flight) + ".csv"));
    file << "t_s,vx_mps,vy_mps,vz_mps,vn_mps,ve_mps,tas_mps,roll_rad,pitch_rad,yaw_rad,thrust_cmd\n";
    for (int i = 0; i < 1200; ++i) {
      const double course = 0.01 * i + 0.1 * flight;
      file << 0.05 * i << "," << 15 * std::cos(course) << "," << 15 * std::sin(course) << ",0,"
           << 15 * std::cos(course) << "," << 15 * std::sin(course) << "," << 15 + 0.1 * (i % 3)
           << ",0.01,0.02," << course << "," << 14 + 0.1 * flight << "\n";
    }
  }
  writeFlight({}, 2, "b.csv");
  writeFlight({}, 3, "c.csv");
  const std::string source = SOURCE_FOLDER;
  for (const std::string logs : {" all0.csv", " all0.csv all1.csv all2.csv"}) {
    for (const std::string kind : {"drag", "mass", "disturbance"}) {
      ASSERT_EQ(run(kind + logs + " --vehicle fixed_wing -o " + kind + ".yaml --quiet"), 0) << err();
      run("apply " + kind + ".yaml --problem " + source +
          "/region_maps/problems/multirotor_lateral.yaml -o out.yaml");
      EXPECT_NE(err().find("vehicle.kind: must be multirotor"), std::string::npos) << kind << logs << err();
    }
  }
  for (const std::string logs : {" flight.csv --validation flight.csv", " flight.csv b.csv c.csv"}) {
    ASSERT_EQ(run("attitude" + logs + " -o attitude.yaml --quiet"), 0) << err();
    EXPECT_EQ(run("apply attitude.yaml --options multirotor"), 0) << logs << err();
  }
  EXPECT_NE(out().find("b.csv"), std::string::npos);
}

// The node refuses them; so does what prints them.
TEST_F(CalibrateTool, RefusesOptionsWithWhichTheNodeWouldNotStart) {
  const auto written = [this](const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
  };
  const std::string begin = "polyfly_calibration: 1\ndata: {file: a.bag}\nvehicle: {kind: unknown}\nkind: ";
  written("mass.yaml",
          begin + "mass\nparameters: {mass: {value: 1500, interval_95: [1, 2], supported: true}}\n");
  EXPECT_EQ(run("apply mass.yaml --options multirotor"), 2);
  EXPECT_NE(err().find("vehicle/mass: must lie in [0.01, 1000] kg, got 1500"), std::string::npos) << err();
  EXPECT_EQ(out(), "");
  const std::string roll = "attitude\naxes: {roll: {model_second_order_without_delay: {a0: 14, a1: ";
  written("roll.yaml", begin + roll + "1e4, b0: 13, supported: true}}}\n");
  EXPECT_EQ(run("apply roll.yaml --options fixed_wing"), 2);
  EXPECT_NE(err().find("model/a1: must lie in [0.1, 1000] 1/s, got 10000"), std::string::npos) << err();
  written("roll.yaml", begin + roll + "6, b0: 13, supported: true}}}\n");
  EXPECT_EQ(run("apply roll.yaml --options fixed_wing"), 0) << err();
}

}  // namespace
}  // namespace polyfly
