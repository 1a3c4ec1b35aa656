#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "autopilot/autopilot_signals.hpp"
#include "made_logs.hpp"

namespace polyfly {
namespace {

class LoggedVehicle : public testing::Test {
 protected:
  LoggedVehicle() {
    path_ =
        (std::filesystem::temp_directory_path() / ("polyfly_vehicle_" + std::to_string(getpid()))).string();
  }
  ~LoggedVehicle() override { std::filesystem::remove(path_); }

  std::string path_;
};

TEST_F(LoggedVehicle, px4NamesItsKindOfVehicleInItsStatus) {
  struct Case {
    std::string field;
    std::vector<std::uint8_t> values;
    std::string kind;
  };
  for (const Case& one :
       {Case{"vehicle_type", {1, 1}, "multirotor"}, Case{"vehicle_type", {2, 2}, "fixed_wing"},
        Case{"vehicle_type", {1, 2}, "unknown"}, Case{"is_rotary_wing", {1, 1}, "multirotor"},
        Case{"is_rotary_wing", {0, 0}, "fixed_wing"}, Case{"armed", {1, 1}, "unknown"}}) {
    MadeULog log;
    log.flags(0);
    log.format("vehicle_attitude:uint64_t timestamp;float[4] q;");
    log.format("vehicle_status:uint64_t timestamp;uint8_t " + one.field + ";");
    log.subscribe(0, 1, "vehicle_attitude");
    log.subscribe(0, 2, "vehicle_status");
    for (std::size_t i = 0; i < one.values.size(); ++i) {
      std::vector<std::uint8_t> row;
      put<std::uint64_t>(1000000 + 10000 * i, &row);
      std::vector<std::uint8_t> attitude = row;
      for (const float part : {1.0F, 0.0F, 0.0F, 0.0F}) put(part, &attitude);
      log.data(1, attitude);
      row.push_back(one.values[i]);
      log.data(2, row);
    }
    writeBytes(log.bytes, path_);
    EXPECT_EQ(signalsFromAutopilot(path_, {}).signals.vehicle.name, one.kind) << one.field;
  }
}

TEST_F(LoggedVehicle, arduPilotTellsItsKindOfVehicleByItsMessages) {
  for (const auto& [name, kind] : std::vector<std::pair<std::string, std::string>>{
           {"TECS", "fixed_wing"}, {"AETR", "fixed_wing"}, {"MOTB", "multirotor"}, {"BARO", "unknown"}}) {
    MadeDataflash log = madeArduPilotFlight(1.0, 0.2);
    log.format(11, name, "Qf", "TimeUS,A", 3 + 8 + 4);
    std::vector<std::uint8_t> row;
    put<std::uint64_t>(7000000, &row);
    put(1.0F, &row);
    log.row(11, row);
    writeBytes(log.bytes, path_);
    EXPECT_EQ(signalsFromAutopilot(path_, {}).signals.vehicle.name, kind) << name;
  }
}

}  // namespace
}  // namespace polyfly
