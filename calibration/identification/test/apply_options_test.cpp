#include "identification/apply_options.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <sstream>

#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"

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

// As toYaml writes it.
const std::string kThrust =
    begin("thrust", "multirotor") +
    "curve:\n  polynomial: [0.05, 0.03, -0.0002]\n  supported: true\n  reasons: []\n  mass: 1.6\n"
    "  thrusts: [9, 15.5, 22]\n  voltage: 15.6\n  voltage_range: [14.8, 16.4]\n  voltage_matters: true\n"
    "parameters:\n  command_1: {value: 0.3, supported: true}\n";

CalibrationFile fileOf(const std::string& text) {
  return {text, "calibration.yaml", {"calibration.yaml", "xxh64:2", ""}, false};
}

std::string config(const std::string& name) {
  return readText(std::string(CONFIG_FOLDER) + "/" + name + ".yaml");
}

AppliedOptions appliedTo(const std::string& options, const std::vector<std::string>& calibrations) {
  std::vector<CalibrationFile> files;
  for (const std::string& text : calibrations) files.push_back(fileOf(text));
  return applyToOptions(options, "options.yaml", files);
}

std::string errorOf(const std::string& options, const std::string& calibration) {
  try {
    appliedTo(options, {calibration});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// Every line of one text that is no line of the other.
std::vector<std::string> linesBeyond(const std::string& text, const std::string& other) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (other.find(line + "\n") == std::string::npos) lines.push_back(line);
  }
  return lines;
}

std::string replaced(std::string text, const std::string& part, const std::string& instead) {
  const std::size_t place = text.find(part);
  EXPECT_NE(place, std::string::npos) << part;
  return text.replace(place, part.size(), instead);
}

TEST(ApplyToOptions, AMultirotorTakesLoopsDragAndMass) {
  for (const std::string name : {"firefly", "aslquad"}) {
    const std::string before = config(name);
    const AppliedOptions applied = appliedTo(before, {attitude("multirotor"), kRotorDrag, kMass});
    const YAML::Node yaml = YAML::Load(applied.text);
    EXPECT_EQ(yaml["nonlinear"]["roll_gain"].as<double>(), 0.81);
    EXPECT_EQ(yaml["nonlinear"]["roll_time"].as<double>(), 0.31);
    EXPECT_EQ(yaml["nonlinear"]["pitch_gain"].as<double>(), 0.72);
    EXPECT_EQ(yaml["nonlinear"]["pitch_time"].as<double>(), 0.42);
    EXPECT_EQ(yaml["nonlinear"]["drag_x"].as<double>(), 0.2);
    EXPECT_EQ(yaml["nonlinear"]["drag_y"].as<double>(), 0.3);
    EXPECT_FALSE(yaml["nonlinear"]["drag_z"]);
    EXPECT_EQ(yaml["vehicle"]["mass"].as<double>(), 1.7);
    EXPECT_EQ(applied.changes.size(), 7u);
    EXPECT_NE(yaml["provenance"].as<std::string>().find(
                  "vehicle/mass from calibration.yaml (xxh64:2) of a.bag (xxh64:1)"),
              std::string::npos)
        << yaml["provenance"];
    // All that was there is there, but the line of the mass.
    EXPECT_LE(linesBeyond(before, applied.text).size(), 1u);
  }
  EXPECT_NE(appliedTo(config("firefly"), {kMass}).text.find("  mass: 1.7                 # [kg]"),
            std::string::npos);
}

TEST(ApplyToOptions, HoverThrustIsThatOfAShare) {
  const std::string hover =
      begin("mass", "multirotor") +
      "parameters:\n  hover_command: {value: 0.43, interval_95: [0.42, 0.44], supported: true}\n";
  const AppliedOptions applied = appliedTo(config("firefly"), {hover});
  EXPECT_EQ(YAML::Load(applied.text)["output"]["hover_thrust"].as<double>(), 0.43);
}

TEST(ApplyToOptions, AThrustCurveComesWithItsOutputAndItsMass) {
  const std::string before = config("firefly");
  const AppliedOptions applied = appliedTo(before, {kThrust});
  const YAML::Node yaml = YAML::Load(applied.text);
  EXPECT_EQ(yaml["output"]["thrust_polynomial"].as<std::vector<double>>(),
            (std::vector<double>{0.05, 0.03, -0.0002}));
  EXPECT_TRUE(yaml["output"]["attitude_target"].as<bool>());
  EXPECT_EQ(yaml["vehicle"]["mass"].as<double>(), 1.6);
  EXPECT_NE(applied.text.find("[0.05, 0.03, -0.0002]  # flown at 9 to 22 N and 14.8 to 16.4 V\n"),
            std::string::npos)
      << applied.text;
  EXPECT_EQ(applied.changes.size(), 3u);
  // Another curve takes the place of this one, and of its comment.
  const std::string other =
      replaced(replaced(kThrust, "0.03, -0.0002", "0.0295"), "  voltage_range: [14.8, 16.4]\n", "");
  const AppliedOptions again = appliedTo(applied.text, {other});
  EXPECT_NE(again.text.find(
                "thrust_polynomial: [0.05, 0.0295]  # flown at 9 to 22 N and a voltage that is not known\n"),
            std::string::npos)
      << again.text;
  EXPECT_EQ(again.changes,
            std::vector<std::string>{"output/thrust_polynomial: [0.05, 0.03, -0.0002] to [0.05, 0.0295]"});
  EXPECT_EQ(YAML::Load(again.text)["controller"]["stale_periods"].as<int>(), 10);
  // In braces there is no place for a comment.
  const AppliedOptions braces =
      appliedTo(before + "output: {thrust_polynomial: [], attitude_target: no}\n", {kThrust});
  EXPECT_NE(braces.text.find("output: {thrust_polynomial: [0.05, 0.03, -0.0002], attitude_target: true}"),
            std::string::npos)
      << braces.text;
}

TEST(ApplyToOptions, RefusesAThrustCurveThatTheNodeWouldNotFly) {
  const auto refused = [](const std::string& options, const std::string& curve, const std::string& words) {
    const std::string error = errorOf(options, curve);
    EXPECT_NE(error.find(words), std::string::npos) << error;
  };
  const std::string firefly = config("firefly");
  const std::string unsure =
      replaced(kThrust, "supported: true\n  reasons: []", "supported: false\n  reasons: [\"Too little.\"]");
  refused(firefly, unsure, "curve.supported: the data do not support these numbers");
  refused(firefly, unsure, "Too little.");
  // Falls from 28 N on, where 1.6 kg * 20 m/s^2 are asked for.
  const std::string falls = replaced(kThrust, "0.03, -0.0002", "0.028, -0.0005");
  refused(firefly, falls, "controller/thrust_min, controller/thrust_max: the curve must rise from 0 to 1");
  refused(firefly, falls, "which is 5.625 to 13.75 m/s^2");
  refused("vehicle: {mass: 1}\n", kThrust, "controller/thrust_min: must be stated");
  refused(replaced(firefly, "controller:\n", "output:\n  thrust_polynomial: none\ncontroller:\n"), kThrust,
          "output/thrust_polynomial: must be a list in brackets");
  refused(config("techpod"), replaced(kThrust, "multirotor", "unknown"),
          "kind thrust: has nothing for the options");
  refused(config("techpod"), kThrust, "vehicle.kind: must be fixed_wing");
  refused(firefly, replaced(kThrust, "mass: 1.6", "mass: 0"), "curve.mass: must be greater than 0");
  refused(firefly, replaced(kThrust, "[0.05, 0.03, -0.0002]", "[0.05]"),
          "must have two coefficients or more");
  refused(firefly, replaced(kThrust, "  mass:", "  weight: 3\n  mass:"), "weight");
}

TEST(ApplyToOptions, AFixedWingTakesEq45AsItsGuidancePredicts) {
  const std::string before = config("techpod");
  AppliedOptions applied = appliedTo(before, {attitude("fixed_wing")});
  EXPECT_NE(applied.text.find("model: {a0: 11, a1: 5, b0: 10}  # roll loop, identified in flight"),
            std::string::npos)
      << applied.text;
  EXPECT_FALSE(YAML::Load(applied.text)["guidance"]["delay"]);
  applied =
      appliedTo(replaced(before, "period: 0.05", "applied_move: 0, period: 0.05"), {attitude("fixed_wing")});
  const YAML::Node yaml = YAML::Load(applied.text);
  EXPECT_EQ(yaml["model"]["a0"].as<double>(), 14.0);
  EXPECT_EQ(yaml["guidance"]["delay"].as<double>(), 0.05);
  EXPECT_EQ(yaml["guidance"]["airspeed_nominal"].as<double>(), 14.0);
}

// A delay that is stated is compensated; one that is not goes into the lag.
TEST(ApplyToOptions, TheDelayGoesWhereItIsStated) {
  const std::string before = config("firefly");
  AppliedOptions applied = appliedTo(before, {attitude("multirotor")});
  EXPECT_FALSE(YAML::Load(applied.text)["vehicle"]["delay"]);
  EXPECT_EQ(YAML::Load(applied.text)["nonlinear"]["roll_time"].as<double>(), 0.31);
  applied = appliedTo(replaced(before, "vehicle:\n", "vehicle:\n  delay: 0\n"), {attitude("multirotor")});
  const YAML::Node yaml = YAML::Load(applied.text);
  EXPECT_NEAR(yaml["vehicle"]["delay"].as<double>(), 0.06, 1e-9);
  EXPECT_EQ(yaml["nonlinear"]["roll_gain"].as<double>(), 0.82);
  EXPECT_EQ(yaml["nonlinear"]["roll_time"].as<double>(), 0.26);
  EXPECT_EQ(yaml["nonlinear"]["pitch_time"].as<double>(), 0.35);
  EXPECT_NE(yaml["provenance"].as<std::string>().find("vehicle/delay"), std::string::npos);
}

TEST(ApplyToOptions, TwiceIsTheSameNumbersAndBothFilesAreNamed) {
  const AppliedOptions once = appliedTo(config("firefly"), {kMass});
  const AppliedOptions twice = appliedTo(once.text, {kRotorDrag});
  const AppliedOptions again = appliedTo(twice.text, {kMass});
  EXPECT_TRUE(again.changes.empty());
  const std::string provenance = YAML::Load(again.text)["provenance"].as<std::string>();
  EXPECT_EQ(std::count(provenance.begin(), provenance.end(), ';'), 2);
}

TEST(ApplyToOptions, RefusesByFileFieldAndRule) {
  EXPECT_NE(errorOf(config("firefly"), attitude("fixed_wing")).find("vehicle.kind: must be multirotor"),
            std::string::npos);
  EXPECT_NE(errorOf(config("techpod"), attitude("multirotor")).find("vehicle.kind: must be fixed_wing"),
            std::string::npos);
  EXPECT_EQ(errorOf(config("techpod"), replaced(kMass, "multirotor", "unknown")),
            "calibration.yaml: kind mass: has nothing for the options of options.yaml");
  EXPECT_NE(errorOf("model: {a0: 1}\nvehicle: {mass: 1}\n", kMass).find("and not of both"),
            std::string::npos);
  EXPECT_NE(errorOf("rest: 1\n", kMass).find("must hold groups"), std::string::npos);
  EXPECT_EQ(errorOf("vehicle: 3\n", kMass), "options.yaml: vehicle: must be a map");
  EXPECT_EQ(errorOf("vehicle: {mass: heavy}\n", kMass),
            "options.yaml: vehicle/mass: must be a number (decimal digits, without leading zeros)");
  EXPECT_EQ(errorOf("vehicle: {mass: 1}\nprovenance: [1]\n", kMass),
            "options.yaml: provenance: must be a text in double quotes");
  EXPECT_EQ(errorOf("{vehicle: {mass: 1}}\n", kMass), "options.yaml: must not begin with a brace");
  const std::string weak = replaced(kMass, "supported: true", "supported: false");
  EXPECT_NE(errorOf(config("firefly"), weak).find("parameters.mass.supported: the data do not support"),
            std::string::npos);
  const std::string second = "b0: 10, supported: true";
  EXPECT_NE(errorOf(config("techpod"), replaced(attitude("fixed_wing"), second, "b0: 10, supported: false"))
                .find("model_second_order_without_delay.supported: the data do not support"),
            std::string::npos);
}

}  // namespace
}  // namespace polyfly
