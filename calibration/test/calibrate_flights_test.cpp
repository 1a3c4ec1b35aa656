// `calibrate` with several flights, and with flights that hold more than flight.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "calibrate_tool.hpp"
#include "made_logs.hpp"
#include "made_stretches.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;

// What is no flight stands in text, YAML and page, for every command that reads flights.
TEST_F(CalibrateTool, LeavesATumbleOutAndSaysSo) {
  test::MadeStretches made;
  made.tumbles = 4.0;
  made.manoeuvres = 40.0;
  writeStretches(test::makeStretches(made, 1).signals, "tumble.csv");
  for (const std::string command : {"attitude", "disturbance --mass 1.5", "drag", "mass"}) {
    ASSERT_EQ(run(command + " tumble.csv -o out.yaml --report page"), 0) << err();
    EXPECT_NE(out().find("s: upset, not commanded"), std::string::npos) << command << "\n" << out();
    EXPECT_NE(contents(folder_ / "out.yaml").find("upset, not commanded"), std::string::npos) << command;
    EXPECT_NE(contents(folder_ / "page/index.html").find("upset, not commanded"), std::string::npos)
        << command;
    fs::remove_all(folder_ / "page");
    if (command == "attitude") {
      EXPECT_NE(out().find("yaw_rate is not identified: the log has no yaw_rate_cmd and no yaw_rate"),
                std::string::npos)
          << out();
    }
  }
  // So in one of several flights, whose others say nothing of it.
  made.tumbles = 0.0;
  writeStretches(test::makeStretches(made, 2).signals, "calm.csv");
  ASSERT_EQ(run("attitude calm.csv tumble.csv --axis pitch -o out.yaml"), 0) << err();
  EXPECT_NE(out().find("left out: tumble.csv: "), std::string::npos) << out();
  const YAML::Node flights = YAML::LoadFile(folder_ / "out.yaml")["axes"]["pitch"]["flights"];
  ASSERT_EQ(flights.size(), 2u);
  const auto upset = [](const YAML::Node& flight) {
    return std::any_of(flight["left_out"].begin(), flight["left_out"].end(), [](const YAML::Node& one) {
      return one["reason"].as<std::string>().find("upset") != std::string::npos;
    });
  };
  EXPECT_TRUE(upset(flights[1]));
  EXPECT_FALSE(upset(flights[0]));
}

// Only logs of an autopilot name their vehicle.
TEST_F(CalibrateTool, RefusesFlightsOfTwoKindsOfVehicle) {
  for (const std::string message : {"MOTB", "TECS"}) {
    MadeDataflash log = madeArduPilotFlight(1.0, message == "MOTB" ? 0.2 : 0.3);
    log.format(11, message, "Qf", "TimeUS,A", 3 + 8 + 4);
    log.row(11, std::vector<std::uint8_t>(8 + 4));
    writeBytes(log.bytes, folder_ / (message + ".bin"));
  }
  EXPECT_EQ(run("attitude MOTB.bin TECS.bin -o roll.yaml"), 2);
  EXPECT_NE(err().find("TECS.bin: the vehicle is a fixed_wing"), std::string::npos) << err();
  EXPECT_NE(err().find("that of MOTB.bin a multirotor"), std::string::npos) << err();
  const auto kind = [this] {
    return YAML::LoadFile(folder_ / "roll.yaml")["vehicle"]["kind"].as<std::string>();
  };
  ASSERT_EQ(run("attitude MOTB.bin TECS.bin --vehicle multirotor -o roll.yaml"), 0) << err();
  EXPECT_EQ(kind(), "multirotor");
  // A flight that does not tell leaves it to the others.
  ASSERT_EQ(run("attitude flight.csv TECS.bin -o roll.yaml"), 0) << err();
  EXPECT_EQ(kind(), "fixed_wing");
  ASSERT_EQ(run("attitude flight.csv -o roll.yaml"), 0) << err();
  EXPECT_EQ(kind(), "unknown");
}

TEST_F(CalibrateTool, TakesAnotherFlightForValidation) {
  writeFlight({}, 2, "other.csv");
  ASSERT_EQ(run("attitude flight.csv --validation other.csv -o roll.yaml"), 0) << err();
  const YAML::Node yaml = YAML::LoadFile(folder_ / "roll.yaml");
  EXPECT_EQ(yaml["data"]["validation"]["file"].as<std::string>(), "other.csv");
  EXPECT_FALSE(yaml["axes"]["roll"]["validation"]["by_halves"].as<bool>());
  EXPECT_GT(yaml["axes"]["roll"]["validation"]["validation_percent"].as<double>(), 90.0);
}

// As `rosbag record --split` leaves it.
TEST_F(CalibrateTool, TakesThePiecesOfARecordingForOneFlight) {
  ASSERT_EQ(run("attitude flight.csv -o whole.yaml"), 0) << err();
  std::istringstream lines(contents(folder_ / "flight.csv"));
  std::string head, line;
  std::getline(lines, head);
  std::ofstream first(folder_ / "first.csv"), second(folder_ / "second.csv");
  first << head << "\n";
  second << head << "\n";
  for (int number = 0; std::getline(lines, line); ++number) (number < 1000 ? first : second) << line << "\n";
  first.close();
  second.close();
  for (const std::string order : {"first.csv second.csv", "second.csv first.csv"}) {
    ASSERT_EQ(run("attitude " + order + " -o pieces.yaml"), 0) << err();
    EXPECT_NE((out() + err()).find("first.csv: the recording was split and goes on in second.csv"),
              std::string::npos)
        << out();
    const YAML::Node roll = YAML::LoadFile(folder_ / "pieces.yaml")["axes"]["roll"];
    EXPECT_FALSE(roll["flights"]);
    const YAML::Node whole = YAML::LoadFile(folder_ / "whole.yaml")["axes"]["roll"];
    const auto gain = [](const YAML::Node& axis) { return axis["model"]["gain"].as<double>(); };
    EXPECT_EQ(gain(roll), gain(whole));
  }
}

TEST_F(CalibrateTool, MakesOneModelOfSeveralFlights) {
  test::MadeLoop made;
  made.gain = 0.9;
  writeFlight(made, 2, "b.csv");
  made.gain = 1.1;
  writeFlight(made, 3, "c.csv");
  ASSERT_EQ(run("attitude flight.csv b.csv c.csv -o loops.yaml --report report"), 0) << err();
  const YAML::Node yaml = YAML::LoadFile(folder_ / "loops.yaml");
  ASSERT_EQ(yaml["data"]["training"].size(), 3u);
  EXPECT_EQ(yaml["data"]["training"][1]["file"].as<std::string>(), "b.csv");
  const YAML::Node roll = yaml["axes"]["roll"];
  ASSERT_EQ(roll["flights"].size(), 3u);
  EXPECT_EQ(roll["flights"][2]["file"].as<std::string>(), "c.csv");
  EXPECT_TRUE(roll["validation"]["by_flights"].as<bool>());
  EXPECT_GT(roll["validation"]["validation_percent"].as<double>(), 80.0);
  const YAML::Node model = roll["model"];
  EXPECT_NEAR(model["gain"].as<double>(), 1.0, 0.02);
  EXPECT_NEAR(model["intervals_95"]["gain"][1].as<double>() - model["gain"].as<double>(), 0.1, 0.02);
  EXPECT_NE(out().find("on each flight by the others"), std::string::npos) << out();
  expectPage("report", {"flight.csv", "c.csv", "What each flight says"});
}

TEST_F(CalibrateTool, FindsDragAndBoundsOfSeveralFlights) {
  for (const int flight : {1, 2}) {
    std::ofstream file(folder_ / ("fast" + std::to_string(flight) + ".csv"));
    file << "t_s,vx_mps,vy_mps,vz_mps,roll_rad,pitch_rad,yaw_rad\n";
    const double drag = 0.2 + 0.02 * flight;
    double velocity = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const double time = 0.02 * i;
      const double pitch = 0.1 * std::sin(0.5 * time);
      file << time << "," << velocity << "," << velocity << ",0," << -pitch << "," << pitch << ",0\n";
      velocity += 0.02 * (9.8066 * std::tan(pitch) - drag * velocity);
    }
  }
  ASSERT_EQ(run("drag fast1.csv fast2.csv --window 1:0:30 --window 2:30:60 -o drag.yaml --report drag"), 0)
      << err();
  const YAML::Node yaml = YAML::LoadFile(folder_ / "drag.yaml");
  ASSERT_EQ(yaml["data"].size(), 2u);
  EXPECT_EQ(yaml["data"][1]["file"].as<std::string>(), "fast2.csv");
  EXPECT_EQ(yaml["windows"][1][0][1].as<double>(), 60.0);
  ASSERT_EQ(yaml["flights"].size(), 2u);
  EXPECT_NEAR(yaml["flights"][1]["drag_x"].as<double>(), 0.24, 0.01);
  EXPECT_NEAR(yaml["parameters"]["drag_x"]["value"].as<double>(), 0.23, 0.01);
  expectPage("drag", {"What each flight says", "fast2.csv"});
  // A flight without a window of its own is used as a whole.
  const auto mean = [this](const std::string& windows) {
    EXPECT_EQ(run("disturbance fast1.csv fast2.csv --drag 0.22 0.22 0 -o one.yaml" + windows), 0) << err();
    return YAML::LoadFile(folder_ / "one.yaml")["axes"]["x"]["mean"].as<double>();
  };
  EXPECT_DOUBLE_EQ(mean(" --window 1:0:30"), mean(" --window 1:0:30 --window 2:-1:100"));
  EXPECT_NE(mean(" --window 1:0:30"), mean(" --window 1:0:30 --window 2:0:10"));
  ASSERT_EQ(run("disturbance fast1.csv fast2.csv --drag 0.22 0.22 0 -o bound.yaml"), 0) << err();
  EXPECT_EQ(YAML::LoadFile(folder_ / "bound.yaml")["data"].size(), 2u);
}

TEST_F(CalibrateTool, TellsWhatIsWrongWithSeveralFlights) {
  std::ofstream(folder_ / "still.csv") << "t_s,roll_cmd_rad,roll_rad\n0,0,0\n0.02,0,0\n0.04,0,0\n";
  fs::copy_file(folder_ / "flight.csv", folder_ / "copy.csv");
  EXPECT_EQ(run("attitude flight.csv copy.csv"), 2);
  EXPECT_NE(err().find("copy.csv: is the same flight as flight.csv"), std::string::npos) << err();
  EXPECT_EQ(run("attitude flight.csv still.csv --window 3:1:2"), 2);
  EXPECT_NE(err().find("must be that of a log, 1 to 2"), std::string::npos) << err();
  EXPECT_EQ(run("attitude flight.csv still.csv -o still.csv"), 2);
  ASSERT_EQ(run("attitude flight.csv still.csv -o roll.yaml --strict"), 1) << err();
  EXPECT_NE(out().find("Left out: still.csv: roll: "), std::string::npos) << out();
  // Each flight with a window of its own.
  writeFlight({}, 2, "b.csv");
  ASSERT_EQ(run("attitude flight.csv b.csv --window 1:2:20 --window 2:5:28 -o roll.yaml"), 0) << err();
  const YAML::Node flights = YAML::LoadFile(folder_ / "roll.yaml")["axes"]["roll"]["flights"];
  EXPECT_EQ(flights[0]["windows"][0][1].as<double>(), 20.0);
  EXPECT_EQ(flights[1]["windows"][0][0].as<double>(), 5.0);
}

}  // namespace
}  // namespace polyfly
