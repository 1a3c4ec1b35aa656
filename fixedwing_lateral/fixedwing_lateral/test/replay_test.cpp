// Two closed-loop simulations by others (explicit Euler, 50 s, loiter in 10 m/s of wind): their roll
// references flown open loop through this model.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "fixedwing_lateral/model.hpp"
#include "reference_data.hpp"

namespace {

using namespace polyfly;
using Index = LateralIndex;

// What the recording's documentation promises of a fourth-order replay.
constexpr double kPosition = 0.33;  // [m]
constexpr double kRoll = 0.010;     // [rad]
constexpr double kHeading = 0.005;  // [rad]
constexpr double kPeriod = 0.01;    // [s]

// What four decimals of a metre and six of a radian, in the start and in every reference, leave after 50 s.
constexpr double kPrintedPosition = 1e-3;  // [m]
constexpr double kPrintedAngle = 2e-5;     // [rad]

// t, n, e, roll, heading, roll rate, roll reference
constexpr std::size_t kColumns = 7;
using Rows = std::vector<std::vector<double>>;

std::filesystem::path recordings() { return referenceData("reference_sim"); }

Rows readCsv(const std::filesystem::path& path) {
  std::ifstream file(path);
  Rows rows;
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line.substr(0, 31), "t_s,n_m,e_m,roll_rad,heading_ra") << path;
  while (std::getline(file, line)) {
    std::vector<double> row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    rows.push_back(row);
  }
  return rows;
}

// Advances by kPeriod.
using Step =
    std::function<LateralState(const LateralConditions&, const LateralState&, double roll_reference)>;

struct Deviation {
  double position = 0.0;  // [m]
  double roll = 0.0;      // [rad]
  double heading = 0.0;   // [rad]
};

// The first row is recorded twice, and a reference acts one row after the one that shows it: so aligned, and
// only so, explicit Euler gives the recording to the digits it was printed with.
Deviation replay(const Rows& rows, const Step& step) {
  LateralConditions conditions;
  conditions.wind = {0.0, -10.0};
  LateralState state;
  state << rows[1][1], rows[1][2], rows[1][3], rows[1][4], rows[1][5], 0.0;
  Deviation worst;
  for (std::size_t i = 2; i < rows.size(); ++i) {
    state = step(conditions, state, rows[i - 2][6]);
    const auto& row = rows[i];
    worst.position =
        std::max(worst.position, std::hypot(state[Index::kNorth] - row[1], state[Index::kEast] - row[2]));
    worst.roll = std::max(worst.roll, std::abs(state[Index::kRoll] - row[3]));
    worst.heading = std::max(worst.heading, std::abs(state[Index::kHeading] - row[4]));
  }
  return worst;
}

class Replay : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::filesystem::path folder = recordings();
    if (folder.empty())
      GTEST_SKIP() << "The recorded simulations are not here: set POLYFLY_DATA to their folder.";
    rows = readCsv(folder / GetParam());
    ASSERT_EQ(rows.size(), 5001u);
    for (const auto& row : rows) ASSERT_EQ(row.size(), kColumns);
  }

  Rows rows;
};

TEST_P(Replay, RungeKuttaStaysWithTheRecording) {
  const Deviation worst =
      replay(rows, [](const LateralConditions& conditions, const LateralState& state, double u) {
        return integrate(LateralModel(), conditions, state, {u, kPeriod});
      });
  RecordProperty("position_m", std::to_string(worst.position));
  RecordProperty("roll_rad", std::to_string(worst.roll));
  RecordProperty("heading_rad", std::to_string(worst.heading));
  EXPECT_LT(worst.position, kPosition);
  EXPECT_LT(worst.roll, kRoll);
  EXPECT_LT(worst.heading, kHeading);
}

TEST_P(Replay, ExplicitEulerIsTheRecording) {
  const Deviation worst =
      replay(rows, [](const LateralConditions& conditions, const LateralState& state, double u) {
        return LateralState(state + kPeriod * lateralRate(LateralModel(), conditions, state, u));
      });
  EXPECT_LT(worst.position, kPrintedPosition);
  EXPECT_LT(worst.roll, kPrintedAngle);
  EXPECT_LT(worst.heading, kPrintedAngle);
}

INSTANTIATE_TEST_SUITE_P(Loiter, Replay,
                         testing::Values("stastny_sim_loiter_wind_N40.csv",
                                         "stastny_sim_loiter_wind_N40_noWmuprev.csv"));

}  // namespace
