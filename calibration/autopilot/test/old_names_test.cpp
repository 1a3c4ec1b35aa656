// Names and units of fields that autopilots no longer write.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "autopilot/autopilot_signals.hpp"
#include "identification/signal_units.hpp"
#include "made_logs.hpp"

namespace polyfly {
namespace {

// As ArduCopter wrote in 2014: integers, in hundredths of degrees per second.
TEST(OldNames, RatesAreSetByTheGyro) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("polyfly_old_" + std::to_string(getpid()))).string();
  MadeDataflash log;
  log.format(10, "RATE", "Ihh", "TimeMS,YawDes,Yaw", 3 + 4 + 4);
  log.format(11, "IMU", "If", "TimeMS,GyrZ", 3 + 4 + 4);
  constexpr double kCentidegree = 3.14159265358979323846 / 18000.0;
  for (int sample = 0; sample < 1000; ++sample) {
    const double time = 0.02 * sample;
    std::vector<std::uint8_t> rate;
    put(static_cast<std::uint32_t>(20 * sample), &rate);
    put(static_cast<std::int16_t>(std::lround(std::sin(time + 0.1) / kCentidegree)), &rate);
    put(static_cast<std::int16_t>(std::lround(std::sin(time) / kCentidegree)), &rate);
    log.row(10, rate);
    std::vector<std::uint8_t> imu;
    put(static_cast<std::uint32_t>(20 * sample), &imu);
    put(static_cast<float>(std::sin(time)), &imu);
    log.row(11, imu);
  }
  writeBytes(log.bytes, path);
  FlightSignals signals = signalsFromAutopilot(path, {}).signals;
  std::filesystem::remove(path);
  EXPECT_EQ(signals.origin.at("yaw_rate_cmd"), "RATE:YawDes");
  EXPECT_EQ(settleUnits(&signals).size(), 2u);
  for (const std::size_t i : {10u, 400u, 900u}) {
    EXPECT_NEAR(signals.at("yaw_rate").value[i], -std::sin(0.02 * static_cast<double>(i)), 1e-3);
  }
  double greatest = 0.0;
  for (const double value : signals.at("yaw_rate_cmd").value) greatest = std::max(greatest, value);
  EXPECT_NEAR(greatest, 1.0, 1e-3);
}

}  // namespace
}  // namespace polyfly
