// Runs the command-line tool `calibrate`.

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <sstream>

#include "identification/provenance.hpp"
#include "made_flight.hpp"
#include "made_logs.hpp"
#include "made_stretches.hpp"
#include "made_thrust.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class CalibrateTool : public testing::Test {
 protected:
  CalibrateTool() : folder_(fs::path(testing::TempDir()) / ("calibrate_tool_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
    writeFlight({}, 1, "flight.csv");
  }
  ~CalibrateTool() override { fs::remove_all(folder_); }

  // Roll of a made flight, with the command held onto the rows of the response; `clock` gives their times.
  void writeFlight(
      const test::MadeLoop& made, std::uint32_t seed, const std::string& name,
      const std::function<double(double)>& clock = [](double time) { return time; }) {
    const LoopRecord record = test::makeFlight(made, seed);
    std::ofstream file(folder_ / name);
    file.precision(14);
    file << "t_s,roll_cmd_rad,roll_rad\n";
    std::size_t held = 0;
    for (std::size_t i = 0; i < record.response.time.size(); ++i) {
      const auto& command = record.command;
      while (held + 1 < command.time.size() && command.time[held + 1] <= record.response.time[i]) ++held;
      file << clock(record.response.time[i]) << "," << command.value[held] << "," << record.response.value[i]
           << "\n";
    }
  }

  // The signals of a made flight with stretches.
  void writeStretches(const FlightSignals& signals, const std::string& name) {
    const std::pair<const char*, const char*> columns[] = {{"roll_cmd", "roll_cmd_rad"},
                                                           {"pitch_cmd", "pitch_cmd_rad"},
                                                           {"roll", "roll_rad"},
                                                           {"pitch", "pitch_rad"},
                                                           {"yaw", "yaw_rad"},
                                                           {"vx", "vx_mps"},
                                                           {"vy", "vy_mps"},
                                                           {"vz", "vz_mps"},
                                                           {"thrust_cmd", "thrust_cmd"}};
    std::ofstream file(folder_ / name);
    file << "t_s";
    for (const auto& [signal, column] : columns) file << "," << column;
    for (std::size_t i = 0; i < signals.at("roll").time.size(); ++i) {
      file << "\n" << signals.at("roll").time[i];
      for (const auto& [signal, column] : columns) file << "," << signals.at(signal).value[i];
    }
  }

  // A made flight of a thrust curve; the voltage is held onto the rows of the others.
  void writeThrust(const test::MadeThrust& made, std::uint32_t seed, const std::string& name) {
    const FlightSignals signals = test::makeThrustFlight(made, seed);
    std::ofstream file(folder_ / name);
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

  int run(const std::string& arguments, const std::string& before = "") {
    const std::string line = std::string("cd ") + folder_.string() + " && " + before + CALIBRATE_PROGRAM +
                             " " + arguments + " > out.txt 2> err.txt";
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string out() const { return contents(folder_ / "out.txt"); }
  std::string err() const { return contents(folder_ / "err.txt"); }
  void expectPage(const std::string& report, const std::vector<std::string>& all_words) const {
    const std::string page = contents(folder_ / report / "index.html");
    for (const std::string& words : all_words) EXPECT_NE(page.find(words), std::string::npos) << words;
    EXPECT_NE(page.find("<svg"), std::string::npos);
    EXPECT_TRUE(fs::exists(folder_ / report / "calibration.yaml"));
  }

  fs::path folder_;
};

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
    ASSERT_EQ(run("attitude " + name + " -o loop.yaml"), 0) << err() << out();
    const YAML::Node roll = YAML::LoadFile(folder_ / "loop.yaml")["axes"]["roll"];
    EXPECT_NEAR(roll["model_without_delay"]["gain"].as<double>(), 0.93, 0.01);
    EXPECT_NEAR(roll["model_without_delay"]["tau"].as<double>(), 0.21, 0.01);
  }
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
        "attitude flight.csv -o fresh/index.html --report fresh", "wind flight.csv -o flight.csv",
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
  ASSERT_EQ(run("attitude flight.csv -o roll.yaml --recorded 2026-01-02 --strict"), 0) << err() << out();
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
  EXPECT_GT(roll["with_delay"]["parameters"]["tau"]["standard_error"].as<double>(), 0.0);
  EXPECT_EQ(roll["with_delay"]["correlation"].size(), 4u);
  EXPECT_GT(roll["windows"].size(), 0u);
  EXPECT_TRUE(roll["second_order"].IsMap());
  EXPECT_EQ(roll["warnings"].size(), 0u);
  EXPECT_NE(out().find("lag and delay"), std::string::npos);
}

TEST_F(CalibrateTool, ReadsMillisecondsWithDecimalCommas) {
  writeFlight({}, 1, "flight_ms.csv", [](double time) { return std::round(1e3 * (1.6e9 + time)); });
  std::string text = contents(folder_ / "flight_ms.csv").replace(0, 3, "stamp");
  std::replace(text.begin(), text.end(), ',', ';');
  std::replace(text.begin(), text.end(), '.', ',');
  std::ofstream(folder_ / "epoch.csv") << "\xef\xbb\xbf" << text;
  ASSERT_EQ(run("attitude epoch.csv -o roll.yaml --report report"), 0) << err();
  EXPECT_NE(out().find("column stamp are taken as milliseconds"), std::string::npos) << out();
  EXPECT_NE(out().find("decimal comma"), std::string::npos) << out();
  const YAML::Node yaml = YAML::LoadFile(folder_ / "roll.yaml");
  EXPECT_EQ(yaml["data"]["training"]["recorded"].as<std::string>(), "2020-09-13T12:26:40Z");
  EXPECT_NEAR(yaml["axes"]["roll"]["model"]["gain"].as<double>(), 1.0, 0.03);
  expectPage("report", {"time since 2020-09-13T12:26:40Z [s]", "supported</span>"});
}

// What is no flight stands in text, YAML and page, for every command that reads flights.
TEST_F(CalibrateTool, LeavesATumbleOutAndSaysSo) {
  test::MadeStretches made;
  made.tumbles = 4.0;
  writeStretches(test::makeStretches(made, 1).signals, "tumble.csv");
  for (const std::string command : {"attitude", "disturbance --mass 1.5", "drag", "mass"}) {
    ASSERT_EQ(run(command + " tumble.csv -o out.yaml --report page"), 0) << err();
    EXPECT_NE(out().find("s: upset, not commanded (tilt up to"), std::string::npos) << command << "\n"
                                                                                    << out();
    EXPECT_NE(contents(folder_ / "out.yaml").find("upset, not commanded"), std::string::npos) << command;
    EXPECT_NE(contents(folder_ / "page/index.html").find("upset, not commanded"), std::string::npos)
        << command;
    fs::remove_all(folder_ / "page");
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
  ASSERT_EQ(run("attitude tumble.csv"), 0);
  EXPECT_NE(out().find("yaw_rate is not identified: the log has no yaw_rate_cmd and no yaw_rate"),
            std::string::npos)
      << out();
}

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
  const std::string config = std::string(SOURCE_FOLDER) + "/launch/config/";
  ASSERT_EQ(run("apply roll.yaml --options " + config + "firefly.yaml -o firefly.yaml"), 0) << err();
  const YAML::Node options = YAML::LoadFile(folder_ / "firefly.yaml");
  EXPECT_NEAR(options["nonlinear"]["roll_time"].as<double>(), model["tau"].as<double>(), 1e-6);
  EXPECT_NEAR(options["nonlinear"]["roll_gain"].as<double>(), model["gain"].as<double>(), 1e-6);
  EXPECT_NE(options["provenance"].as<std::string>().find("flight.csv"), std::string::npos);
  // The same flight of a fixed wing goes into neither.
  EXPECT_EQ(run("apply roll.yaml --options " + config + "techpod.yaml -o techpod.yaml"), 2);
  EXPECT_NE(err().find("vehicle.kind: must be fixed_wing"), std::string::npos) << err();
  EXPECT_EQ(run("apply roll.yaml -o x.yaml"), 2);
  EXPECT_EQ(run("apply roll.yaml --problem " + problem + " --options " + config + "firefly.yaml -o x.yaml"),
            2);
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
  const std::string config = std::string(SOURCE_FOLDER) + "/launch/config/techpod.yaml";
  ASSERT_EQ(run("apply roll.yaml --options " + config + " -o techpod.yaml"), 0) << err();
  const YAML::Node options = YAML::LoadFile(folder_ / "techpod.yaml")["model"];
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
    for (const std::string kind : {"drag", "mass", "wind", "heading", "disturbance"}) {
      if (logs.size() > 10 && (kind == "wind" || kind == "heading")) continue;
      ASSERT_EQ(run(kind + logs + " -o " + kind + ".yaml --quiet"), 0) << err();
      run("apply " + kind + ".yaml --problem " + source +
          "/region_maps/problems/multirotor_lateral.yaml -o out.yaml");
      EXPECT_NE(err().find("vehicle.kind: must be multirotor"), std::string::npos) << kind << logs << err();
    }
  }
  for (const std::string logs : {" flight.csv --validation flight.csv", " flight.csv b.csv c.csv"}) {
    ASSERT_EQ(run("attitude" + logs + " -o attitude.yaml --quiet"), 0) << err();
    EXPECT_EQ(run("apply attitude.yaml --options " + source + "/launch/config/firefly.yaml -o o.yaml"), 0)
        << logs << err();
  }
  EXPECT_NE(contents(folder_ / "o.yaml").find("b.csv"), std::string::npos);
}

// From flights to the options of a node, which say where the curve holds.
TEST_F(CalibrateTool, AThrustCurveGoesIntoTheOptions) {
  test::MadeThrust made;
  made.duration = 30.0;
  writeThrust(made, 1, "one.csv");
  writeThrust(made, 2, "two.csv");
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
  writeThrust(made, 3, "calm.csv");
  EXPECT_EQ(run("thrust calm.csv --mass 1.5 -o thrust.yaml --strict"), 1);
  EXPECT_EQ(run("apply thrust.yaml --options " + firefly + " -o o.yaml"), 2);
  EXPECT_NE(err().find("Too little excitation"), std::string::npos) << err();
  EXPECT_EQ(run("thrust one.csv"), 2);
  EXPECT_EQ(run("thrust one.csv --mass 1.5 --degree 4"), 2);
}

// The wing of the flights above, and a flight that is slow.
TEST_F(CalibrateTool, RefusesFlightsOfTwoKindsOfVehicle) {
  for (const double speed : {2.0, 15.0}) {
    std::ofstream file(folder_ / (speed < 10.0 ? "slow.csv" : "fast.csv"));
    file << "t_s,vx_mps,vy_mps,vz_mps,roll_rad,pitch_rad,yaw_rad\n";
    for (int i = 0; i < 1200; ++i) {
      const double course = 0.01 * i;
      file << 0.05 * i << "," << speed * std::cos(course) << "," << speed * std::sin(course)
           << ",0,0.01,0.02," << course << "\n";
    }
  }
  EXPECT_EQ(run("drag slow.csv fast.csv -o drag.yaml"), 2);
  EXPECT_NE(err().find("fast.csv: the vehicle is a fixed_wing"), std::string::npos) << err();
  EXPECT_NE(err().find("that of slow.csv a multirotor"), std::string::npos) << err();
  ASSERT_EQ(run("drag slow.csv fast.csv --vehicle multirotor -o drag.yaml"), 0) << err();
  EXPECT_EQ(YAML::LoadFile(folder_ / "drag.yaml")["vehicle"]["kind"].as<std::string>(), "multirotor");
  // A flight that does not tell leaves it to the others.
  ASSERT_EQ(run("attitude flight.csv slow.csv -o roll.yaml"), 0) << err();
  EXPECT_NE(out().find("slow.csv: roll is not identified: the log has no roll_cmd"), std::string::npos)
      << out();
  EXPECT_EQ(YAML::LoadFile(folder_ / "roll.yaml")["vehicle"]["kind"].as<std::string>(), "multirotor");
  EXPECT_EQ(run("heading slow.csv fast.csv --vehicle multirotor"), 2);
  EXPECT_NE(err().find("heading: takes one log"), std::string::npos) << err();
}

TEST_F(CalibrateTool, WritesAReport) {
  ASSERT_EQ(run("attitude flight.csv --report report --quiet"), 0) << err();
  expectPage("report", {"what was used", "measured and modelled", "validation", "frequency response"});
  EXPECT_TRUE(out().empty());
}

TEST_F(CalibrateTool, TakesAnotherFlightForValidation) {
  writeFlight({}, 2, "other.csv");
  ASSERT_EQ(run("attitude flight.csv --validation other.csv -o roll.yaml"), 0) << err();
  const YAML::Node yaml = YAML::LoadFile(folder_ / "roll.yaml");
  EXPECT_EQ(yaml["data"]["validation"]["file"].as<std::string>(), "other.csv");
  EXPECT_FALSE(yaml["axes"]["roll"]["validation"]["by_halves"].as<bool>());
  EXPECT_GT(yaml["axes"]["roll"]["validation"]["validation_percent"].as<double>(), 90.0);
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
  EXPECT_EQ(roll["interval_holds_for"].as<std::string>(), "the vehicle, between flights");
  ASSERT_EQ(roll["flights"].size(), 3u);
  EXPECT_EQ(roll["flights"][2]["file"].as<std::string>(), "c.csv");
  EXPECT_GT(roll["flights"][0]["validation_percent"].as<double>(), 80.0);
  EXPECT_TRUE(roll["validation"]["by_flights"].as<bool>());
  const YAML::Node gain = roll["with_delay"]["parameters"]["gain"];
  EXPECT_NEAR(gain["value"].as<double>(), 1.0, 0.02);
  EXPECT_NEAR(gain["between_flights"].as<double>(), 0.1, 0.02);
  EXPECT_NEAR(gain["interval_95"][1].as<double>() - gain["value"].as<double>(), 4.3027 * 0.1 / std::sqrt(3.0),
              0.05);
  EXPECT_NE(out().find("the intervals hold the spread between 3 flights"), std::string::npos) << out();
  expectPage("report", {"flight.csv", "c.csv", "What each flight says", "by the others' model"});
  ASSERT_EQ(run("attitude flight.csv -o roll.yaml"), 0) << err();
  EXPECT_NE(out().find("hold for this flight alone"), std::string::npos) << out();
  EXPECT_EQ(YAML::LoadFile(folder_ / "roll.yaml")["axes"]["roll"]["interval_holds_for"].as<std::string>(),
            "this flight alone");
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
  EXPECT_EQ(yaml["interval_holds_for"].as<std::string>(), "the vehicle, between flights");
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
  EXPECT_EQ(run("wind flight.csv still.csv"), 2);
  EXPECT_NE(err().find("takes one log"), std::string::npos) << err();
  EXPECT_EQ(run("attitude flight.csv still.csv --window 3:1:2"), 2);
  EXPECT_NE(err().find("must be that of a log, 1 to 2"), std::string::npos) << err();
  EXPECT_EQ(run("attitude flight.csv still.csv -o still.csv"), 2);
  ASSERT_EQ(run("attitude flight.csv still.csv -o roll.yaml --strict"), 1) << err();
  EXPECT_NE(out().find("Left out: still.csv: roll: "), std::string::npos) << out();
  EXPECT_NE(out().find("hold for this flight alone"), std::string::npos) << out();
  // Each flight with a window of its own.
  writeFlight({}, 2, "b.csv");
  ASSERT_EQ(run("attitude flight.csv b.csv --window 1:2:20 --window 2:5:28 -o roll.yaml"), 0) << err();
  const YAML::Node flights = YAML::LoadFile(folder_ / "roll.yaml")["axes"]["roll"]["flights"];
  EXPECT_EQ(flights[0]["windows"][0][1].as<double>(), 20.0);
  EXPECT_EQ(flights[1]["windows"][0][0].as<double>(), 5.0);
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

// Circles at 15 m/s in a wind of 4 m/s to the north.
TEST_F(CalibrateTool, FindsTheWind) {
  std::ofstream file(folder_ / "circles.csv");
  file << "t_s,vn_mps,ve_mps,tas_mps\n";
  for (int i = 0; i < 600; ++i) {
    const double course = 0.05 * i;
    file << 0.1 * i << "," << 15.0 * std::cos(course) + 4.0 << "," << 15.0 * std::sin(course) << ","
         << 15.0 + 0.1 * (i % 3) << "\n";
  }
  file.close();
  ASSERT_EQ(run("wind circles.csv -o wind.yaml --report wind --strict"), 0) << err() << out();
  expectPage("wind", {"What was used", "The wind triangle", "measured and modelled", "distribution",
                      "airspeed_scale", "The data support these numbers"});
  const YAML::Node yaml = YAML::LoadFile(folder_ / "wind.yaml");
  EXPECT_EQ(yaml["kind"].as<std::string>(), "wind");
  EXPECT_NEAR(yaml["parameters"]["wind_north"]["value"].as<double>(), 4.0, 0.1);
  EXPECT_NEAR(yaml["parameters"]["wind_east"]["value"].as<double>(), 0.0, 0.1);
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
  expectPage("drag", {"What was used", "measured and modelled", "velocity along x", "drag_x",
                      "not bounded by these data"});
  EXPECT_EQ(run("disturbance hover.csv --report bound --quiet"), 0) << err();
  expectPage("bound", {"What was used", "acceleration along x: measured and modelled", "Quantiles",
                       "independent samples"});
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
