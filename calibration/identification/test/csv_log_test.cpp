#include "identification/csv_log.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "identification/flight_signals.hpp"
#include "identification/provenance.hpp"
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
