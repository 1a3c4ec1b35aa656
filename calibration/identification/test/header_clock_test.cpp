#include "identification/header_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace polyfly {
namespace {

constexpr double kPeriod = 0.02;  // [s]
constexpr std::size_t kMessages = 1500;
constexpr std::size_t kMiddle = kMessages / 2;

struct Record {
  std::vector<double> stamps;
  std::vector<double> received;

  HeaderClock clock() const { return headerClock(stamps, received); }
};

// Messages that take 5 to 25 ms to the recorder.
Record steadyRecord() {
  Record record;
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> latency(0.005, 0.025);
  for (std::size_t message = 0; message < kMessages; ++message) {
    record.stamps.push_back(1000.0 + kPeriod * static_cast<double>(message));
    record.received.push_back(record.stamps.back() + latency(generator));
  }
  return record;
}

void shift(std::vector<double>* times, std::size_t from, double by) {
  std::for_each(times->begin() + static_cast<std::ptrdiff_t>(from), times->end(),
                [by](double& time) { time += by; });
}

TEST(HeaderClock, OfASteadyRecordIsSteady) {
  const HeaderClock clock = steadyRecord().clock();
  EXPECT_TRUE(clock.isSteady());
  EXPECT_TRUE(clock.steps.empty());
  EXPECT_TRUE(clausesOn(clock, 1000.0).empty());
  EXPECT_NEAR(clock.lead, -0.015, 0.002);
}

TEST(HeaderClock, ThatJumpsIsToldWithPlaceAndSize) {
  for (const double by : {120.0, -120.0, 0.8, -0.8, 1.7e9}) {
    Record record = steadyRecord();
    shift(&record.stamps, kMiddle, by);
    const HeaderClock clock = record.clock();
    EXPECT_FALSE(clock.isSteady()) << by;
    ASSERT_EQ(clock.steps.size(), 1u) << by;
    EXPECT_TRUE(clock.steps[0].of_headers) << by;
    EXPECT_NEAR(clock.steps[0].by, by, 0.05) << by;
    EXPECT_EQ(clock.steps[0].at, record.received[kMiddle]) << by;
  }
}

TEST(HeaderClock, IsNotBlamedForTheRecorders) {
  for (const double by : {120.0, -120.0}) {
    Record record = steadyRecord();
    shift(&record.received, kMiddle, by);
    const HeaderClock clock = record.clock();
    EXPECT_TRUE(clock.isSteady()) << by;
    ASSERT_EQ(clock.steps.size(), 1u) << by;
    EXPECT_FALSE(clock.steps[0].of_headers) << by;
    const std::vector<std::string> clauses = clausesOn(clock, 1000.0);
    ASSERT_EQ(clauses.size(), 1u);
    EXPECT_EQ(clauses[0].find("the recorder's clock jumps by"), 0u) << clauses[0];
  }
}

// A network that is held up for three seconds delivers all messages at once.
TEST(HeaderClock, IsSteadyWhereMessagesComeLate) {
  Record record = steadyRecord();
  const double end = record.received[kMiddle] + 3.0;
  for (std::size_t message = kMiddle; record.received[message] < end; ++message)
    record.received[message] = end;
  const HeaderClock clock = record.clock();
  EXPECT_TRUE(clock.isSteady());
  EXPECT_TRUE(clock.steps.empty());
}

// On a busy machine the recorder falls behind in several steps, at last by 3.4 s, and catches up message by message,
// or loses some of those that wait.
TEST(HeaderClock, IsSteadyWhereTheRecorderIsLateInSteps) {
  for (const bool loses : {false, true}) {
    Record record = steadyRecord();
    double late = 0.0;
    for (std::size_t message = 0; message < kMessages; ++message) {
      if (message == 300 || message == 320 || message == 330 || message == 900) late += 0.85;
      late = std::max(0.0, late - (message > 400 ? 0.9 * kPeriod : 0.0));
      record.received[message] += late;
    }
    if (loses) {
      const auto from = static_cast<std::ptrdiff_t>(420);
      record.stamps.erase(record.stamps.begin() + from, record.stamps.begin() + from + 130);
      record.received.erase(record.received.begin() + from, record.received.begin() + from + 130);
    }
    const HeaderClock clock = record.clock();
    EXPECT_TRUE(clock.isSteady());
    EXPECT_TRUE(clock.steps.empty()) << clausesOn(clock, 1000.0).front();
    EXPECT_NEAR(clock.late, 2.55, 0.1);
  }
}

// A recorder whose clock is set back receives messages before they were sent, which no lateness does.
TEST(HeaderClock, TellsARecorderThatIsSetBackAndForth) {
  Record record = steadyRecord();
  shift(&record.received, 300, -2.0);
  shift(&record.received, 900, 2.0);
  const HeaderClock clock = record.clock();
  EXPECT_EQ(clock.steps.size(), 2u);
  EXPECT_EQ(clock.late, 0.0);
}

// Nothing was sent for a minute: both clocks went on.
TEST(HeaderClock, IsSteadyWhereNothingWasSent) {
  Record record = steadyRecord();
  shift(&record.stamps, kMiddle, 60.0);
  shift(&record.received, kMiddle, 60.0);
  EXPECT_TRUE(record.clock().steps.empty());
}

TEST(HeaderClock, CountsMessagesWithoutStamp) {
  Record record = steadyRecord();
  for (std::size_t message = 0; message < 3; ++message) record.stamps[message] = 0.0;
  const HeaderClock clock = record.clock();
  EXPECT_FALSE(clock.isSteady());
  EXPECT_TRUE(clock.steps.empty());
  EXPECT_EQ(clausesOn(clock, 1000.0), std::vector<std::string>{"3 of 1500 messages have no stamp"});
  std::fill(record.stamps.begin(), record.stamps.end(), 0.0);
  EXPECT_EQ(record.clock().without_stamp, kMessages);
  EXPECT_EQ(record.clock().lead, 0.0);
}

TEST(HeaderClock, OfManyJumpsTellsTheFirstOnes) {
  Record record = steadyRecord();
  for (std::size_t message = 100; message < kMessages; message += 100) shift(&record.stamps, message, 10.0);
  const std::vector<std::string> clauses = clausesOn(record.clock(), 1000.0);
  ASSERT_EQ(clauses.size(), 4u);
  EXPECT_EQ(clauses.back(), "11 more such jumps follow");
}

TEST(HeaderClock, OfFewMessagesIsHarmless) {
  EXPECT_TRUE(headerClock({}, {}).isSteady());
  EXPECT_TRUE(headerClock({5.0}, {6.0}).isSteady());
  EXPECT_FALSE(headerClock({0.0}, {6.0}).isSteady());
}

}  // namespace
}  // namespace polyfly
