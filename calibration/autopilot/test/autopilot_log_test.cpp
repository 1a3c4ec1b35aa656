#include "autopilot/autopilot_log.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <random>
#include <utility>

#include "autopilot/autopilot_signals.hpp"
#include "identification/identify_axis.hpp"
#include "made_logs.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

class AutopilotLogs : public testing::Test {
 protected:
  AutopilotLogs() {
    path_ = (std::filesystem::temp_directory_path() / ("polyfly_log_" + std::to_string(getpid()))).string();
  }
  ~AutopilotLogs() override { std::filesystem::remove(path_); }

  AutopilotLog read(const std::vector<std::uint8_t>& bytes) {
    writeBytes(bytes, path_);
    return isULog(path_) ? readULog(path_) : readDataflash(path_);
  }
  // Reads what may be damaged: an Error, which gives nothing, is an answer, anything else is not.
  std::optional<AutopilotLog> readDamaged(const std::vector<std::uint8_t>& bytes, bool ulog) {
    std::filesystem::remove(path_);  // a file that is cut to nothing and written again waits for the disk
    writeBytes(bytes, path_);
    try {
      AutopilotLog log = ulog ? readULog(path_) : readDataflash(path_);
      for (const auto& [name, table] : log.tables) {
        for (const auto& [field, column] : table.column) EXPECT_EQ(column.size(), table.time.size());
      }
      return log;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(path_), std::string::npos);
      return std::nullopt;
    }
  }
  std::string path_;
};

MadeULog smallULog() {
  MadeULog log;
  log.flags(1);
  log.format("part:int16_t a;uint8_t[2] b;");
  log.format(
      "thing:uint64_t timestamp;float x;part[2] parts;char[4] text;bool on;uint8_t[3] _padding0;double y;");
  log.format("other:uint64_t timestamp;int8_t v;");
  log.message('I', {1, 'x'});
  log.subscribe(0, 3, "thing");
  log.subscribe(1, 4, "other");
  for (int row = 0; row < 3; ++row) {
    std::vector<std::uint8_t> bytes;
    put<std::uint64_t>(std::uint64_t{2000000} + 500000U * static_cast<std::uint64_t>(row), &bytes);
    put(1.5F * static_cast<float>(row), &bytes);
    for (int part = 0; part < 2; ++part) {
      put(static_cast<std::int16_t>(-100 * part - row), &bytes);
      bytes.insert(bytes.end(), {7, static_cast<std::uint8_t>(8 + part)});
    }
    bytes.insert(bytes.end(), {'a', 'b', 'c', 'd', 1, 0, 0, 0});
    put(0.25 * row, &bytes);
    log.data(3, bytes);
  }
  std::vector<std::uint8_t> other;
  put<std::uint64_t>(9000000, &other);
  other.push_back(static_cast<std::uint8_t>(-5));
  log.data(4, other);
  return log;
}

TEST_F(AutopilotLogs, uLogGivesEveryNumberByItsField) {
  const AutopilotLog log = read(smallULog().bytes);
  const LogTable& thing = log.tables.at("thing");
  EXPECT_EQ(thing.time, (std::vector<double>{2.0, 2.5, 3.0}));
  EXPECT_EQ(thing.column.at("x"), (std::vector<double>{0.0, 1.5, 3.0}));
  EXPECT_EQ(thing.column.at("parts[1].a"), (std::vector<double>{-100.0, -101.0, -102.0}));
  EXPECT_EQ(thing.column.at("parts[1].b[1]"), (std::vector<double>{9.0, 9.0, 9.0}));
  EXPECT_EQ(thing.column.at("y"), (std::vector<double>{0.0, 0.25, 0.5}));
  EXPECT_FALSE(thing.has("text[0]"));
  EXPECT_EQ(log.tables.at("other[1]").column.at("v"), (std::vector<double>{-5.0}));
  EXPECT_EQ(log.counts.at("thing"), 3u);
  EXPECT_TRUE(log.remarks.empty());
}

TEST_F(AutopilotLogs, uLogTellsWhatIsMissing) {
  MadeULog log = smallULog();
  log.dropout(40);
  log.data(99, {1, 2, 3});
  log.data(3, {1, 2, 3});
  log.bytes.insert(log.bytes.end(), {200, 0, 'D', 1});
  const AutopilotLog read_back = read(log.bytes);
  ASSERT_EQ(read_back.remarks.size(), 4u);
  EXPECT_EQ(read_back.remarks[0], "the last message was cut off");
  EXPECT_EQ(read_back.remarks[1], "40 ms of messages were lost while logging");
  EXPECT_EQ(read_back.remarks[2].substr(0, 10), "1 messages");
  EXPECT_EQ(read_back.remarks[3].substr(0, 15), "1 data messages");
  EXPECT_EQ(read_back.tables.at("thing").time.size(), 3u);
}

TEST_F(AutopilotLogs, refusesWhatItCannotRead) {
  MadeULog flags;
  flags.flags(2);
  EXPECT_THROW(read(flags.bytes), Error);
  EXPECT_THROW(read(MadeULog().bytes), Error);  // nothing in it
  EXPECT_THROW(read({}), Error);
  EXPECT_THROW(read({1, 2, 3, 4}), Error);
  EXPECT_THROW(readULog("/nowhere/log.ulg"), Error);
}

TEST_F(AutopilotLogs, formatsThatMultiplyEndAtOnce) {
  MadeULog log = smallULog();
  log.format("a:b[4096] x;");
  log.format("b:c[4096] x;");
  log.format("c:d[4096] x;");
  log.format("d:char[1] x;");
  log.format("bomb:uint64_t timestamp;a[4096] x;uint8_t y;");
  log.format("loop:uint64_t timestamp;loop x;");
  log.subscribe(0, 8, "bomb");
  log.subscribe(0, 9, "loop");
  EXPECT_EQ(read(log.bytes).remarks.size(), 1u);
}

MadeDataflash smallDataflash() {
  MadeDataflash log;
  log.format(20, "IMU", "QBfffZ", "TimeUS,I,AccX,AccY,AccZ,Note", 3 + 8 + 1 + 12 + 64);
  log.format(22, "PIDR", "Qf", "TimeUS,I", 3 + 8 + 4);
  log.format(21, "OLD", "IcLe", "TimeMS,A,Lat,Alt", 3 + 4 + 2 + 4 + 4);
  for (std::uint8_t instance = 0; instance < 2; ++instance) {
    std::vector<std::uint8_t> row;
    put<std::uint64_t>(3000000, &row);
    row.push_back(instance);
    for (const float value : {0.5F, -0.5F, -9.75F}) put(value, &row);
    row.resize(row.size() + 64, 'n');
    log.row(20, row);
  }
  std::vector<std::uint8_t> integral;  // a controller's, no instance
  put<std::uint64_t>(3000000, &integral);
  put(2.5F, &integral);
  log.row(22, integral);
  std::vector<std::uint8_t> old;
  put<std::uint32_t>(4500, &old);
  put<std::int16_t>(-1234, &old);
  put<std::int32_t>(473000000, &old);
  put<std::int32_t>(-250, &old);
  log.row(21, old);
  return log;
}

TEST_F(AutopilotLogs, dataflashGivesEveryNumberInItsUnit) {
  const AutopilotLog log = read(smallDataflash().bytes);
  EXPECT_EQ(log.tables.at("IMU").time, (std::vector<double>{3.0}));
  EXPECT_EQ(log.tables.at("IMU").column.at("AccZ"), (std::vector<double>{-9.75}));
  EXPECT_EQ(log.tables.at("IMU[1]").column.at("AccX"), (std::vector<double>{0.5}));
  EXPECT_EQ(log.tables.at("PIDR").column.at("I"), (std::vector<double>{2.5}));
  const LogTable& old = log.tables.at("OLD");
  EXPECT_DOUBLE_EQ(old.time[0], 4.5);
  EXPECT_DOUBLE_EQ(old.column.at("A")[0], -12.34);
  EXPECT_DOUBLE_EQ(old.column.at("Lat")[0], 47.3);
  EXPECT_DOUBLE_EQ(old.column.at("Alt")[0], -2.5);
  EXPECT_TRUE(log.remarks.empty());
}

TEST_F(AutopilotLogs, dataflashFindsTheNextMessageAfterJunk) {
  MadeDataflash log = smallDataflash();
  const std::vector<std::uint8_t> good = log.bytes;
  log.bytes.insert(log.bytes.end(), {1, 2, 0xa3, 0x95, 77, 5});
  const MadeDataflash more = smallDataflash();
  log.bytes.insert(log.bytes.end(), more.bytes.begin(), more.bytes.end());
  log.bytes.resize(log.bytes.size() - 2);
  const AutopilotLog read_back = read(log.bytes);
  EXPECT_EQ(read_back.tables.at("IMU").time.size(), 2u);
  EXPECT_EQ(read_back.tables.at("OLD").time.size(), 1u);
  ASSERT_EQ(read_back.remarks.size(), 2u);
  EXPECT_EQ(read_back.remarks[1], "6 bytes between messages were skipped");
}

std::size_t rowsOf(const AutopilotLog& log) {
  std::size_t rows = 0;
  for (const auto& [name, table] : log.tables) rows += table.time.size();
  return rows;
}

template <class Values>
bool beginsWith(const Values& whole, const Values& part) {
  return part.size() <= whole.size() && std::equal(part.begin(), part.end(), whole.begin());
}

// A log that was cut holds what the whole one holds up to there, and each byte more only adds to it. One with
// damaged bytes is refused, or read with no more rows than it has bytes for.
TEST_F(AutopilotLogs, everyCutAndRandomDamageIsAnswered) {
  constexpr std::size_t kLeastRow = 4;  // [bytes]: a head and a time
  std::mt19937 generator(11);
  for (const bool ulog : {true, false}) {
    const std::vector<std::uint8_t> whole = ulog ? smallULog().bytes : smallDataflash().bytes;
    const AutopilotLog all = read(whole);
    std::size_t rows = 0;
    for (std::size_t size = 0; size <= whole.size(); ++size) {
      const auto cut = readDamaged({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}, ulog);
      if (!cut) {
        EXPECT_EQ(rows, 0u) << size;
        continue;
      }
      EXPECT_GE(rowsOf(*cut), rows) << size;
      rows = rowsOf(*cut);
      for (const auto& [name, table] : cut->tables) {
        const LogTable& more = all.tables.at(name);
        EXPECT_TRUE(beginsWith(more.time, table.time)) << size << " " << name;
        for (const auto& [field, column] : table.column)
          EXPECT_TRUE(beginsWith(more.column.at(field), column)) << size << " " << name << " " << field;
      }
    }
    EXPECT_EQ(rows, rowsOf(all));
    int refused = 0;
    int read_back = 0;
    for (int round = 0; round < 1500; ++round) {
      std::vector<std::uint8_t> damaged = whole;
      const int changes = 1 + static_cast<int>(generator() % 4);
      for (int change = 0; change < changes; ++change) {
        damaged[generator() % damaged.size()] = static_cast<std::uint8_t>(generator());
      }
      const auto log = readDamaged(damaged, ulog);
      ++(log ? read_back : refused);
      EXPECT_LE(log ? kLeastRow * rowsOf(*log) : 0, damaged.size());
    }
    EXPECT_GT(refused, 0);
    EXPECT_GT(read_back, refused);
  }
}

// Rows of `damaged` that are no rows of `whole`, and rows of `whole` that are missing.
std::pair<std::size_t, std::size_t> wrongAndMissing(const AutopilotLog& whole, const AutopilotLog& damaged) {
  std::size_t wrong = 0;
  std::size_t right = 0;
  for (const auto& [name, table] : damaged.tables) {
    const LogTable& all = whole.tables.at(name);
    for (std::size_t row = 0; row < table.time.size(); ++row) {
      const auto place = static_cast<std::size_t>(
          std::lower_bound(all.time.begin(), all.time.end(), table.time[row]) - all.time.begin());
      bool same = place < all.time.size() && all.time[place] == table.time[row];
      for (const auto& [field, column] : table.column)
        same = same && all.column.at(field)[place] == column[row];
      ++(same ? right : wrong);
    }
  }
  return {wrong, rowsOf(whole) - right};
}

// A byte that is lost, added or changed costs the messages that it lies in and touches, whatever it belongs to.
TEST_F(AutopilotLogs, aByteOfAULogCostsNoMoreThanItsNeighbours) {
  constexpr std::size_t kNeighbours = 2;
  const std::vector<std::uint8_t> bytes = madePx4Flight(0.93, 0.21).bytes;
  const AutopilotLog whole = read(bytes);
  std::mt19937 generator(5);
  for (int round = 0; round < 30; ++round) {
    // Behind the formats and subscriptions.
    const auto place = static_cast<std::ptrdiff_t>(400 + generator() % (bytes.size() - 1000));
    std::vector<std::uint8_t> damaged = bytes;
    if (round % 2 == 0) {
      damaged.erase(damaged.begin() + place);
    } else {
      damaged.insert(damaged.begin() + place, static_cast<std::uint8_t>(generator()));
    }
    const AutopilotLog log = read(damaged);
    const auto [wrong, missing] = wrongAndMissing(whole, log);
    EXPECT_EQ(wrong, 0u) << place;
    EXPECT_LE(missing, kNeighbours) << place;
    ASSERT_EQ(log.remarks.size(), 1u) << place;
    EXPECT_NE(log.remarks[0].find("in 1 places are no message: 99.9 % of the file were read"),
              std::string::npos)
        << log.remarks[0];
  }
}

TEST_F(AutopilotLogs, anOverwrittenSectorOfAULogCostsWhatLiesInIt) {
  constexpr std::size_t kSector = 4096;
  constexpr std::size_t kLeastMessage = 29;  // of the made flight, [bytes]
  const std::vector<std::uint8_t> bytes = madePx4Flight(0.93, 0.21).bytes;
  const AutopilotLog whole = read(bytes);
  std::mt19937 generator(6);
  for (int round = 0; round < 20; ++round) {
    const std::size_t place = 400 + generator() % (bytes.size() - kSector - 1000);
    std::vector<std::uint8_t> damaged = bytes;
    for (std::size_t i = 0; i < kSector; ++i)
      damaged[place + i] = static_cast<std::uint8_t>(round % 2 == 0 ? generator() : 0);
    const AutopilotLog log = read(damaged);
    const auto [wrong, missing] = wrongAndMissing(whole, log);
    EXPECT_EQ(wrong, 0u) << place;
    EXPECT_LE(missing, kSector / kLeastMessage + 3) << place;
    ASSERT_FALSE(log.remarks.empty());
    EXPECT_NE(log.remarks.back().find("% of the file were read"), std::string::npos) << log.remarks.back();
  }
}

double handedOut(const AxisModel& model, const std::string& parameter) {
  return model.findModel("model_without_delay")->fit.find(parameter)->value;
}

TEST_F(AutopilotLogs, bothGiveTheLoopThatFlew) {
  constexpr double kGain = 0.93;
  constexpr double kTau = 0.21;
  for (const bool px4 : {true, false}) {
    writeBytes(px4 ? madePx4Flight(kGain, kTau).bytes : madeArduPilotFlight(kGain, kTau).bytes, path_);
    ASSERT_TRUE(isAutopilotLog(path_));
    const AutopilotSignals found = signalsFromAutopilot(path_, {});
    EXPECT_TRUE(found.remarks.empty());
    EXPECT_EQ(found.signals.at("roll").time.front(), 0.0);
    const AxisModel model = identifyAxis(axisRecords(found.signals, "roll"), {});
    EXPECT_NEAR(handedOut(model, "gain"), kGain, 0.01);
    EXPECT_NEAR(handedOut(model, "tau"), kTau, 0.01);
  }
}

TEST_F(AutopilotLogs, aClockThatWasSetLeavesTheLoopThatFlew) {
  constexpr double kGain = 0.93;
  constexpr double kTau = 0.21;
  for (const std::int64_t set_by : {std::int64_t{3600000000}, std::int64_t{1700000000000000}}) {
    for (const bool px4 : {true, false}) {
      writeBytes(
          px4 ? madePx4Flight(kGain, kTau, set_by).bytes : madeArduPilotFlight(kGain, kTau, set_by).bytes,
          path_);
      const FlightSignals signals = signalsFromAutopilot(path_, {}).signals;
      ASSERT_FALSE(clockRemarks(signals).empty());
      EXPECT_NE(clockRemarks(signals).front().find("after 19.99"), std::string::npos)
          << clockRemarks(signals).front();
      const AxisModel model = identifyAxis(axisRecords(signals, "roll"), {});
      EXPECT_NEAR(handedOut(model, "gain"), kGain, 0.01);
      EXPECT_NEAR(handedOut(model, "tau"), kTau, 0.01);
    }
  }
}

TEST_F(AutopilotLogs, dataflashUnitsTellWhichFieldIsTheInstance) {
  MadeDataflash log;
  log.format(30, "VIBE", "QBf", "TimeUS,IMU,X", 3 + 8 + 1 + 4);
  log.format(31, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", 3 + 8 + 1 + 16 + 16);
  std::vector<std::uint8_t> units;
  put<std::uint64_t>(1000000, &units);
  units.push_back(30);
  for (const std::string text : {"s#-", "F--"}) {
    for (std::size_t i = 0; i < 16; ++i)
      units.push_back(i < text.size() ? static_cast<std::uint8_t>(text[i]) : 0);
  }
  log.row(31, units);
  for (std::uint8_t instance = 0; instance < 2; ++instance) {
    std::vector<std::uint8_t> row;
    put<std::uint64_t>(2000000, &row);
    row.push_back(instance);
    put(0.5F + instance, &row);
    log.row(30, row);
  }
  const AutopilotLog read_back = read(log.bytes);
  EXPECT_EQ(read_back.tables.at("VIBE").column.at("X"), (std::vector<double>{0.5}));
  EXPECT_EQ(read_back.tables.at("VIBE[1]").column.at("X"), (std::vector<double>{1.5}));
}

// Adds when the vehicle stood: [s] by the autopilot's clock, and whether from then on.
void addLanded(const std::vector<std::pair<double, bool>>& steps, MadeULog* log) {
  log->format("vehicle_land_detected:uint64_t timestamp;bool landed;");
  log->subscribe(0, 9, "vehicle_land_detected");
  for (const auto& [time, landed] : steps) {
    std::vector<std::uint8_t> row;
    put(static_cast<std::uint64_t>(1e6 * time), &row);
    row.push_back(landed ? 1 : 0);
    log->data(9, row);
  }
}

TEST_F(AutopilotLogs, whatWasMeasuredOnTheGroundIsLeftOut) {
  // The log starts at 5 s and lasts 60 s.
  MadeULog log = madePx4Flight(1.0, 0.2);
  addLanded({{5.0, true}, {25.0, false}, {55.0, true}}, &log);
  writeBytes(log.bytes, path_);
  const AutopilotSignals flown = signalsFromAutopilot(path_, {});
  EXPECT_NEAR(flown.signals.at("roll").time.front(), 20.0, 1e-9);
  EXPECT_NEAR(flown.signals.at("roll").time.back(), 49.99, 1e-6);
  EXPECT_NEAR(flown.signals.at("roll_cmd").time.front(), 0.0, 1e-9);
  ASSERT_EQ(flown.remarks.size(), 1u);
  EXPECT_EQ(flown.remarks[0],
            "30.0 s of 60.0 s were left out: the vehicle stood, by vehicle_land_detected.landed");
  EXPECT_TRUE(flown.signals.thrust_is_share);
  const AutopilotSignals whole = signalsFromAutopilot(path_, {}, true);
  EXPECT_NEAR(whole.signals.at("roll").time.front(), 0.0, 1e-9);
  EXPECT_TRUE(whole.remarks.empty());

  MadeULog stands = madePx4Flight(1.0, 0.2);
  addLanded({{5.0, true}}, &stands);
  writeBytes(stands.bytes, path_);
  EXPECT_THROW(signalsFromAutopilot(path_, {}), Error);
}

TEST_F(AutopilotLogs, arduPilotTellsByEventsWhenItFlew) {
  // The log starts at 7 s and lasts 60 s.
  MadeDataflash log = madeArduPilotFlight(1.0, 0.2);
  log.format(40, "EV", "QB", "TimeUS,Id", 3 + 8 + 1);
  for (const auto& [time, id] :
       std::vector<std::pair<double, int>>{{8.0, 10}, {17.0, 28}, {47.0, 18}, {48.0, 11}}) {
    std::vector<std::uint8_t> row;
    put(static_cast<std::uint64_t>(1e6 * time), &row);
    row.push_back(static_cast<std::uint8_t>(id));
    log.row(40, row);
  }
  writeBytes(log.bytes, path_);
  const AutopilotSignals flown = signalsFromAutopilot(path_, {});
  EXPECT_NEAR(flown.signals.at("roll").time.front(), 10.0, 1e-9);
  EXPECT_NEAR(flown.signals.at("roll").time.back(), 39.99, 1e-6);
}

// A command that moves all the time, logged ten times a second as ArduPilot does; held between the rows it
// would seem to come 0.05 s late.
TEST_F(AutopilotLogs, commandsThatAreLoggedSeldomAreJoinedByLines) {
  constexpr double kTau = 0.15;
  MadeDataflash log;
  log.format(10, "ATT", "Qcc", "TimeUS,DesRoll,Roll", 3 + 8 + 4);
  double roll = 0.0;
  const auto command = [](double t) { return 15.0 * std::sin(1.3 * t) + 8.0 * std::sin(4.1 * t + 1.0); };
  for (int i = 0; i < 60000; ++i) {
    const double time = 0.001 * i;
    if (i % 100 == 0) {
      std::vector<std::uint8_t> row;
      put(std::uint64_t{1000000} + 1000U * static_cast<std::uint64_t>(i), &row);
      put(static_cast<std::int16_t>(std::lround(100.0 * command(time))), &row);
      put(static_cast<std::int16_t>(std::lround(100.0 * roll)), &row);
      log.row(10, row);
    }
    roll += 0.001 / kTau * (command(time) - roll);
  }
  writeBytes(log.bytes, path_);
  const AxisModel model = identifyAxis(axisRecords(signalsFromAutopilot(path_, {}).signals, "roll"), {});
  EXPECT_NEAR(handedOut(model, "gain"), 1.0, 0.02);
  EXPECT_NEAR(handedOut(model, "tau"), kTau, 0.01);
}

// As logs of 2014 have it: GPS in its own time of the week, with the autopilot's time as T.
TEST_F(AutopilotLogs, oldLogsGiveVelocitiesByTheirGps) {
  MadeDataflash log;
  log.format(50, "GPS", "IHEefI", "TimeMS,Week,Spd,GCrs,VZ,T", 3 + 4 + 2 + 4 + 4 + 4 + 4);
  for (std::uint32_t i = 0; i < 3; ++i) {
    std::vector<std::uint8_t> row;
    put<std::uint32_t>(400000000 + 200 * i, &row);
    put<std::uint16_t>(1800, &row);
    put<std::uint32_t>(1000, &row);                                // 10 m/s
    put<std::int32_t>(9000 * static_cast<std::int32_t>(i), &row);  // north, east, south
    put(-1.5F, &row);
    put<std::uint32_t>(5000 + 200 * i, &row);
    log.row(50, row);
  }
  const AutopilotLog read_back = read(log.bytes);
  EXPECT_NEAR(read_back.tables.at("GPS").time[1], 5.2, 1e-12);
  const AutopilotSignals found = signalsFromAutopilot(path_, {});
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_NEAR(found.signals.at("vn").value[at], i == 0 ? 10.0 : i == 2 ? -10.0 : 0.0, 1e-9);
    EXPECT_NEAR(found.signals.at("ve").value[at], i == 1 ? 10.0 : 0.0, 1e-9);
    EXPECT_NEAR(found.signals.at("vz").value[at], 1.5, 1e-9);
  }
}

TEST_F(AutopilotLogs, placesAreChosenByTableAndField) {
  writeBytes(smallDataflash().bytes, path_);
  const AutopilotSignals found =
      signalsFromAutopilot(path_, {{"roll", "-IMU[1]:AccX:deg"}, {"thrust_cmd", "OLD:A"}});
  EXPECT_NEAR(found.signals.at("roll").value[0], -0.5 * 3.14159265358979 / 180.0, 1e-12);
  EXPECT_EQ(found.signals.at("thrust_cmd").value[0], -12.34);
  EXPECT_NEAR(found.signals.at("specific_force_z").value[0], 9.75, 1e-12);
  EXPECT_THROW(signalsFromAutopilot(path_, {{"roll", "ATT:Roll"}}), Error);
  EXPECT_THROW(signalsFromAutopilot(path_, {{"roll", "ATT"}}), Error);
  EXPECT_THROW(signalsFromAutopilot(path_, {{"bank", "IMU:AccX"}}), Error);
}

}  // namespace
}  // namespace polyfly
