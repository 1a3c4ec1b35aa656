#include "identification/identify_axis.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "identification/attitude_output.hpp"
#include "made_flight.hpp"
#include "polyfly_base/error.hpp"
#include "report/yaml.hpp"

namespace polyfly {
namespace {

AxisRecords madeAxis(const test::MadeLoop& made, std::uint32_t seed) {
  AxisRecords records;
  records.axis = "roll";
  records.unit = records.command_unit = "rad";
  records.training = test::makeFlight(made, seed);
  return records;
}

IdentifyOptions wholeFlight() {
  IdentifyOptions options;
  options.windows = {{0.0, 30.0}};
  return options;
}

bool warnsOf(const AxisModel& model, const std::string& words) {
  for (const std::string& sentence : model.warnings) {
    if (sentence.find(words) != std::string::npos) return true;
  }
  return false;
}

std::string all(const AxisModel& model) {
  std::string text;
  for (const std::string& sentence : model.warnings) text += sentence + "\n";
  return text;
}

TEST(IdentifyAxis, HasNoWarningForAGoodFlight) {
  const AxisModel model = identifyAxis(madeAxis({}, 1), wholeFlight());
  EXPECT_TRUE(model.warnings.empty()) << all(model);
  ASSERT_TRUE(model.validation.has_value());
  EXPECT_TRUE(model.validation->by_halves);
  EXPECT_GT(model.validation->validation_percent, model.validation->training_percent - 3.0);
}

TEST(IdentifyAxis, ValidatesOnAnotherFlight) {
  AxisRecords records = madeAxis({}, 1);
  records.validation = test::makeFlight({}, 2);
  const AxisModel model = identifyAxis(records, wholeFlight());
  ASSERT_TRUE(model.validation.has_value());
  EXPECT_FALSE(model.validation->by_halves);
  EXPECT_GT(model.validation->validation_percent, 90.0);
}

TEST(IdentifyAxis, WarnsOfAWrongSign) {
  AxisRecords records = madeAxis({}, 1);
  for (double& value : records.training.response.value) value = -value;
  EXPECT_TRUE(warnsOf(identifyAxis(records, wholeFlight()), "against the command"));
}

TEST(IdentifyAxis, WarnsOfDegreesAndNamesTheOptionThatHelps) {
  AxisRecords records = madeAxis({}, 1);
  records.command_help = "the command's option";
  records.response_help = "the response's option";
  for (double& value : records.training.response.value) value *= 57.2957795;
  EXPECT_TRUE(warnsOf(identifyAxis(records, wholeFlight()), "degrees; the response's option"));
  for (double& value : records.training.command.value) value *= 57.2957795 * 57.2957795;
  EXPECT_TRUE(warnsOf(identifyAxis(records, wholeFlight()), "degrees; the command's option"));
}

TEST(IdentifyAxis, WarnsOfAnotherScale) {
  AxisRecords records = madeAxis({}, 1);
  for (double& value : records.training.command.value) value *= 2.5;
  EXPECT_TRUE(warnsOf(identifyAxis(records, wholeFlight()), "different scales"));
}

TEST(IdentifyAxis, WarnsOfAResponseBeforeItsCommand) {
  AxisRecords records = madeAxis({}, 1);
  for (double& time : records.training.response.time) time -= 0.25;
  const AxisModel model = identifyAxis(records, wholeFlight());
  EXPECT_TRUE(warnsOf(model, "before its command")) << all(model);
}

TEST(IdentifyAxis, WarnsOfSwappedAxes) {
  AxisRecords records = madeAxis({}, 1);
  records.other_command = records.training.command;
  // The own command moves at other times.
  for (std::size_t i = 0; i < records.training.command.time.size(); ++i) {
    records.training.command.value[i] = 0.2 * std::sin(1.3 * records.training.command.time[i]);
  }
  const AxisModel model = identifyAxis(records, wholeFlight());
  EXPECT_TRUE(warnsOf(model, "swapped")) << all(model);
}

TEST(IdentifyAxis, DoesNotSupportTooLittleExcitation) {
  test::MadeLoop made;
  made.noise = 0.3;
  made.duration = 8.0;
  const AxisModel model = identifyAxis(madeAxis(made, 3), wholeFlight());
  EXPECT_FALSE(model.supported);
  std::string reasons;
  for (const std::string& sentence : model.controller_models.front().reasons) reasons += sentence;
  EXPECT_TRUE(reasons.find("Too little excitation") != std::string::npos ||
              reasons.find("is not above zero") != std::string::npos)
      << reasons;
}

// In the last quarter of the moves the loop has half its gain, as after a failure.
TEST(IdentifyAxis, TellsWhichShareOfTheFlightWasUsed) {
  test::MadeLoop made;
  made.duration = 60.0;
  AxisRecords records = madeAxis(made, 1);
  const AxisModel whole = identifyAxis(records, {});
  EXPECT_GT(whole.usedTime(), 0.95 * whole.movingTime());
  EXPECT_FALSE(warnsOf(whole, "follows the command in"));
  const TimeWindow last = whole.choice.windows.back();
  const double from = last.to - 0.25 * whole.movingTime();
  for (std::size_t i = 0; i < records.training.response.time.size(); ++i) {
    if (records.training.response.time[i] > from) records.training.response.value[i] *= 0.5;
  }
  const AxisModel model = identifyAxis(records, {});
  EXPECT_NEAR(model.usedTime() / model.movingTime(), 0.75, 0.06);
  EXPECT_TRUE(warnsOf(model, "follows the command in")) << all(model);
}

TEST(IdentifyAxis, UsesRowsThatWereWrittenTwiceOnceAndSaysSo) {
  AxisRecords records = madeAxis({}, 1);
  for (TimeSeries* series : {&records.training.command, &records.training.response}) {
    const TimeSeries once = *series;
    series->time.insert(series->time.end(), once.time.begin(), once.time.end());
    series->value.insert(series->value.end(), once.value.begin(), once.value.end());
  }
  const AxisModel model = identifyAxis(records, wholeFlight());
  EXPECT_EQ(model.with_delay.samples, identifyAxis(madeAxis({}, 1), wholeFlight()).with_delay.samples);
  EXPECT_TRUE(warnsOf(model, "samples were left out")) << all(model);
}

TEST(IdentifyAxis, NamesSourceAndAxisWhenThereIsNothing) {
  AxisRecords records = madeAxis({}, 1);
  records.training.source = "flight.csv";
  for (double& value : records.training.command.value) value = 0.0;
  try {
    identifyAxis(records, {});
    FAIL() << "a command that rests was accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("flight.csv: roll: "), std::string::npos) << error.what();
  }
}

TEST(IdentifyAxis, SameInputSameBytes) {
  AttitudeCalibration one;
  one.axes.push_back(identifyAxis(madeAxis({}, 1), wholeFlight()));
  AttitudeCalibration other;
  other.axes.push_back(identifyAxis(madeAxis({}, 1), wholeFlight()));
  EXPECT_EQ(yamlText(jsonOf(one)), yamlText(jsonOf(other)));
}

}  // namespace
}  // namespace polyfly
