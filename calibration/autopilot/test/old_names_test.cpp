// Names and units of fields that autopilots no longer write.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "autopilot/autopilot_signals.hpp"
#include "made_logs.hpp"

namespace polyfly {
namespace {

using RowWriter = std::function<void(double, std::vector<std::uint8_t>*)>;

constexpr double kCentidegree = 3.14159265358979323846 / 18000.0;

// A yaw rate of 1 rad/s at most, in hundredths of degrees, beside a gyro in radians.
AutopilotSignals rates(const std::string& letters, const std::string& names, const RowWriter& row) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("polyfly_old_" + std::to_string(getpid()))).string();
  MadeDataflash log;
  log.format(10, "RATE", letters, names, letters == "Ihh" ? 3 + 4 + 4 : 3 + 4 + 8);
  log.format(11, "IMU", "If", "TimeMS,GyrZ", 3 + 4 + 4);
  for (int sample = 0; sample < 1000; ++sample) {
    const double time = 0.02 * sample;
    std::vector<std::uint8_t> rate;
    put(static_cast<std::uint32_t>(20 * sample), &rate);
    row(std::sin(time + 0.1) / kCentidegree, &rate);
    row(std::sin(time) / kCentidegree, &rate);
    log.row(10, rate);
    std::vector<std::uint8_t> imu;
    put(static_cast<std::uint32_t>(20 * sample), &imu);
    put(static_cast<float>(std::sin(time)), &imu);
    log.row(11, imu);
  }
  writeBytes(log.bytes, path);
  AutopilotSignals log_signals = signalsFromAutopilot(path, {});
  std::filesystem::remove(path);
  return log_signals;
}

void expectRadians(const FlightSignals& signals) {
  for (const std::size_t i : {10u, 400u, 900u}) {
    EXPECT_NEAR(signals.at("yaw_rate").value[i], -std::sin(0.02 * static_cast<double>(i)), 1e-3);
  }
  double greatest = 0.0;
  for (const double value : signals.at("yaw_rate_cmd").value) greatest = std::max(greatest, value);
  EXPECT_NEAR(greatest, 1.0, 1e-3);
}

// As ArduCopter wrote in 2014: integers, in hundredths of degrees per second.
TEST(OldNames, RatesAreHundredthsOfDegrees) {
  const FlightSignals signals = rates("Ihh", "TimeMS,YawDes,Yaw", [](double value, auto* row) {
                                  put(static_cast<std::int16_t>(std::lround(value)), row);
                                }).signals;
  EXPECT_EQ(signals.origin.at("yaw_rate_cmd"), "-RATE:YawDes:cdeg");
  expectRadians(signals);
}

// As ArduCopter 3.3 wrote: today's names, hundredths of degrees still.
TEST(OldNames, RatesUnderNewNamesAreSetByTheGyro) {
  const AutopilotSignals old =
      rates("Iff", "TimeMS,YDes,Y", [](double value, auto* row) { put(static_cast<float>(value), row); });
  expectRadians(old.signals);
  ASSERT_FALSE(old.remarks.empty());
  EXPECT_NE(old.remarks.back().find("hundredths of degrees"), std::string::npos);
  expectRadians(rates("Iff", "TimeMS,YDes,Y", [](double value, auto* row) {
                  put(static_cast<float>(0.01 * value), row);
                }).signals);
}

}  // namespace
}  // namespace polyfly
