// Real flights, against reference fits that were made with other programs.

#include <gtest/gtest.h>

#include <filesystem>

#include "identification/flight_signals.hpp"
#include "reference_data.hpp"

namespace polyfly {
namespace {

struct Reference {
  const char* file;
  const char* axis;
  // Usable windows, by the README of the data.
  std::vector<TimeWindow> windows;
  // Fit of a first-order model with delay [%].
  double fit_percent;
};

std::filesystem::path logs() { return referenceData("flight_logs"); }

AxisModel identify(const Reference& reference) {
  const FlightSignals signals = signalsFromCsv(readCsv((logs() / reference.file).string() + ".csv"), {});
  IdentifyOptions options;
  options.windows = reference.windows;
  return identifyAxis(axisRecords(signals, reference.axis), options);
}

class FlightLogs : public testing::TestWithParam<Reference> {};

TEST_P(FlightLogs, FitsAsWellAsTheReferenceAndHoldsOnTheSecondHalf) {
  if (logs().empty()) GTEST_SKIP() << "The recorded flights are not here: set POLYFLY_DATA to their folder.";
  const AxisModel model = identify(GetParam());
  EXPECT_GE(model.with_delay.fit_percent, GetParam().fit_percent - 1.0);
  ASSERT_TRUE(model.validation.has_value());
  EXPECT_GE(model.validation->validation_percent, model.validation->training_percent - 8.0);
}

INSTANTIATE_TEST_SUITE_P(
    All, FlightLogs,
    testing::Values(Reference{"mr_asctec_pitchroll", "roll", {{15.0, 55.0}}, 93.9},
                    Reference{"mr_asctec_pitchroll", "pitch", {{15.0, 55.0}}, 89.2},
                    Reference{"mr_jay_100932", "roll", {{8.0, 20.0}, {24.0, 44.0}}, 75.9},
                    Reference{"mr_jay_100932", "pitch", {{8.0, 20.0}, {24.0, 44.0}}, 57.9},
                    Reference{"mr_ardu_erlebrain2", "roll", {{84.0, 133.0}}, 90.1},
                    Reference{"mr_ardu_erlebrain2", "pitch", {{84.0, 133.0}}, 90.0},
                    Reference{"mr_ardu_pxf_180314", "roll", {{98.0, 109.0}}, 76.6},
                    Reference{"mr_ardu_pxf_180314", "pitch", {{98.0, 109.0}}, 88.2},
                    Reference{"fw_px4_proto_flt09", "roll", {{306.0, 330.0}}, 95.5}),
    [](const auto& test) { return std::string(test.param.file) + "_" + test.param.axis; });

TEST(FlightLogsParameters, AgreeWithTheReferenceWithinTheirUncertainty) {
  if (logs().empty()) GTEST_SKIP() << "The recorded flights are not here: set POLYFLY_DATA to their folder.";
  const AxisModel model = identify({"fw_px4_proto_flt09", "roll", {{306.0, 330.0}}, 95.5});
  const std::pair<const char*, double> references[] = {{"gain", 1.05}, {"tau", 0.293}, {"delay", 0.117}};
  for (const auto& [name, value] : references) {
    const FittedParameter* found = model.with_delay.find(name);
    EXPECT_LE(found->least(), value) << name;
    EXPECT_GE(found->greatest(), value) << name;
    EXPECT_GT(found->least(), 0.0) << name;  // an interval that says something
  }
}

TEST(FlightLogsParameters, TakeACommandOfClimbRateForWhatItIs) {
  if (logs().empty()) GTEST_SKIP() << "The recorded flights are not here: set POLYFLY_DATA to their folder.";
  const AxisModel model = identify({"mr_asctec_height", "thrust", {{10.0, 58.0}}, 0.0});
  bool warned = false;
  for (const std::string& sentence : model.warnings)
    warned |= sentence.find("climb rate") != std::string::npos;
  EXPECT_TRUE(warned);
}

TEST(FlightLogsParameters, SeeThatACommandIsOnAnotherScale) {
  if (logs().empty()) GTEST_SKIP() << "The recorded flights are not here: set POLYFLY_DATA to their folder.";
  const AxisModel model = identify({"mr_asctec_height", "roll", {{10.0, 58.0}}, 0.0});
  bool warned = false;
  for (const std::string& sentence : model.warnings)
    warned |= sentence.find("different scales") != std::string::npos;
  EXPECT_TRUE(warned);
}

}  // namespace
}  // namespace polyfly
