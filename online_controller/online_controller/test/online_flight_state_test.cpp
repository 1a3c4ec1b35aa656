#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <string>

#include "online_controller/flight/flight_state.hpp"

namespace {

using polyfly::FlightEvent;
using polyfly::FlightSituation;
using polyfly::FlightState;

constexpr char kRefused = 'x';
using Table = std::array<std::string, polyfly::kFlightStateCount>;

// I inactive, T take-off, P position hold, J trajectory, R remote control, S sticks move the hold, L landing,
// G on the ground, F failsafe; the failsafe interrupted a trajectory.
constexpr char kLetters[] = "ITPJRSLGF";

//                        pose . . ended . done . hold . touchdown . sticks . lost . bad . recovered
//                          trajectory take-off failed land . manual . idle . silence no answer . guided, guided ended
const Table kFree{
    "PJITIIxxIRIIIIIIIPI",  // inactive
    "TTTxPLPLTRSTTFFFTTT",  // take-off
    "PJPxPPPLPRSPPFFFPPI",  // position hold
    "PJPxJJPLJRSJJFFFJJJ",  // trajectory
    "xxRxRRxxRRSPLRRRRRR",  // remote control
    "xxSxSSPLSRSSPFFFSSS",  // sticks move the hold
    "xxLxLLPLGRSLLFFFLLL",  // landing
    "xxGTGGxxGRGGGGGGGGG",  // on the ground
    "FFFxFFxFFRFFFFFFJFI",  // failsafe
};

char answer(FlightState state, FlightEvent event, const FlightSituation& situation) {
  const polyfly::FlightTransition next = polyfly::transition(state, event, situation);
  if (next.refusal == nullptr) return kLetters[static_cast<std::size_t>(next.to)];
  EXPECT_EQ(next.to, state) << "a refusal changes nothing";
  EXPECT_GT(std::string(next.refusal).size(), 5U);
  return kRefused;
}

void expectTable(const Table& table, const FlightSituation& situation) {
  for (int s = 0; s < polyfly::kFlightStateCount; ++s) {
    for (int e = 0; e < polyfly::kFlightEventCount; ++e) {
      EXPECT_EQ(answer(static_cast<FlightState>(s), static_cast<FlightEvent>(e), situation),
                table[static_cast<std::size_t>(s)].at(static_cast<std::size_t>(e)))
          << polyfly::flightStateName(static_cast<FlightState>(s)) << ", "
          << polyfly::describe(static_cast<FlightEvent>(e));
    }
  }
}

FlightSituation situation(bool pilot, bool odometry) {
  FlightSituation result;
  result.pilot = pilot;
  result.odometry = odometry;
  result.interrupted = FlightState::kTrajectory;
  return result;
}

TEST(FlightState, EveryEventInEveryState) { expectTable(kFree, situation(false, true)); }

TEST(FlightState, APilotMustHandOverFirst) {
  Table table = kFree;
  table[0].replace(0, 4, "xxIx");
  table[0][17] = 'I';
  table[7][3] = kRefused;
  expectTable(table, situation(true, true));
}

TEST(FlightState, NothingBeginsWithoutOdometry) {
  Table table = kFree;
  table[0][3] = kRefused;
  table[7][3] = kRefused;
  table[4].replace(10, 3, "RRF");
  expectTable(table, situation(false, false));
}

TEST(FlightState, NamesAreThoseThatScriptsKnow) {
  EXPECT_STREQ(polyfly::flightStateName(FlightState::kPositionHold), "PositionHold");
  EXPECT_STREQ(polyfly::flightStateName(FlightState::kTeleoperation), "RcTeleOp");
  EXPECT_STREQ(polyfly::flightStateName(FlightState::kRemoteControl), "RemoteControl");
  EXPECT_STREQ(polyfly::flightStateName(FlightState::kInactive), "Inactive");
}

}  // namespace
