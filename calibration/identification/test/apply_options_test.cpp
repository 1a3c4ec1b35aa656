#include "identification/apply_options.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

std::string begin(const std::string& kind, const std::string& vehicle) {
  return "polyfly_calibration: 1\nkind: " + kind + "\nvehicle: {kind: " + vehicle +
         ", reason: \"It flies.\"}\ndata: {file: \"a.bag\", checksum: \"xxh64:1\", recorded: \"\"}\n";
}

std::string attitude(const std::string& vehicle) {
  return begin("attitude", vehicle) +
         "axes:\n"
         "  roll:\n    model: {gain: 0.82, tau: 0.26, delay: 0.05, supported: true}\n    "
         "model_without_delay: {gain: 0.81, tau: 0.31, supported: true}\n"
         "    model_second_order: {a0: 14, a1: 6, b0: 13, delay: 0.05, supported: true}\n"
         "    model_second_order_without_delay: {a0: 11, a1: 5, b0: 10, supported: true}\n"
         "  pitch:\n    model: {gain: 0.73, tau: 0.35, delay: 0.07, supported: true}\n    "
         "model_without_delay: {gain: 0.72, tau: 0.42, supported: true}\n";
}

const std::string kRotorDrag = begin("drag", "multirotor") +
                               "parameters:\n  drag_x: {value: 9, interval_95: [8, 10], supported: true}\n"
                               "  drag_forward: {value: 0.2, interval_95: [0.1, 0.3], supported: true}\n"
                               "  drag_left: {value: 0.3, interval_95: [0.2, 0.4], supported: true}\n";

const std::string kMass = begin("mass", "multirotor") +
                          "parameters:\n  mass: {value: 1.7, interval_95: [1.6, 1.8], supported: true}\n";

CalibrationFile fileOf(const std::string& text) {
  return {text, "calibration.yaml", {"calibration.yaml", "xxh64:2", ""}, false};
}

std::string blockOf(const OptionsTarget& target, const std::vector<std::string>& calibrations) {
  std::vector<CalibrationFile> files;
  for (const std::string& text : calibrations) files.push_back(fileOf(text));
  return optionsBlock(target, files);
}

std::string errorOf(const std::string& vehicle, const std::string& calibration) {
  try {
    blockOf({vehicle}, {calibration});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string replaced(std::string text, const std::string& part, const std::string& instead) {
  const std::size_t place = text.find(part);
  EXPECT_NE(place, std::string::npos) << part;
  return text.replace(place, part.size(), instead);
}

TEST(OptionsBlock, AMultirotorTakesLoopsDragAndMass) {
  const YAML::Node yaml = YAML::Load(blockOf({"multirotor"}, {attitude("multirotor"), kRotorDrag, kMass}));
  EXPECT_EQ(yaml["nonlinear"]["roll_gain"].as<double>(), 0.81);
  EXPECT_EQ(yaml["nonlinear"]["roll_time"].as<double>(), 0.31);
  EXPECT_EQ(yaml["nonlinear"]["pitch_gain"].as<double>(), 0.72);
  EXPECT_EQ(yaml["nonlinear"]["pitch_time"].as<double>(), 0.42);
  EXPECT_EQ(yaml["nonlinear"]["drag_x"].as<double>(), 0.2);
  EXPECT_EQ(yaml["nonlinear"]["drag_y"].as<double>(), 0.3);
  EXPECT_FALSE(yaml["nonlinear"]["drag_z"]);
  EXPECT_EQ(yaml["vehicle"]["mass"].as<double>(), 1.7);
  EXPECT_FALSE(yaml["vehicle"]["delay"]);
  EXPECT_NE(yaml["provenance"].as<std::string>().find(
                "vehicle/mass from calibration.yaml (xxh64:2) of a.bag (xxh64:1)"),
            std::string::npos)
      << yaml["provenance"];
}

TEST(OptionsBlock, HoverThrustIsThatOfAShare) {
  const std::string hover =
      begin("mass", "multirotor") +
      "parameters:\n  hover_command: {value: 0.43, interval_95: [0.42, 0.44], supported: true}\n";
  EXPECT_EQ(YAML::Load(blockOf({"multirotor"}, {hover}))["output"]["hover_thrust"].as<double>(), 0.43);
}

TEST(OptionsBlock, AFixedWingTakesEq45AsItsGuidancePredicts) {
  EXPECT_EQ(blockOf({"fixed_wing"}, {attitude("fixed_wing")}).find("model:\n  a0: 11\n  a1: 5\n  b0: 10\n"),
            0u);
  EXPECT_THROW(blockOf({"fixed_wing", true}, {attitude("fixed_wing")}), Error);
}

// A delay that is predicted is compensated; one that is not goes into the lag.
TEST(OptionsBlock, TheDelayGoesWhereItIsPredicted) {
  const YAML::Node yaml = YAML::Load(blockOf({"multirotor", true}, {attitude("multirotor")}));
  EXPECT_NEAR(yaml["vehicle"]["delay"].as<double>(), 0.06, 1e-9);
  EXPECT_EQ(yaml["nonlinear"]["roll_gain"].as<double>(), 0.82);
  EXPECT_EQ(yaml["nonlinear"]["roll_time"].as<double>(), 0.26);
  EXPECT_EQ(yaml["nonlinear"]["pitch_time"].as<double>(), 0.35);
}

TEST(OptionsBlock, RefusesWhatDoesNotFit) {
  EXPECT_NE(errorOf("multirotor", attitude("fixed_wing")).find("vehicle.kind: must be multirotor"),
            std::string::npos);
  EXPECT_NE(errorOf("fixed_wing", attitude("multirotor")).find("vehicle.kind: must be fixed_wing"),
            std::string::npos);
  EXPECT_EQ(errorOf("fixed_wing", replaced(kMass, "multirotor", "unknown")),
            "calibration.yaml: kind mass: has nothing for the options of a fixed_wing");
  const std::string weak = replaced(kMass, "supported: true", "supported: false");
  EXPECT_NE(errorOf("multirotor", weak).find("parameters.mass.supported: the data do not support"),
            std::string::npos);
  const std::string second = "b0: 10, supported: true";
  EXPECT_NE(errorOf("fixed_wing", replaced(attitude("fixed_wing"), second, "b0: 10, supported: false"))
                .find("model_second_order_without_delay.supported: the data do not support"),
            std::string::npos);
}

}  // namespace
}  // namespace polyfly
