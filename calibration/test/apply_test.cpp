#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "mpc_core/apply_calibration.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "polyfly_base/error.hpp"
#include "synthetic_flight.hpp"

namespace polyfly {
namespace {

constexpr double kWritten = 1e-7;  // relative, of numbers in eight digits

const char* const kAttitude =
    "polyfly_calibration: 1\nkind: attitude\ntool_version: \"1\"\n"
    "data:\n  training: {file: \"a.bag\", checksum: \"xxh64:1\", recorded: \"2016-01-01T00:00:00Z\"}\n"
    "axes:\n"
    "  roll:\n    model: {gain: 0.8, tau: 0.2, delay: 0.05}\n    model_without_delay: {gain: 0.81, tau: "
    "0.3}\n"
    "  pitch:\n    model_without_delay: {gain: 0.7, tau: 0.4}\n";

CalibrationFile file(const std::string& text) {
  return {text, "calibration.yaml", {"calibration.yaml", "xxh64:2", ""}, false};
}

std::string problemText(std::size_t axis) { return handMadeMap(axis).problem_text; }

std::string errorOf(const std::string& problem, const std::string& calibration) {
  try {
    applyCalibrations(problem, "problem.yaml", {file(calibration)});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string without(std::string text, const std::string& part, const std::string& instead) {
  const std::size_t place = text.find(part);
  EXPECT_NE(place, std::string::npos) << part;
  return text.replace(place, part.size(), instead);
}

TEST(ApplyCalibration, putsTheLoopOfTheAxisIntoTheModel) {
  for (const std::size_t axis : {0u, 1u}) {
    const MpcProblem before = parseProblem(problemText(axis), "before");
    const AppliedCalibration applied =
        applyCalibrations(problemText(axis), "problem.yaml", {file(kAttitude)});
    const MpcProblem after = parseProblem(applied.problem, "after");
    const double gain = axis == 0 ? 0.7 : 0.81;
    const double tau = axis == 0 ? 0.4 : 0.3;
    EXPECT_NEAR(after.A_c(2, 2), -1.0 / tau, kWritten / tau);
    EXPECT_NEAR(after.B_c(2, 0), gain / tau, kWritten / tau);
    Eigen::MatrixXd rest = after.A_c;
    rest(2, 2) = before.A_c(2, 2);
    EXPECT_EQ(rest, before.A_c);
    EXPECT_EQ(applied.changes.size(), 2u);
    EXPECT_NE(applied.problem.find(
                  "provenance:\n  - {file: \"calibration.yaml\", checksum: \"xxh64:2\", kind: attitude"),
              std::string::npos);
    EXPECT_NE(applied.problem.find("\"a.bag\", \"xxh64:1\", \"2016-01-01T00:00:00Z\""), std::string::npos);
    EXPECT_NE(applied.problem.find("model.A[2][2]"), std::string::npos);
  }
}

TEST(ApplyCalibration, provenanceListsAllFlights) {
  const std::string one = "{file: \"a.bag\", checksum: \"xxh64:1\", recorded: \"2016-01-01T00:00:00Z\"}";
  const std::string several =
      "\n    - " + one + "\n    - {file: \"b.bag\", checksum: \"xxh64:3\", recorded: \"\"}";
  const std::string applied =
      applyCalibrations(problemText(1), "problem.yaml", {file(without(kAttitude, one, several))}).problem;
  EXPECT_NE(
      applied.find(
          "data: [[\"a.bag\", \"xxh64:1\", \"2016-01-01T00:00:00Z\"], [\"b.bag\", \"xxh64:3\", \"\"]],"),
      std::string::npos)
      << applied;
  EXPECT_NO_THROW(parseProblem(applied, "after"));
  const std::string drag =
      "polyfly_calibration: 1\nkind: drag\ndata:\n  - {file: \"b.bag\", checksum: \"x\", recorded: \"\"}\n"
      "  - {file: \"c.bag\", checksum: \"y\", recorded: \"\"}\nparameters:\n  drag_y: {value: 0.4}\n";
  EXPECT_NE(applyCalibrations(problemText(1), "p", {file(drag)})
                .problem.find("data: [[\"b.bag\", \"x\", \"\"], [\"c.bag\", \"y\", \"\"]],"),
            std::string::npos);
}

TEST(ApplyCalibration, twiceIsTheSameNumbersAndBothFilesAreNamed) {
  const AppliedCalibration once = applyCalibrations(problemText(1), "problem.yaml", {file(kAttitude)});
  const AppliedCalibration twice = applyCalibrations(once.problem, "problem.yaml", {file(kAttitude)});
  EXPECT_EQ(twice.problem.substr(0, once.problem.size()), once.problem);
  EXPECT_EQ(twice.problem.find("provenance:"), twice.problem.rfind("provenance:"));
  EXPECT_EQ(parseProblem(twice.problem, "twice").A_c, parseProblem(once.problem, "once").A_c);
}

TEST(ApplyCalibration, dragGoesIntoTheRowOfItsVelocity) {
  const std::string drag =
      "polyfly_calibration: 1\nkind: drag\ndata: {file: \"b.bag\", checksum: \"x\", recorded: \"\"}\n"
      "parameters:\n  drag_x: {value: 0.3}\n  drag_y: {value: 0.4}\n  drag_z: {value: -0.1}\n";
  EXPECT_NEAR(parseProblem(applyCalibrations(problemText(1), "p", {file(drag)}).problem, "after").A_c(1, 1),
              -0.4, kWritten);
  EXPECT_EQ(parseProblem(applyCalibrations(problemText(2), "p", {file(drag)}).problem, "after").A_c(1, 1),
            0.0);
}

TEST(ApplyCalibration, boundsGoIntoTheDisturbanceOfTheAxis) {
  const std::string problem =
      "polyfly_problem: 1\nmodel:\n  disturbances:\n    - {name: w_y, unit: m/s^2, range: [-0.5, 0.5]}  # "
      "wind\n";
  const std::string bounds =
      "polyfly_calibration: 1\nkind: disturbance\ndata: {file: \"b.bag\"}\n"
      "disturbances:\n  - {name: d_x, range: [-1, 1]}\n  - {name: d_y, range: [-0.21, 0.33]}\n";
  const AppliedCalibration applied = applyCalibrations(problem, "robust.yaml", {file(bounds)});
  EXPECT_NE(applied.problem.find("{name: w_y, unit: m/s^2, range: [-0.21, 0.33]}  # wind"),
            std::string::npos);
}

TEST(ApplyCalibration, takesWhatTheDataDoNotSupportByForceOnly) {
  const std::string weak = without(kAttitude, "  roll:\n",
                                   "  roll:\n    supported: false\n    warnings:\n      - \"Fly longer.\"\n");
  const std::string error = errorOf(problemText(1), weak);
  EXPECT_EQ(error.find("calibration.yaml: axes.roll: the data do not support these numbers"), 0u) << error;
  EXPECT_NE(error.find("Fly longer."), std::string::npos);
  EXPECT_EQ(errorOf(problemText(0), weak), "");  // pitch is not concerned
  CalibrationFile forced = file(weak);
  forced.force = true;
  EXPECT_NO_THROW(applyCalibrations(problemText(1), "problem.yaml", {forced}));
  const std::string bounds =
      "polyfly_calibration: 1\nkind: disturbance\ndata: {file: \"b.bag\"}\n"
      "disturbances:\n  - {name: d_y, range: [-0.21, 0.33]}\naxes:\n  y: {supported: false}\n";
  EXPECT_NE(errorOf("model:\n  disturbances:\n    - {name: w_y, range: [-1, 1]}\n", bounds), "");
  EXPECT_EQ(errorOf("model:\n  disturbances:\n    - {name: w_y, range: [-1, 1]}\n",
                    without(bounds, "false", "true")),
            "");
}

class IncludedCalibration : public testing::Test {
 protected:
  IncludedCalibration() {
    folder_ = std::filesystem::temp_directory_path() / ("polyfly_include_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_ / "flights");
    write("flights/attitude.yaml", kAttitude);
  }
  ~IncludedCalibration() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string errorOfLoading() const {
    try {
      loadProblem(path("problem.yaml"));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
};

TEST_F(IncludedCalibration, givesWhatApplyGives) {
  const MpcProblem applied =
      parseProblem(applyCalibrations(problemText(1), "problem.yaml", {file(kAttitude)}).problem, "applied");
  for (const char* key :
       {"calibration: flights/attitude.yaml  # of today\n", "calibration: [flights/attitude.yaml]\n",
        "calibration:\n  - flights/attitude.yaml\n"}) {
    write("problem.yaml", key + problemText(1));
    const MpcProblem included = loadProblem(path("problem.yaml"));
    EXPECT_EQ(included.A_c, applied.A_c);
    EXPECT_EQ(included.B_c, applied.B_c);
    // What the map carries needs no other file, and tells where its numbers are from.
    EXPECT_EQ(parseProblem(included.text, "map").A_c, applied.A_c);
    EXPECT_NE(included.text.find("provenance:\n  - {file: \"attitude.yaml\", checksum: \"xxh64:"),
              std::string::npos);
    EXPECT_NE(loadProgram(path("problem.yaml")).text.find("provenance:"), std::string::npos);
  }
}

TEST_F(IncludedCalibration, errorsNameFileFieldAndRule) {
  write("problem.yaml", "calibration: flights/nowhere.yaml\n" + problemText(1));
  EXPECT_EQ(errorOfLoading(), path("problem.yaml") + ":1: calibration: must name a file that is there, not " +
                                  path("flights/nowhere.yaml"));
  write("problem.yaml", "calibration: []\n" + problemText(1));
  EXPECT_NE(errorOfLoading().find("calibration"), std::string::npos);
  write("problem.yaml", "calibration: flights/attitude.yaml\n" + problemText(2));
  EXPECT_NE(errorOfLoading().find("has nothing for the problem"), std::string::npos);
  // From text there is no folder to look in.
  EXPECT_THROW(parseProblem("calibration: a.yaml\n" + problemText(1), "text"), Error);
}

TEST(ApplyCalibration, refusesWhatDoesNotFitByFileFieldAndRule) {
  EXPECT_EQ(errorOf("model: [", kAttitude).substr(0, 25), "problem.yaml: is no YAML:");
  EXPECT_EQ(errorOf("name: a\n", kAttitude), "problem.yaml: model: missing");
  EXPECT_EQ(errorOf(problemText(1), "kind: attitude\n"),
            "calibration.yaml: polyfly_calibration: must be 1, as `calibrate` writes it");
  EXPECT_EQ(errorOf(problemText(1), "polyfly_calibration: 1\nkind: wind\n"),
            "calibration.yaml: kind: must be attitude, drag or disturbance, got 'wind'");
  EXPECT_EQ(errorOf(problemText(2), kAttitude),
            "calibration.yaml: kind attitude: has nothing for the problem problem.yaml");
  EXPECT_EQ(errorOf(problemText(1), without(kAttitude, "gain: 0.81", "gain: .nan")),
            "calibration.yaml: axes.roll.model_without_delay.gain: must be a finite number");
  EXPECT_EQ(
      errorOf(problemText(1), without(kAttitude, "gain: 0.81", "gain: -0.81")),
      "calibration.yaml: axes.roll.model_without_delay.gain: must be greater than 0: wrong sign or frame");
  EXPECT_EQ(errorOf(problemText(1), without(kAttitude, "tau: 0.3", "tau: 0")),
            "calibration.yaml: axes.roll.model_without_delay.tau: must be greater than 0");
}

}  // namespace
}  // namespace polyfly
