#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "mpc_core/apply_calibration.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"
#include "synthetic_flight.hpp"

namespace polyfly {
namespace {

constexpr double kWritten = 1e-7;  // relative, of numbers in eight digits

// The beginning of every calibration file, up to its kind.
std::string head(const std::string& kind) {
  return "polyfly_calibration: 1\nkind: " + kind +
         "\ntool_version: \"1\"\nvehicle: {kind: multirotor, reason: \"It hovers.\"}\n";
}

const std::string kAttitude =
    head("attitude") +
    "data:\n  training: {file: \"a.bag\", checksum: \"xxh64:1\", recorded: \"2016-01-01T00:00:00Z\"}\n"
    "axes:\n"
    "  roll:\n    supported: true\n    model: {gain: 0.8, tau: 0.2, delay: 0.05, supported: true}\n"
    "    model_without_delay: {gain: 0.81, tau: 0.3, supported: true, reasons: []}\n"
    "  pitch:\n    model: {gain: 0.69, tau: 0.33, delay: 0.07, supported: true}\n    model_without_delay: "
    "{gain: 0.7, tau: 0.4, supported: true}\n";

const std::string kDrag = head("drag") +
                          "data: {file: \"b.bag\", checksum: \"x\", recorded: \"\"}\nparameters:\n" +
                          "  drag_x: {value: 0.3, interval_95: [0.2, 0.4], supported: true}\n"
                          "  drag_y: {value: 0.4, interval_95: [0.3, 0.5], supported: true}\n"
                          "  drag_z: {value: 0.1, interval_95: [0.05, 0.15], supported: true}\n";

const std::string kBounds = head("disturbance") +
                            "data: {file: \"b.bag\"}\n"
                            "disturbances:\n  - {name: d_x, range: [-1, 1]}\n  - {name: d_y, range: [-0.21, "
                            "0.33]}\naxes:\n  y: {supported: true}\n";

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

// A delay that is stated is compensated; one that is not goes into the lag.
TEST(ApplyCalibration, theDelayGoesWhereItIsStated) {
  for (const std::size_t axis : {0u, 1u}) {
    const std::string stated = without(problemText(axis), "model:\n", "model:\n  delay: 0\n");
    const AppliedCalibration applied = applyCalibrations(stated, "problem.yaml", {file(kAttitude)});
    const MpcProblem after = parseProblem(applied.problem, "after");
    EXPECT_NEAR(after.delay, axis == 0 ? 0.07 : 0.05, kWritten);
    EXPECT_NEAR(after.A_c(2, 2), -1.0 / (axis == 0 ? 0.33 : 0.2), 1e-6);
    EXPECT_NEAR(after.B_c(2, 0), axis == 0 ? 0.69 / 0.33 : 0.8 / 0.2, 1e-6);
    EXPECT_NE(applied.problem.find("model.delay"), std::string::npos);
  }
  const std::string negative = without(kAttitude, "delay: 0.05", "delay: -0.05");
  EXPECT_NE(
      errorOf(without(problemText(1), "model:\n", "model:\n  delay: 0\n"), negative).find("model.delay"),
      std::string::npos);
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
  const std::string odd = "\n    - " + one + "\n    - {file: \"b.bag\", pilot: me}";
  EXPECT_NE(errorOf(problemText(1), without(kAttitude, one, odd)).find("pilot"), std::string::npos);
  const std::string drag =
      "polyfly_calibration: 1\nkind: drag\ndata:\n  - {file: \"b.bag\", checksum: \"x\", recorded: \"\"}\n"
      "  - {file: \"c.bag\", checksum: \"y\", recorded: \"\"}\nparameters:\n  drag_y: {value: 0.4, "
      "interval_95: [0.3, 0.5], supported: true}\n";
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
  EXPECT_NEAR(parseProblem(applyCalibrations(problemText(1), "p", {file(kDrag)}).problem, "after").A_c(1, 1),
              -0.4, kWritten);
  EXPECT_NEAR(parseProblem(applyCalibrations(problemText(2), "p", {file(kDrag)}).problem, "after").A_c(1, 1),
              -0.1, kWritten);
}

// The drag of a plane: -0.028 with the interval -0.057 .. 0.0015, which is none.
TEST(ApplyCalibration, refusesADragThatIsNotAboveZero) {
  const std::string number = "value: 0.4, interval_95: [0.3, 0.5]";
  const std::string negative = without(kDrag, number, "value: -0.028, interval_95: [-0.057, 0.0015]");
  EXPECT_NE(errorOf(problemText(1), negative).find("parameters.drag_y.value: must not be negative"),
            std::string::npos)
      << errorOf(problemText(1), negative);
  const std::string vague = without(kDrag, number, "value: 0.4, interval_95: [-0.1, 0.9]");
  EXPECT_NE(errorOf(problemText(1), vague).find("parameters.drag_y.interval_95: must be above 0"),
            std::string::npos)
      << errorOf(problemText(1), vague);
  CalibrationFile forced = file(vague);
  forced.force = true;
  EXPECT_NO_THROW(applyCalibrations(problemText(1), "problem.yaml", {forced}));
  forced = file(negative);
  forced.force = true;
  EXPECT_THROW(applyCalibrations(problemText(1), "problem.yaml", {forced}), Error);
}

TEST(ApplyCalibration, boundsGoIntoTheDisturbanceOfTheAxis) {
  const std::string problem =
      "polyfly_problem: 1\nmodel:\n  disturbances:\n    - {name: w_y, unit: m/s^2, range: [-0.5, 0.5]}  # "
      "wind\n";
  const AppliedCalibration applied = applyCalibrations(problem, "robust.yaml", {file(kBounds)});
  EXPECT_NE(applied.problem.find("{name: w_y, unit: m/s^2, range: [-0.21, 0.33]}  # wind"),
            std::string::npos);
}

TEST(ApplyCalibration, takesWhatTheDataDoNotSupportByForceOnly) {
  const std::string sound = "supported: true, reasons: []";
  const std::string weak = without(kAttitude, sound, "supported: false, reasons: [\"Fly longer.\"]");
  const std::string error = errorOf(problemText(1), weak);
  EXPECT_EQ(
      error.find("calibration.yaml:11: axes.roll.model_without_delay.supported: the data do not support"), 0u)
      << error;
  EXPECT_NE(error.find("Fly longer."), std::string::npos);
  EXPECT_EQ(errorOf(problemText(0), weak), "");  // pitch is not concerned
  CalibrationFile forced = file(weak);
  forced.force = true;
  EXPECT_NO_THROW(applyCalibrations(problemText(1), "problem.yaml", {forced}));
  // The flags of the axis and of other models say nothing of this one, and a missing flag is no support.
  const std::string silent = without(kAttitude, sound, "reasons: []");
  EXPECT_NE(errorOf(problemText(1), silent).find("model_without_delay.supported: missing"),
            std::string::npos);
  const std::string problem = "model:\n  disturbances:\n    - {name: w_y, range: [-1, 1]}\n";
  EXPECT_EQ(errorOf(problem, kBounds), "");
  EXPECT_NE(errorOf(problem, without(kBounds, "supported: true", "supported: false")), "");
  EXPECT_NE(errorOf(problem, without(kBounds, "supported: true", "mean: 0")), "");
}

TEST(ApplyCalibration, refusesTheNumbersOfAFixedWing) {
  for (const std::string& calibration : {kAttitude, kDrag}) {
    const std::string wing = without(calibration, "kind: multirotor", "kind: fixed_wing");
    CalibrationFile forced = file(wing);
    forced.force = true;
    try {
      applyCalibrations(problemText(1), "problem.yaml", {forced});
      ADD_FAILURE() << "taken";
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what())
                    .find("calibration.yaml:4: vehicle.kind: must be multirotor for "
                          "problem.yaml, got fixed_wing (It hovers.)"),
                0u)
          << error.what();
    }
    EXPECT_EQ(errorOf(problemText(1), without(calibration, "kind: multirotor", "kind: unknown")), "");
  }
}

TEST(ApplyCalibration, refusesKeysThatItDoesNotKnow) {
  struct Case {
    std::string calibration;
    std::string part;
    std::string instead;
    std::string field;
  };
  for (const Case& one :
       {Case{kAttitude, "axes:", "axis: 1\naxes:", "axis"}, Case{kAttitude, "  roll:", "  rol:", "rol"},
        Case{kAttitude, "model_without_delay", "model_without_dealy", "model_without_dealy"},
        Case{kAttitude, "tau: 0.3,", "tau: 0.3, tua: 0.4,", "tua"},
        Case{kAttitude, "recorded", "record", "record"}, Case{kAttitude, "reason:", "cause:", "cause"},
        Case{kDrag, "drag_y", "drag_yy", "drag_yy"}, Case{kDrag, "interval_95", "interval", "interval"},
        Case{kBounds, "name: d_y,", "name: d_y, range_: 1,", "range_"},
        Case{kBounds, "y: {supported", "y: {suported: true, supported", "suported"}}) {
    const std::string error = errorOf(problemText(1), without(one.calibration, one.part, one.instead));
    EXPECT_EQ(error.find("calibration.yaml:"), 0u) << error;
    EXPECT_NE(error.find(one.field), std::string::npos) << error;
    EXPECT_NE(error.find("unknown"), std::string::npos) << error;
  }
}

// Whether a number below 1 is named. Gains, lags and drags of the problems are such numbers.
bool hasFraction(const std::string& text) {
  for (std::size_t at = text.find("0."); at != std::string::npos; at = text.find("0.", at + 1)) {
    const bool is_start = at == 0 || std::isdigit(static_cast<unsigned char>(text[at - 1])) == 0;
    if (is_start && at + 2 < text.size() && std::isdigit(static_cast<unsigned char>(text[at + 2])) != 0)
      return true;
  }
  return false;
}

// What a comment says of a model is wrong as soon as another one is applied.
TEST(ApplyCalibration, headersOfProblemsNameNoIdentifiedNumber) {
  for (const std::string name :
       {"multirotor_lateral", "multirotor_longitudinal", "multirotor_vertical", "robust/aslquad_lateral",
        "robust/aslquad_longitudinal", "robust/aslquad_vertical"}) {
    const std::string text = readText(std::string(PROBLEMS_FOLDER) + "/" + name + ".yaml");
    const std::string header = text.substr(0, text.find("polyfly_problem:"));
    EXPECT_FALSE(hasFraction(header)) << name << ": " << header;
  }
}

TEST(ApplyCalibration, theGainOfARobustReferenceIsThatOfTheModel) {
  const std::string path = std::string(PROBLEMS_FOLDER) + "/robust/aslquad_lateral.yaml";
  const std::string applied = applyCalibrations(readText(path), path, {file(kAttitude)}).problem;
  EXPECT_NE(applied.find("state: [0, 0, 0.81], input: [1]"), std::string::npos) << applied;
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
  EXPECT_EQ(errorOf("model: [", kAttitude).find("problem.yaml:1: file: is not valid YAML: "), 0u);
  EXPECT_EQ(errorOf("name: a\n", kAttitude), "problem.yaml: model: missing");
  EXPECT_EQ(errorOf("- 1\n", kAttitude), "problem.yaml: must be a map");
  EXPECT_EQ(errorOf(problemText(1), "kind: attitude\n"),
            "calibration.yaml:1: polyfly_calibration: must be 1, as `calibrate` writes it");
  EXPECT_EQ(
      errorOf(problemText(1), "polyfly_calibration: 1\nkind: roll\n"),
      "calibration.yaml:2: kind: must be attitude, drag, disturbance or mass, got 'roll'; thrust, heading "
      "and wind are written by hand, see calibration/README.md");
  EXPECT_EQ(errorOf(problemText(2), kAttitude),
            "calibration.yaml: kind attitude: has nothing for the problem problem.yaml");
  const std::string place = "calibration.yaml:11: axes.roll.model_without_delay.";
  for (const auto& [part, instead, rule] : std::vector<std::array<std::string, 3>>{
           {"gain: 0.81", "gain: .nan", "gain: must be"},
           {"gain: 0.81", "gain: -0.81", "gain: must be greater than 0: wrong sign or frame"},
           {"tau: 0.3", "tau: 0", "tau: must be greater than 0"},
           {"tau: 0.3, supported: true", "tau: 0.3, supported: perhaps",
            "supported: must be true or false"}}) {
    const std::string error = errorOf(problemText(1), without(kAttitude, part, instead));
    EXPECT_EQ(error.find(place + rule), 0u) << error;
  }
}

}  // namespace
}  // namespace polyfly
