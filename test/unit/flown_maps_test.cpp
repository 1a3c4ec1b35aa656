// Maps of each kind of problem that an axis may have: flown, recorded, replayed, and compared with the program solved
// online.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "polyfly_test/multirotor_plant.hpp"
#include "recorded_flight.hpp"
#include "second_order.hpp"
#include "solved_maps.hpp"
#include "validation/validation.hpp"

namespace polyfly {
namespace {

using Problems = std::array<MpcProblem, 3>;

constexpr double kAgreement = 1e-6;  // of a map and its problem solved online

/// The shipped problem of an axis with blocked moves.
std::string blockedText(const std::string& axis, const std::string& moves = "moves: [1, 2, 17]") {
  return replaced(readText(problemFile("multirotor_" + axis + ".yaml")),
                  "\nweights:", "\n" + moves + "\n\nweights:");
}

/// The problems of a multirotor whose lateral axis is `lateral`.
Problems withLateral(const std::string& lateral) {
  return {parseProblem(blockedText("longitudinal"), "longitudinal"), parseProblem(lateral, "lateral"),
          parseProblem(blockedText("vertical"), "vertical")};
}

std::string withReference(const std::string& text, const std::string& line) {
  return replaced(text, "\nparameters:\n", "\nparameters:\n  - " + line + "\n");
}

std::string withConstraint(const std::string& text, const std::string& line) {
  return replaced(text, "\nparameters:\n", "\nconstraints:\n  - " + line + "\n\nparameters:\n");
}

constexpr const char* kSpeedReference =
    "{name: v_y_ref, role: state_reference, of: v_y, unit: m/s, range: [-1, 1]}";

/// "[[1, 2], [3, 4]]", exactly.
std::string rowsText(const Eigen::MatrixXd& matrix) {
  std::ostringstream text;
  text << matrix.format(
      {std::numeric_limits<double>::max_digits10, Eigen::DontAlignCols, ", ", ", ", "[", "]", "[", "]"});
  return text.str();
}

/// The problem with its model over one sampling time.
std::string discreteText(std::string text) {
  const MpcProblem problem = parseProblem(text, "continuous");
  const DiscreteModel model = discretise(problem, problem.sampling_time);
  const std::size_t from = text.find("  A:");
  return text.replace(from, text.find("  C:") - from,
                      "  time: discrete\n  A: " + rowsText(model.A) + "\n  B: " + rowsText(model.B) +
                          "\n  B_d: " + rowsText(model.Bd) + "\n");
}

/// What an axis' problem may say, by name.
Problems problemsOf(const std::string& kind) {
  const std::string blocked = blockedText("lateral");
  const std::string input = "range: [-0.4363323, 0.4363323]}  # 25 degrees";
  if (kind == "blocked_moves") return withLateral(blocked);
  if (kind == "control_horizon") return withLateral(blockedText("lateral", "control_horizon: 2"));
  if (kind == "soft_speed") return withLateral(readText(problemFile("lateral_speed_limit.yaml")));
  if (kind == "hard_speed")
    return withLateral(
        withConstraint(withReference(blocked, kSpeedReference), "{of: v_y, range: [-1.2, 1.2]}"));
  if (kind == "bounded_error") {
    return withLateral(
        replaced(blocked, "{name: v_y, unit: m/s}", "{name: v_y, unit: m/s, range: [-1.2, 1.2]}"));
  }
  if (kind == "general_row") {
    return withLateral(withConstraint(
        blocked,
        "{name: sum, of: {phi_cmd: 1, v_y: -0.05}, unit: rad, upper: 0.2, measured_from: reference, "
        "soft: {linear: 50, quadratic: 5, slack: horizon}}"));
  }
  if (kind == "limited_change") {
    return withLateral(
        replaced(blocked, input, "range: [-0.4363323, 0.4363323], change: [-0.05, 0.05]}  # 25 degrees"));
  }
  if (kind == "terminal_set") {
    return withLateral(
        replaced(replaced(blocked, "terminal: riccati", "terminal: [400, 100, 40]"), "\nparameters:\n",
                 "\nterminal_set: {T: [[0, 0, 1], [0, 0, -1]], t: [0.05, 0.05]}\n\nparameters:\n"));
  }
  if (kind == "discrete") return withLateral(discreteText(blocked));
  if (kind == "look_ahead") {
    return {loadProblem(problemFile("look_ahead/longitudinal.yaml")),
            loadProblem(problemFile("look_ahead/lateral.yaml")),
            loadProblem(problemFile("look_ahead/vertical.yaml"))};
  }
  return {secondOrderTracking("longitudinal", "moves: [1, 2, 17]\n"),
          secondOrderTracking("lateral", "moves: [1, 2, 17]\n"),
          parseProblem(blockedText("vertical"), "vertical")};
}

class FlownMaps : public testing::TestWithParam<const char*> {
 protected:
  FlownMaps()
      : problems_(problemsOf(GetParam())),
        opened_(solvedMaps(problems_, std::string("flown_maps_test_") + GetParam() + "_")),
        maps_{&opened_[0], &opened_[1], &opened_[2]} {}

  Problems problems_;
  std::vector<RegionMap> opened_;
  AxisMaps maps_;
};

TrajectorySample pointAt(double time, const Eigen::Vector3d& position, const Eigen::Vector3d& velocity) {
  TrajectorySample point;
  point.time = time;
  point.position = position;
  point.velocity = velocity;
  point.has_velocity = true;
  return point;
}

/// A flight that begins beyond the range of e_p_y, and where the kind of problem shows.
struct Begin {
  ReferenceTrajectory trajectory;
  Eigen::Vector3d position, velocity;  ///< of the vehicle [m, m/s]
};

/// Behind a reference of 3 m/s; or from rest to a rest that moves on.
Begin beginOf(const std::string& kind) {
  const Eigen::Vector3d none = Eigen::Vector3d::Zero(), first(0.0, 0.0, 1.0), second(0.6, -0.5, 1.3);
  if (kind == "soft_speed") {
    const Eigen::Vector3d fast(0.0, 3.0, 0.0);
    return {ReferenceTrajectory({pointAt(0.0, first, fast), pointAt(6.0, first + 6.0 * fast, fast)}),
            {0.1, -3.4, 0.9},
            fast};
  }
  return {ReferenceTrajectory({pointAt(0.0, first, none), pointAt(2.0, first, none),
                               pointAt(4.0, second, none), pointAt(6.0, second, none)}),
          {0.4, 3.1, 0.7},
          none};
}

FlightLog flown(const std::string& kind, const AxisMaps& maps) {
  const MultirotorOptions options;
  const Begin begin = beginOf(kind);
  const Eigen::Vector3d wind(0.4, -0.3, 0.1);
  constexpr double kSeconds = 5.0;
  if (kind == "second_order") {
    SecondOrderPlant::State start;
    start.position = begin.position;
    SecondOrderPlant plant(start, 0.3, wind, options.mass);
    return recordedFlight(maps, options, begin.trajectory, plant, kSeconds);
  }
  PlantOptions plant_options;
  plant_options.wind = wind;
  PlantState start;
  start.position = begin.position;
  start.velocity = begin.velocity;
  start.thrust = plant_options.gravity;
  MultirotorPlant plant(plant_options, start);
  return recordedFlight(maps, options, begin.trajectory, plant, kSeconds);
}

TEST_P(FlownMaps, AreReplayedAndAnswerAsTheirProblemsSolvedOnline) {
  const FlightLog log = flown(GetParam(), maps_);
  const MultirotorOptions options;
  const std::vector<ReplaySample> samples = replay(log, maps_, options);
  const ValidationReport report = validate(log, samples, maps_, options);
  ASSERT_EQ(report.samples, log.odometry.size());
  EXPECT_EQ(report.commands.max_difference, 0.0);
  EXPECT_EQ(report.statuses.differing, 0u);
  EXPECT_EQ(report.statuses.max_theta_difference, 0.0);
  EXPECT_EQ(report.statuses.replayed[static_cast<std::size_t>(ControlStatus::kOptimal)], report.samples);
  // The flight begins beyond the lateral map, where the problem is solved online.
  EXPECT_GT(report.outside_map_samples, 5u);
  EXPECT_GT(report.coverage, 0.8);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const AxisValidation& of = report.axes.at(axis);
    EXPECT_EQ(of.qp_compared, of.inside) << of.axis;
    EXPECT_LT(of.qp.max, kAgreement) << of.axis;
  }
  EXPECT_GT(report.axes[1].visited(), 1u);
  for (const ParameterUse& parameter : report.axes[1].parameters) {
    if (parameter.name != "d_y_ahead") continue;
    EXPECT_GT(parameter.greatest - parameter.least, 0.1);
  }
  EXPECT_LT((samples.back().state.position - samples.back().reference.position).norm(), 0.2);
}

// A node whose laws read references at other times turns look-ahead off, and so does the replay.
TEST(FlownMapsThatLookAhead, AreReplayedAtTheTimesThatTheNodeReads) {
  const std::vector<RegionMap> opened = solvedMaps(problemsOf("look_ahead"), "flown_maps_test_times_");
  const AxisMaps maps{&opened[0], &opened[1], &opened[2]};
  const FlightLog log = flown("look_ahead", maps);
  MultirotorOptions options;
  const std::vector<ReplaySample> other = replay(log, maps, options, 0.05);
  EXPECT_GT(validate(log, other, maps, options).commands.max_difference, 1e-3);
  options.look_ahead = false;
  const std::vector<ReplaySample> without = replay(log, maps, options);
  ASSERT_EQ(other.size(), without.size());
  for (std::size_t i = 0; i < other.size(); ++i)
    ASSERT_EQ(other[i].report.command.roll, without[i].report.command.roll) << i;
}

/// The record without what it has from `from` on for so long [s]. Its trajectory starts at `start`.
FlightLog without(const FlightLog& whole, const std::optional<double>& start, double from, double length) {
  FlightLog log;
  log.add(whole.references[0].trajectory, start);
  for (std::size_t sample = 0; sample < whole.odometry.size(); ++sample) {
    const double time = whole.odometry[sample].stamp - whole.odometry[0].stamp;
    if (time >= from && time < from + length) continue;
    log.add(whole.odometry[sample]);
    log.commands.push_back(whole.commands[sample]);
    log.statuses.push_back(whole.statuses[sample]);
    log.statuses.back().sequence = static_cast<std::uint32_t>(sample);
  }
  return log;
}

// A second of the record is lost, or it begins in flight. What the controller knew comes back by what it sent.
TEST(FlownMapsOfPartsOfARecord, AgreeAgainAfterSomeSeconds) {
  const std::vector<RegionMap> opened = solvedMaps(problemsOf("blocked_moves"), "flown_maps_test_parts_");
  const AxisMaps maps{&opened[0], &opened[1], &opened[2]};
  MultirotorOptions options;
  options.adapt_model = false;
  PlantOptions plant_options;
  plant_options.wind = {0.4, -0.3, 0.1};
  PlantState start;
  start.thrust = plant_options.gravity;
  MultirotorPlant plant(plant_options, start);
  const FlightLog whole =
      recordedFlight(maps, options, ReferenceTrajectory::pose({0.3, 0.2, 0.1}, 0.0), plant, 40.0);
  for (const double from : {0.0, 10.0}) {
    const FlightLog log = without(whole, std::nullopt, from, 1.0);
    const ValidationReport report = validate(log, replay(log, maps, options), maps, options);
    ASSERT_EQ(report.incomparable.size(), 1u);
    EXPECT_LT(report.incomparable[0].to, whole.odometry[0].stamp + from + 25.0);
    EXPECT_TRUE(brokenThresholds(report, {}).empty());
    EXPECT_EQ(report.verdict(), Verdict::kDoubtful);
  }
}

/// Back and forth for 20 s, a rest of 40 s, and back and forth again.
ReferenceTrajectory shuttleTwice() {
  std::vector<TrajectorySample> points;
  for (const double start : {0.0, 60.0}) {
    for (int step = 0; step <= 80; ++step) {
      const double time = 0.25 * step;
      constexpr double kRate = 2.0 * 3.14159265358979 / 5.0;  // [rad/s]
      points.push_back(pointAt(start + time, {0.0, 0.4 * (1.0 - std::cos(kRate * time)), 1.0},
                               {0.0, 0.4 * kRate * std::sin(kRate * time), 0.0}));
    }
  }
  return ReferenceTrajectory(points);
}

// What the law had learnt before the hole is in no record.
TEST(FlownMapsOfPartsOfARecord, AreDoubtfulWithWhatALawHasLearnt) {
  const std::vector<RegionMap> opened = solvedMaps(problemsOf("blocked_moves"), "flown_maps_test_learnt_");
  const AxisMaps maps{&opened[0], &opened[1], &opened[2]};
  const MultirotorOptions options;
  PlantOptions plant_options;
  plant_options.wind = {0.4, -0.3, 0.1};
  plant_options.roll_gain *= 0.8;
  PlantState start;
  start.position.z() = 1.0;
  start.thrust = plant_options.gravity;
  MultirotorPlant plant(plant_options, start);
  const FlightLog whole = recordedFlight(maps, options, shuttleTwice(), plant, 80.0);
  EXPECT_EQ(validate(whole, replay(whole, maps, options), maps, options).commands.max_difference, 0.0);
  for (const double from : {0.0, 18.0}) {
    const FlightLog log = without(whole, whole.odometry[0].stamp, from, from > 0.0 ? 1.0 : 18.0);
    const ValidationReport report = validate(log, replay(log, maps, options), maps, options);
    EXPECT_FALSE(report.incomparable.empty());
    EXPECT_FALSE(report.isWhole());
    EXPECT_TRUE(brokenThresholds(report, {}).empty());
    EXPECT_EQ(report.verdict(), Verdict::kDoubtful);
  }
}

/// Greatest difference of the lateral inputs of two laws that answer the same flight, one reference at a time.
double greatestDifference(MultirotorController one, MultirotorController other, const FlightLog& log) {
  const ReferenceTrajectory& trajectory = log.references.front().trajectory;
  double greatest = 0.0;
  for (const VehicleState& state : log.odometry) {
    const Reference reference = trajectory.sample(state.stamp);
    const ControlReport& a = one.step(state, reference);
    const ControlReport& b = other.step(state, reference);
    EXPECT_EQ(a.status, ControlStatus::kOptimal);
    EXPECT_EQ(b.status, ControlStatus::kOptimal);
    greatest = std::max(greatest, std::abs(a.axis[1].input - b.axis[1].input));
  }
  return greatest;
}

// The law that solves the same problems online, on the flight of the maps. And the flight shows what a problem says: without
// it another command is the best.
TEST_P(FlownMaps, AnswerAsTheLinearLaw) {
  const FlightLog log = flown(GetParam(), maps_);
  MultirotorOptions options;
  options.look_ahead = false;
  EXPECT_LT(greatestDifference({maps_, options}, {problems_, options}, log), kAgreement);
  const Problems plain = withLateral(blockedText("lateral"));
  const double difference = greatestDifference({problems_, options}, {plain, options}, log);
  const bool same = std::string(GetParam()) == "blocked_moves" || std::string(GetParam()) == "discrete";
  if (same) {
    EXPECT_LT(difference, kAgreement);
  } else {
    EXPECT_GT(difference, 1e-3);
  }
}

double greatestSpeed(const std::string& kind) {
  const std::vector<RegionMap> maps = solvedMaps(problemsOf(kind), "flown_maps_test_speed_of_" + kind + "_");
  double greatest = 0.0;
  for (const VehicleState& state : flown("soft_speed", {&maps[0], &maps[1], &maps[2]}).odometry)
    greatest = std::max(greatest, std::abs(state.velocity.y()));
  return greatest;
}

// The limit is 5 m/s.
TEST(FlownMapsOfASpeedLimit, KeepTheLimit) {
  const double limited = greatestSpeed("soft_speed"), free = greatestSpeed("blocked_moves");
  EXPECT_LT(limited, 5.05);
  EXPECT_GT(free, 5.2);
}

INSTANTIATE_TEST_SUITE_P(Kinds, FlownMaps,
                         testing::Values("blocked_moves", "control_horizon", "soft_speed", "hard_speed",
                                         "bounded_error", "general_row", "limited_change", "terminal_set",
                                         "discrete", "look_ahead", "second_order"),
                         [](const auto& kind) { return std::string(kind.param); });

}  // namespace
}  // namespace polyfly
