// `calibrate` with one flight: what it reads, finds, writes and refuses.
#include "calibrate_tool.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "identification/calibration_file.hpp"
#include "made_logs.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;

TEST_F(CalibrateTool, TellsBadInputInOneLineWithItsName) {
  std::ofstream(folder_ / "odd.csv") << "t_s,\x1b[31mroll\n0,1\n1,2\n";
  for (const auto& [arguments, begin] : std::vector<std::pair<std::string, std::string>>{
           {"mass flight.csv --mass nan", "calibrate: "},
           {"drag flight.csv --mass nan", "calibrate: --mass: nan is not a finite number above 0"},
           {"drag flight.csv --gravity 1e999", "calibrate: --gravity: 1e999 is not a number from 1 to 30"},
           {"disturbance flight.csv --drag 1 nan 1", "calibrate: --drag: nan is not a finite number"},
           {"attitude flight.csv --axis foo",
            "calibrate: --axis: foo is not one of roll, pitch, yaw_rate, thrust"},
           {"attitude flight.csv --window nan:1", "calibrate: --window nan:1: must be FROM:TO"},
           {"attitude /dev/zero", "calibrate: /dev/zero: "},
           {"attitude odd.csv --signal roll=x",
            "calibrate: odd.csv: no column x; there are t_s, \\x1b[31mroll"},
           {"wind flight.csv -o wind.yaml --any", "calibrate: wind: was removed; fly circles"},
           {"heading", "calibrate: heading: was removed; compare the direction"},
           {"land", "calibrate: 'land' is no command"}}) {
    EXPECT_EQ(run(arguments), 2) << arguments;
    EXPECT_EQ(err().rfind(begin, 0), 0u) << begin << " in: " << err();
    const std::string said = err();
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  }
}

TEST_F(CalibrateTool, ReadsTheLogsOfAutopilots) {
  writeBytes(madePx4Flight(0.93, 0.21).bytes, folder_ / "flight.ulg");
  writeBytes(madeArduPilotFlight(0.93, 0.21).bytes, folder_ / "flight.bin");
  for (const std::string name : {"flight.ulg", "flight.bin"}) {
    ASSERT_EQ(run("attitude " + name + " --axis roll -o loop.yaml"), 0) << err() << out();
    const YAML::Node roll = YAML::LoadFile(folder_ / "loop.yaml")["axes"]["roll"];
    EXPECT_NEAR(roll["model_without_delay"]["gain"].as<double>(), 0.93, 0.01);
    EXPECT_NEAR(roll["model_without_delay"]["tau"].as<double>(), 0.21, 0.01);
  }
}

// A log that lost something gives its numbers, and fails only where that is asked for.
TEST_F(CalibrateTool, CountsALossWhereItIsStrict) {
  const std::vector<std::uint8_t> whole = madePx4Flight(0.93, 0.21).bytes;
  std::vector<std::uint8_t> damaged = whole;
  damaged.erase(damaged.begin() + static_cast<std::ptrdiff_t>(damaged.size() / 4));
  writeBytes(whole, folder_ / "whole.ulg");
  writeBytes(damaged, folder_ / "damaged.ulg");
  EXPECT_EQ(run("attitude whole.ulg --axis roll --strict"), 0) << err() << out();
  EXPECT_EQ(out().rfind("roll: gain .9", 0), 0u) << out();
  EXPECT_NE(out().find(" s, supported ("), std::string::npos) << out();
  EXPECT_EQ(run("attitude damaged.ulg --axis roll"), 0) << err();
  EXPECT_NE(out().find("% of the file were read"), std::string::npos) << out();
  EXPECT_EQ(run("attitude damaged.ulg --axis roll --strict"), 1) << err() << out();
}

// What the tool reads it does not write over, under any name; it says so before the work.
TEST_F(CalibrateTool, KeepsTheFlightThatItReads) {
  const std::string flight = contents(folder_ / "flight.csv");
  fs::create_symlink("flight.csv", folder_ / "link.csv");
  fs::create_hard_link(folder_ / "flight.csv", folder_ / "hard.csv");
  fs::create_directory_symlink(".", folder_ / "here");
  fs::create_directory(folder_ / "fresh");
  fs::create_directory(folder_ / "report");
  fs::create_symlink("../flight.csv", folder_ / "report/calibration.yaml");
  for (const std::string arguments :
       {"attitude flight.csv -o flight.csv", "attitude flight.csv -o ./flight.csv",
        "attitude link.csv -o flight.csv", "attitude flight.csv -o link.csv",
        "attitude flight.csv -o hard.csv", "attitude flight.csv -o here/flight.csv",
        "attitude other.csv --validation flight.csv -o flight.csv", "attitude flight.csv --report report",
        "attitude flight.csv -o fresh/index.html --report fresh", "drag flight.csv -o flight.csv",
        "drag flight.csv -o link.csv", "mass flight.csv --report report",
        "disturbance flight.csv -o hard.csv", "apply flight.csv --problem problem.yaml -o link.csv",
        "apply a.yaml flight.csv --problem problem.yaml -o flight.csv",
        "apply a.yaml --problem flight.csv -o hard.csv"}) {
    EXPECT_EQ(run(arguments), 2) << arguments;
    EXPECT_NE(err().find("name of its own"), std::string::npos) << arguments << ": " << err();
    EXPECT_EQ(out(), "");
    EXPECT_EQ(contents(folder_ / "flight.csv"), flight) << arguments;
  }
  EXPECT_TRUE(fs::is_empty(folder_ / "fresh"));
}

TEST_F(CalibrateTool, SaysBeforeTheWorkWhatItCannotWrite) {
  for (const std::string arguments :
       {"-o missing/roll.yaml", "-o .", "-o new/roll.yaml --report new", "--report flight.csv",
        "--report flight.csv/deeper", "-o flight.csv/roll.yaml"}) {
    EXPECT_EQ(run("attitude flight.csv " + arguments), 2) << arguments;
    EXPECT_EQ(out(), "") << arguments;
    const std::string said = err();
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  }
}

TEST_F(CalibrateTool, WritesBesideAndRenames) {
  fs::create_directory(folder_ / "data");
  fs::create_symlink("data/roll.yaml", folder_ / "link.yaml");
  fs::create_symlink("/dev/full", folder_ / "full.yaml");
  ASSERT_EQ(run("attitude flight.csv -o link.yaml --quiet"), 0) << err();
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.yaml"));
  const std::string good = contents(folder_ / "data/roll.yaml");
  EXPECT_NE(good.find("polyfly_calibration"), std::string::npos);
  EXPECT_EQ(run("attitude flight.csv -o full.yaml --quiet"), 2);
  EXPECT_EQ(err(), "calibrate: full.yaml: cannot be written: No space left on device\n");
  fs::create_symlink("/dev/stdout", folder_ / "out.yaml");
  EXPECT_EQ(run("attitude flight.csv -o out.yaml --quiet"), 0) << err();
  EXPECT_EQ(out(), good);
  // In blocks of 512 or 1024 bytes, less than what is to be written; it stands for a full disk.
  ASSERT_GT(good.size(), 1024u);
  EXPECT_EQ(run("attitude flight.csv -o link.yaml --quiet --delay-max 0.4", "ulimit -f 1; "), 2);
  EXPECT_EQ(err(), "calibrate: link.yaml: cannot be written: File too large\n");
  EXPECT_EQ(contents(folder_ / "data/roll.yaml"), good);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "data"), fs::directory_iterator()), 1);
}

TEST_F(CalibrateTool, WritesParametersWithTheirProvenance) {
  ASSERT_EQ(run("attitude flight.csv -o roll.yaml --second-order --recorded 2026-01-02 --strict"), 0)
      << err() << out();
  const YAML::Node yaml = YAML::LoadFile(folder_ / "roll.yaml");
  EXPECT_EQ(yaml["polyfly_calibration"].as<int>(), 1);
  EXPECT_EQ(yaml["data"]["training"]["file"].as<std::string>(), "flight.csv");
  EXPECT_EQ(yaml["data"]["training"]["checksum"].as<std::string>(),
            provenanceOf(folder_ / "flight.csv").checksum);
  EXPECT_EQ(yaml["data"]["training"]["recorded"].as<std::string>(), "2026-01-02");
  const YAML::Node roll = yaml["axes"]["roll"];
  const test::MadeLoop made;
  EXPECT_NEAR(roll["model"]["gain"].as<double>(), made.gain, 0.02);
  EXPECT_NEAR(roll["model"]["tau"].as<double>(), made.tau, 0.01);
  // Holding the command onto the response's rows delays it by up to a row.
  EXPECT_NEAR(roll["model"]["delay"].as<double>(), made.delay, 0.012);
  EXPECT_NEAR(roll["model_without_delay"]["tau"].as<double>(), made.tau + made.delay, 0.02);
  EXPECT_LT(roll["model"]["intervals_95"]["tau"][0].as<double>(), roll["model"]["tau"].as<double>());
  EXPECT_GT(roll["windows"].size(), 0u);
  EXPECT_TRUE(roll["model_second_order"].IsMap());
  EXPECT_EQ(roll["warnings"].size(), 0u);
  EXPECT_NE(out().find("\nroll: gain 1.0"), std::string::npos) << out();
  EXPECT_NE(out().find(", supported ("), std::string::npos) << out();
}

TEST_F(CalibrateTool, ReadsMillisecondsWithDecimalCommas) {
  writeFlight({}, 1, "flight_ms.csv", [](double time) { return std::round(1e3 * (1.6e9 + time)); });
  std::string text = contents(folder_ / "flight_ms.csv").replace(0, 3, "stamp");
  std::replace(text.begin(), text.end(), ',', ';');
  std::replace(text.begin(), text.end(), '.', ',');
  std::ofstream(folder_ / "epoch.csv") << "\xef\xbb\xbf" << text;
  ASSERT_EQ(run("attitude epoch.csv --signal time=stamp:ms -o roll.yaml --report report"), 0) << err();
  EXPECT_NE(out().find("decimal comma"), std::string::npos) << out();
  const YAML::Node yaml = YAML::LoadFile(folder_ / "roll.yaml");
  EXPECT_EQ(yaml["data"]["training"]["recorded"].as<std::string>(), "2020-09-13T12:26:40Z");
  EXPECT_NEAR(yaml["axes"]["roll"]["model"]["gain"].as<double>(), 1.0, 0.03);
  expectPage("report", {"time since 2020-09-13T12:26:40Z [s]", "supported</h2>"});
}

TEST_F(CalibrateTool, WritesAReport) {
  ASSERT_EQ(run("attitude flight.csv --report report --quiet"), 0) << err();
  expectPage("report", {"what was used", "measured and modelled", "validation"});
  EXPECT_TRUE(out().empty());
}

TEST_F(CalibrateTool, CutsAFlightWhereItsClockWasSet) {
  for (const double jump : {1.7e9, 1e11, -3600.0}) {
    writeFlight({}, 1, "set.csv", [jump](double time) { return time < 12.0 ? time : time + jump; });
    ASSERT_EQ(run("attitude set.csv -o roll.yaml --report report"), 0) << jump << err();
    EXPECT_NE(out().find("note: set.csv: roll, roll_cmd: after 11.9"), std::string::npos) << out();
    EXPECT_NE(out().find(jump > 0.0 ? "s the times jump by 1" : "s the times jump by -3599.9"),
              std::string::npos)
        << out();
    expectPage("report", {"set.csv: roll, roll_cmd: after 11.9"});
    const YAML::Node roll = YAML::LoadFile(folder_ / "roll.yaml")["axes"]["roll"];
    EXPECT_NEAR(roll["model"]["gain"].as<double>(), test::MadeLoop().gain, 0.03);
    EXPECT_GT(roll["windows"].size(), 1u);
  }
#ifndef __SANITIZE_ADDRESS__
  constexpr long kMostMemory = 200'000;  // [KiB]
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  EXPECT_LT(used.ru_maxrss, kMostMemory);
#endif
}

TEST_F(CalibrateTool, RefusesTimesThatAreNotInSeconds) {
  writeFlight({}, 1, "micro.csv", [](double time) { return 1e6 * time; });
  for (const std::string window : {"", " --window 0:1e12"}) {
    EXPECT_EQ(run("attitude micro.csv" + window), 2);
    EXPECT_NE(err().find("are the times in seconds?"), std::string::npos) << err();
  }
}

TEST_F(CalibrateTool, FailsWhereAWarningCounts) {
  test::MadeLoop made;
  made.gain = 0.4;
  writeFlight(made, 3, "weak.csv");
  EXPECT_EQ(run("attitude weak.csv"), 0);
  EXPECT_NE(out().find("different scales"), std::string::npos);
  EXPECT_EQ(run("attitude weak.csv --strict"), 1);
}

// At rest, with a steady push of 0.5 m/s^2 that the attitude does not explain.
TEST_F(CalibrateTool, BoundsADisturbance) {
  std::ofstream file(folder_ / "hover.csv");
  file << "t_s,vx_mps,vy_mps,vz_mps,roll_rad,pitch_rad,yaw_rad\n";
  for (int i = 0; i < 3000; ++i) {
    const double time = 0.02 * i;
    file << time << "," << 0.5 * time << "," << 0.001 * ((i * 7919) % 13 - 6) << ",0,0,0,0\n";
  }
  file.close();
  ASSERT_EQ(run("disturbance hover.csv -o bound.yaml --share 0.9"), 0) << err();
  const YAML::Node yaml = YAML::LoadFile(folder_ / "bound.yaml");
  EXPECT_EQ(yaml["disturbances"].size(), 2u);
  EXPECT_EQ(yaml["disturbances"][0]["name"].as<std::string>(), "d_x");
  EXPECT_NEAR(yaml["axes"]["x"]["mean"].as<double>(), 0.5, 1e-6);
  EXPECT_LT(yaml["disturbances"][1]["range"][0].as<double>(), 0.0);
  EXPECT_EQ(run("drag hover.csv --report drag"), 0) << err();
  expectPage("drag", {"What was used", "measured and modelled", "unexplained acceleration along x", "drag_x",
                      "not bounded by these data"});
  EXPECT_EQ(run("disturbance hover.csv --report bound --quiet"), 0) << err();
  expectPage("bound",
             {"What was used", "acceleration along x: measured and modelled", "independent samples"});
  EXPECT_EQ(run("mass hover.csv"), 2);
  EXPECT_NE(err().find("no thrust_cmd"), std::string::npos) << err();
}

TEST_F(CalibrateTool, RefusesBadInputInWords) {
  EXPECT_EQ(run("attitude nowhere.csv"), 2);
  EXPECT_NE(err().find("nowhere.csv: no such file"), std::string::npos) << err();
  EXPECT_EQ(run("attitude flight.csv --window 5"), 2);
  EXPECT_NE(err().find("FROM:TO"), std::string::npos) << err();
  EXPECT_EQ(run("attitude flight.csv --window 900:910"), 2);
  EXPECT_NE(err().find("hold no samples"), std::string::npos) << err();
  EXPECT_EQ(run("attitude flight.csv --signal roll=nowhere"), 2);
  EXPECT_NE(err().find("no column nowhere; there are t_s, roll_cmd_rad, roll_rad"), std::string::npos)
      << err();
  EXPECT_EQ(run("attitude flight.csv --axis wing"), 2);
  EXPECT_EQ(run("attitude flight.csv -o /nowhere/out.yaml"), 2);
  EXPECT_EQ(run(""), 2);
  EXPECT_EQ(run("--help"), 0);
}

}  // namespace
}  // namespace polyfly
