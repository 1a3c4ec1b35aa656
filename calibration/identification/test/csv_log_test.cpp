#include "identification/csv_log.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "identification/calibration_file.hpp"
#include "identification/flight_signals.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

class CsvFile : public testing::Test {
 protected:
  CsvFile() : path_(testing::TempDir() + "csv_log_test_" + std::to_string(::getpid()) + ".csv") {}
  ~CsvFile() override { std::filesystem::remove(path_); }

  CsvLog read(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return readCsv(path_);
  }
  std::string errorOf(const std::string& text) {
    try {
      read(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  std::string path_;
};

TEST_F(CsvFile, ReadsNumbersGapsAndComments) {
  const CsvLog log = read("# a comment\nt_s; roll_rad\r\n0.0;1e-3\r\n+0.5;\r\n\r\n1.0;abc\r\n");
  EXPECT_EQ(log.rows, 3u);
  EXPECT_EQ(log.names, (std::vector<std::string>{"t_s", "roll_rad"}));
  EXPECT_DOUBLE_EQ(log.column("t_s")[1], 0.5);
  EXPECT_TRUE(std::isnan(log.column("roll_rad")[1]));
  EXPECT_TRUE(std::isnan(log.column("roll_rad")[2]));
  EXPECT_EQ(log.unreadable, 1u);
}

TEST_F(CsvFile, LeavesOutARowThatWasCutOff) {
  const CsvLog log = read("t_s,a,b\n0,1,2\n1,3\n");
  EXPECT_EQ(log.rows, 1u);
  EXPECT_EQ(log.cut_rows, 1u);
}

TEST_F(CsvFile, RefusesWithFileAndRule) {
  EXPECT_NE(errorOf("").find(": is empty"), std::string::npos);
  EXPECT_NE(errorOf("t_s,a\n").find(": has no row"), std::string::npos);
  EXPECT_NE(errorOf("t_s,t_s\n1,2\n").find("two columns are called t_s"), std::string::npos);
  EXPECT_NE(errorOf("t_s,\n1,2\n").find("column 2 has no name"), std::string::npos);
  EXPECT_NE(errorOf("t_s\n1,2\n").find("row 2"), std::string::npos);
  EXPECT_THROW(readCsv("/nowhere/at/all.csv"), Error);
  EXPECT_THROW(readCsv("/"), Error);
}

TEST_F(CsvFile, FindsSignalsAndTurnsDegrees) {
  const CsvLog log = read(
      "t_s,cmd_t_s,roll_cmd_deg,roll_imu_deg,gz_radps,vd_mps,other\n"
      "0,0,90,45,0.1,2,1\n0.1,0,90,45,0.1,2,1\n0.2,0.15,0,45,0.1,2,1\n");
  const FlightSignals signals = signalsFromCsv(log, {{"pitch", "other"}});
  EXPECT_NEAR(signals.at("roll").value[0], std::acos(-1.0) / 4.0, 1e-12);
  EXPECT_EQ(signals.at("roll_cmd").time, (std::vector<double>{0.0, 0.15}));
  EXPECT_DOUBLE_EQ(signals.at("vz").value[0], -2.0);
  EXPECT_DOUBLE_EQ(signals.at("pitch").value[0], 1.0);
  EXPECT_DOUBLE_EQ(signalsFromCsv(log, {{"pitch", "-other"}}).at("pitch").value[0], -1.0);
  EXPECT_EQ(recordedAxes(signals), (std::vector<std::string>{"roll"}));
  EXPECT_NEAR(signalsFromCsv(log, {{"pitch", "-other:deg"}}).at("pitch").value[0], -std::acos(-1.0) / 180.0,
              1e-12);
  const std::vector<std::string> missing = missingAxes(signals);
  ASSERT_EQ(missing.size(), 4u);
  EXPECT_EQ(missing[0], "pitch is not identified: the log has no pitch_cmd");
  EXPECT_EQ(missing[1], "yaw_rate is not identified: the log has no yaw_rate_cmd");
  EXPECT_NE(missing[3].find("the log has t_s, cmd_t_s, roll_cmd_deg"), std::string::npos) << missing[3];
  EXPECT_THROW(signals.at("yaw"), Error);
  EXPECT_THROW(signalsFromCsv(log, {{"nonsense", "other"}}), Error);
  EXPECT_THROW(signalsFromCsv(log, {{"pitch", "nonsense"}}), Error);
}

TEST_F(CsvFile, PassesAByteOrderMark) {
  EXPECT_EQ(read("\xef\xbb\xbft_s,a\n1,2\n").names.front(), "t_s");
  EXPECT_EQ(read("t_s,a\n1,2\n").names.front(), "t_s");
  EXPECT_EQ(read("a\n1\n").names.front(), "a");
  EXPECT_NE(errorOf(std::string("\xff\xfet\0_\0", 6)).find(": is UTF-16; save it as UTF-8"),
            std::string::npos);
}

TEST_F(CsvFile, ReadsDecimalCommasBetweenOtherSeparators) {
  const CsvLog log = read("t_s;roll_rad\n0,02;-1,5e-3\n0,04;2\n");
  EXPECT_TRUE(log.decimal_comma);
  EXPECT_DOUBLE_EQ(log.column("t_s")[0], 0.02);
  EXPECT_DOUBLE_EQ(log.column("roll_rad")[0], -1.5e-3);
  EXPECT_EQ(signalsFromCsv(log, {}).remarks, (std::vector<std::string>{"its numbers have a decimal comma"}));
  // More than one comma is no number.
  EXPECT_EQ(read("t_s;roll_rad\n0,02;1,234,5\n").unreadable, 1u);
  EXPECT_FALSE(read("t_s;roll_rad\n0.02;1\n").decimal_comma);
  EXPECT_NE(errorOf("t_s,roll_rad\n0,02,1,5\n").find("decimal commas"), std::string::npos);
}

TEST_F(CsvFile, BindsTheColumnOfTimes) {
  const CsvLog log =
      read("Stamp,secs,nsecs,roll_rad\n1000,7,250000000,1\n1020,7,270000000,2\n1040,7,290000000,3\n");
  EXPECT_DOUBLE_EQ(signalsFromCsv(log, {{"time", "Stamp:ms"}}).at("roll").time[1], 1.02);
  EXPECT_DOUBLE_EQ(signalsFromCsv(log, {{"time", "Stamp"}}).at("roll").time[1], 1020.0);
  EXPECT_THROW(signalsFromCsv(log, {{"time", "Stamp:min"}}), Error);
  const FlightSignals pair = signalsFromCsv(log, {{"time", "secs,nsecs"}});
  EXPECT_NEAR(pair.at("roll").time[1], 7.27, 1e-12);
  EXPECT_TRUE(pair.remarks.empty());
  EXPECT_THROW(signalsFromCsv(log, {{"time", "secs,none"}}), Error);
  EXPECT_THROW(signalsFromCsv(log, {{"time", "none"}}), Error);
  try {
    signalsFromCsv(log, {});
    FAIL() << "no column of times was needed";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("--signal time=COLUMN"), std::string::npos) << error.what();
  }
}

TEST_F(CsvFile, FindsTimesByNameAndUnit) {
  for (const auto& [name, units] : std::vector<std::pair<std::string, double>>{
           {"t_ms", 1e3}, {"time_us", 1e6}, {"timestamp_ns", 1e9}, {"stamp", 1.0}}) {
    std::string text = name + ",roll_rad\n";
    for (int i = 0; i < 5; ++i) text += std::to_string(std::llround(units * (1000.0 + i))) + ",1\n";
    const FlightSignals signals = signalsFromCsv(read(text), {});
    EXPECT_NEAR(signals.at("roll").time[0], 1000.0, 1e-6) << name;
    EXPECT_NEAR(signals.at("roll").time[1], 1001.0, 1e-6) << name;
  }
  EXPECT_DOUBLE_EQ(signalsFromCsv(read("t,roll_rad\n5,1\n5.1,1\n"), {}).at("roll").time[1], 5.1);
}

TEST_F(CsvFile, BindsTheTimesOfCommands) {
  const CsvLog log = read("t_s,sent_ms,roll_cmd_rad,roll_rad\n0,5,1,0\n0.02,25,2,0\n");
  const FlightSignals signals = signalsFromCsv(log, {{"cmd_time", "sent_ms"}});
  EXPECT_EQ(signals.at("roll_cmd").time, (std::vector<double>{0.005, 0.025}));
  EXPECT_EQ(signals.at("roll").time, (std::vector<double>{0.0, 0.02}));
}

// xxh64 of the empty input and of "a", from the specification's reference programs.
TEST_F(CsvFile, ChecksumIsThatOfTheBytes) {
  std::ofstream(path_, std::ios::binary) << "";
  EXPECT_EQ(provenanceOf(path_).checksum, "xxh64:ef46db3751d8e999");
  std::ofstream(path_, std::ios::binary) << "a";
  EXPECT_EQ(provenanceOf(path_).checksum, "xxh64:d24ec4f1a98c6e5b");
  EXPECT_THROW(provenanceOf("/nowhere/at/all"), Error);
}

}  // namespace
}  // namespace polyfly
