#include <algorithm>
#include <cmath>
#include <cstdio>

#include "identification/motion.hpp"
#include "motion_judgement.hpp"
#include "polyfly_base/error.hpp"
#include "regression.hpp"

namespace polyfly {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;  // [rad]
const char* const kMotionAxes[] = {"x", "y", "z"};
// Least root mean square of velocity [m/s] and of acceleration [m/s^2].
constexpr double kLeastMotion = 0.1;
// Deviation below which nothing can be said about the frame [m/s^2].
constexpr double kLeastExpected = 0.1;
// Least correlation of measured and expected acceleration.
constexpr double kLeastCorrelation = 0.5;
// Greatest half width of a confidence interval [1/s].
constexpr double kVagueDrag = 0.1;
// Greatest half width of the interval of a heading misalignment [rad].
constexpr double kVagueHeading = 0.05;
// Misalignment of the heading from which on commands go astray: 2 degrees [rad].
constexpr double kGreatestMisalignment = 0.035;
// Greatest difference of the misalignments of the two halves of a flight, beyond their intervals [rad].
constexpr double kHeadingDrift = 0.02;
// Acceleration by what the tilt makes expect: beyond these, the two are not of one vehicle.
constexpr double kLeastHeadingScale = 0.5, kGreatestHeadingScale = 2.0;
// Greatest half width of a confidence interval, relative to the value.
constexpr double kVagueShare = 0.3;

std::vector<Eigen::Index> indices(const std::vector<std::size_t>& starts) {
  return {starts.begin(), starts.end()};
}

std::vector<double> list(const Eigen::VectorXd& values) {
  return {values.data(), values.data() + values.size()};
}

double rms(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, values.size())));
}

template <class... Values>
std::string sentence(const char* format, Values... values) {
  char buffer[320];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

MotionTrace traceOf(const Motion& motion, const std::string& name, const std::string& unit,
                    const Eigen::VectorXd& measured, const Eigen::VectorXd& modelled) {
  return {name, unit, "", motion.time, motion.starts, list(measured), list(modelled), {}};
}

FittedParameter parameterOf(const std::string& name, const std::string& unit, const Regression& found,
                            Eigen::Index index, double scale = 1.0) {
  return {name, unit, scale * found.coefficients[index], scale * found.standard_errors[index],
          scale * found.half_widths[index]};
}

// Whether the vehicle accelerates along an axis where it tilts at all.
std::string checkFrame(const Motion& motion, Eigen::Index axis) {
  const Eigen::VectorXd one = motion.acceleration.col(axis).array() - motion.acceleration.col(axis).mean();
  const Eigen::VectorXd other = motion.expected.col(axis).array() - motion.expected.col(axis).mean();
  if (rms(other) < kLeastExpected) return "";
  const double correlation = one.dot(other) / std::max(one.norm() * other.norm(), kLeastExpected);
  if (correlation >= kLeastCorrelation) return "";
  return sentence(
      "Along %s the acceleration hardly follows the attitude (correlation %.2f, deviation expected %.2g "
      "m/s^2): angles or velocities are in another frame, or of another sign.",
      kMotionAxes[axis], correlation, rms(other));
}

void checkDrag(FittedParameter& drag, std::vector<std::string>* warnings) {
  const double allowed = std::max(kVagueDrag, kVagueShare * std::abs(drag.value));
  // An error of zero is that of a velocity that never changed.
  if (!(drag.half_width > 0.0 && drag.half_width <= allowed)) {
    warnings->push_back(
        sentence("%s is not bounded by these data: %.2g +- %.2g 1/s. Fly fast and straight in calm air.",
                 drag.name.c_str(), drag.value, drag.half_width));
    drag.supported = false;
  } else if (!(drag.least() > 0.0)) {
    drag.supported = false;
    warnings->push_back(sentence(
        drag.greatest() < 0.0
            ? "%s is negative: wind pushed the vehicle along, or angles and velocities are of another frame."
            : "The 95 %% interval of %s is not above zero: these data do not tell it from no drag.",
        drag.name.c_str()));
  }
}

// First rows of the stretches where two axes stand one below the other, and the number of rows.
std::vector<Eigen::Index> stackedStarts(const Motion& motion) {
  std::vector<Eigen::Index> starts = indices(motion.starts);
  for (const std::size_t start : motion.starts) {
    if (start > 0) starts.push_back(motion.velocity.rows() + static_cast<Eigen::Index>(start));
  }
  return starts;
}

// Drag along heading and left of the body: a - expected = -R D R' v + d, both horizontal axes of W one below
// the other, with R the turn by the yaw.
void fitRotorDrag(const Motion& motion, bool sound, MotionFit* result) {
  const Eigen::Index rows = motion.velocity.rows();
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(2 * rows, 4);
  Eigen::VectorXd left(2 * rows);
  const Eigen::ArrayXd cosine = motion.yaw.array().cos();
  const Eigen::ArrayXd sine = motion.yaw.array().sin();
  const Eigen::ArrayXd forward =
      cosine * motion.velocity.col(0).array() + sine * motion.velocity.col(1).array();
  const Eigen::ArrayXd sideways =
      cosine * motion.velocity.col(1).array() - sine * motion.velocity.col(0).array();
  columns.col(0).head(rows) = -(cosine * forward).matrix();
  columns.col(0).tail(rows) = -(sine * forward).matrix();
  columns.col(1).head(rows) = (sine * sideways).matrix();
  columns.col(1).tail(rows) = -(cosine * sideways).matrix();
  columns.col(2).head(rows).setOnes();
  columns.col(3).tail(rows).setOnes();
  left << motion.acceleration.col(0) - motion.expected.col(0),
      motion.acceleration.col(1) - motion.expected.col(1);
  const Regression found = regress(columns, left, stackedStarts(motion));
  for (const auto& [name, column] :
       {std::pair<const char*, Eigen::Index>{"drag_forward", 0}, {"drag_left", 1}}) {
    result->parameters.push_back(parameterOf(name, "1/s", found, column));
    result->parameters.back().supported = sound;
    checkDrag(result->parameters.back(), &result->warnings);
  }
}

}  // namespace

void judgeDrag(FittedParameter& drag, std::vector<std::string>* warnings) { checkDrag(drag, warnings); }

void judgeMass(std::vector<FittedParameter>* parameters, std::vector<std::string>* warnings) {
  const FittedParameter& first = parameters->front();
  if (first.half_width <= kVagueShare * std::abs(first.value) && first.least() > 0.0) return;
  for (FittedParameter& parameter : *parameters) parameter.supported = false;
  warnings->push_back(sentence("%s is not bounded by these data: %.2g +- %.2g.", first.name.c_str(),
                               first.value, first.half_width));
}

std::vector<std::string> checkMotion(const Motion& motion) {
  std::vector<std::string> warnings;
  const double speed = std::sqrt(motion.velocity.rowwise().squaredNorm().mean());
  const double acceleration = std::sqrt(motion.acceleration.rowwise().squaredNorm().mean());
  if (speed < kLeastMotion && acceleration < kLeastMotion) {
    warnings.push_back(
        sentence("The vehicle hardly moves (%.2g m/s, %.2g m/s^2 rms): it stands on the ground, or this "
                 "flight says nothing of its motion.",
                 speed, acceleration));
  }
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    const std::string frame = checkFrame(motion, axis);
    if (!frame.empty()) warnings.push_back(frame);
  }
  return warnings;
}

std::vector<MotionTrace> disturbanceTraces(const Motion& motion, const MotionOptions& options) {
  std::vector<MotionTrace> traces;
  for (Eigen::Index axis = 0; axis < (motion.thrust_known ? 3 : 2); ++axis) {
    traces.push_back(traceOf(motion, std::string("acceleration along ") + kMotionAxes[axis], "m/s^2",
                             motion.acceleration.col(axis),
                             motion.expected.col(axis) - options.drag[axis] * motion.velocity.col(axis)));
  }
  return traces;
}

MotionFit fitDrag(const Motion& motion) {
  MotionFit result;
  result.warnings = checkMotion(motion);
  const bool sound = result.warnings.empty();
  for (Eigen::Index axis = 0; axis < (motion.thrust_known ? 3 : 2); ++axis) {
    Eigen::MatrixXd columns(motion.velocity.rows(), 2);
    columns.col(0) = -motion.velocity.col(axis);
    columns.col(1).setOnes();
    const Eigen::VectorXd left = motion.acceleration.col(axis) - motion.expected.col(axis);
    const Regression found = regress(columns, left, indices(motion.starts));
    const std::string name = kMotionAxes[axis];
    result.parameters.push_back(parameterOf("drag_" + name, "1/s", found, 0));
    result.parameters.back().supported = sound;
    checkDrag(result.parameters.back(), &result.warnings);
    result.parameters.push_back(parameterOf("offset_" + name, "m/s^2", found, 1));
    MotionTrace trace = traceOf(motion, "unexplained acceleration along " + name, "m/s^2", left,
                                columns * found.coefficients);
    trace.against = "velocity along " + name + " [m/s]";
    trace.depends = list(motion.velocity.col(axis));
    result.traces.push_back(std::move(trace));
  }
  fitRotorDrag(motion, sound, &result);
  return result;
}

namespace {

// The angle, and what it was found with.
struct HeadingFit {
  FittedParameter angle;
  double scale = 0.0;  // of the acceleration, by what the tilt makes expect
  double tilt = 0.0;   // root mean square of the horizontal thrust [m/s^2]
  Eigen::VectorXd modelled;
};

HeadingFit findHeading(const Motion& motion) {
  const Eigen::Index rows = motion.velocity.rows();
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(2 * rows, 5);
  columns.col(0) << motion.expected.col(0), motion.expected.col(1);
  columns.col(1) << -motion.expected.col(1), motion.expected.col(0);
  columns.col(2) << -motion.velocity.col(0), -motion.velocity.col(1);
  columns.col(3).head(rows).setOnes();
  columns.col(4).tail(rows).setOnes();
  Eigen::VectorXd measured(2 * rows);
  measured << motion.acceleration.col(0), motion.acceleration.col(1);
  const Regression found = regress(columns, measured, stackedStarts(motion));
  const double cosine = found.coefficients[0];
  const double sine = found.coefficients[1];
  // Of the angle of (cosine, sine), whose errors are taken as independent: they are by symmetry.
  const auto across = [&](const Eigen::VectorXd& errors) {
    return std::hypot(cosine * errors[1], sine * errors[0]) / (cosine * cosine + sine * sine);
  };
  return {{"heading_misalignment", "rad", std::atan2(sine, cosine), across(found.standard_errors),
           across(found.half_widths)},
          std::hypot(cosine, sine),
          rms(columns.col(0)) * std::sqrt(2.0),
          columns * found.coefficients};
}

// The rows from `first` on, `count` of them.
Motion partOf(const Motion& motion, Eigen::Index first, Eigen::Index count) {
  Motion part;
  part.starts = {0};
  for (const std::size_t start : motion.starts) {
    const Eigen::Index row = static_cast<Eigen::Index>(start) - first;
    if (row > 0 && row < count) part.starts.push_back(static_cast<std::size_t>(row));
  }
  part.starts.push_back(static_cast<std::size_t>(count));
  part.acceleration = motion.acceleration.middleRows(first, count);
  part.expected = motion.expected.middleRows(first, count);
  part.velocity = motion.velocity.middleRows(first, count);
  return part;
}

// Whether both halves of a flight tell the same angle.
bool isSteady(const Motion& motion) {
  const Eigen::Index half = motion.velocity.rows() / 2;
  const FittedParameter one = findHeading(partOf(motion, 0, half)).angle;
  const FittedParameter other = findHeading(partOf(motion, half, motion.velocity.rows() - half)).angle;
  return std::abs(std::remainder(one.value - other.value, 2.0 * kHalfTurn)) <=
         kHeadingDrift + std::hypot(one.half_width, other.half_width);
}

}  // namespace

MotionFit fitHeading(const Motion& motion) {
  const Eigen::Index rows = motion.velocity.rows();
  const HeadingFit found = findHeading(motion);
  const double tilt = found.tilt;
  FittedParameter angle = found.angle;
  MotionFit result;
  angle.supported = tilt >= kLeastExpected && angle.half_width <= kVagueHeading;
  if (angle.supported && !(found.scale >= kLeastHeadingScale && found.scale <= kGreatestHeadingScale)) {
    angle.supported = false;
    result.warnings.push_back(
        sentence("The vehicle accelerates %.2g times as much as its tilt makes expect: angles or velocities "
                 "are of another unit or "
                 "sign.",
                 found.scale));
  } else if (angle.supported && !isSteady(motion)) {
    angle.supported = false;
    result.warnings.emplace_back(
        "The halves of the flight tell different misalignments: a heading drifts, so that no number corrects "
        "it.");
  } else if (!angle.supported) {
    result.warnings.push_back(
        sentence("heading_misalignment is not bounded by these data: %.2g +- %.2g rad, at %.2g m/s^2 rms of "
                 "horizontal "
                 "thrust. Fly quicker, to all sides.",
                 angle.value, angle.half_width, tilt));
  } else if (std::abs(angle.value) > kGreatestMisalignment && std::abs(angle.value) > angle.half_width) {
    result.warnings.push_back(sentence(
        "The motion is turned by %.3f +- %.3f rad from where the attitude tilts: align yaw of odometry and "
        "attitude before flight, or let the controller turn it (vehicle/heading_misalignment).",
        angle.value, angle.half_width));
  }
  result.parameters = {angle};
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    result.traces.push_back(traceOf(motion, std::string("acceleration along ") + kMotionAxes[axis], "m/s^2",
                                    motion.acceleration.col(axis),
                                    found.modelled.segment(axis * rows, rows)));
  }
  return result;
}

MotionFit fitMass(const Motion& motion, const MotionOptions& options) {
  if (motion.lift.isZero(0.0)) throw Error(motion.source + ": no thrust_cmd, or it is zero throughout");
  const Eigen::VectorXd load =
      (motion.acceleration.col(2) + options.drag.z() * motion.velocity.col(2)).array() + options.gravity;
  const Regression found = regress(load, motion.lift, indices(motion.starts));
  MotionFit result;
  result.warnings = checkMotion(motion);
  const bool sound = result.warnings.empty();
  const char* unit = motion.lift_is_share ? "1" : "N";
  if (motion.lift_is_share) {
    result.parameters = {parameterOf("hover_command", unit, found, 0, options.gravity)};
    result.warnings.emplace_back(
        "The thrust command is a share of full thrust, not newtons: it tells what hovers, but no mass.");
  } else {
    result.parameters = {parameterOf("mass", "kg", found, 0),
                         parameterOf("hover_thrust", unit, found, 0, options.gravity)};
  }
  for (FittedParameter& parameter : result.parameters) parameter.supported = sound;
  judgeMass(&result.parameters, &result.warnings);
  MotionTrace trace =
      traceOf(motion, "vertical part of the thrust command", unit, motion.lift, load * found.coefficients[0]);
  trace.against = "vertical acceleration with gravity and drag [m/s^2]";
  trace.depends = list(load);
  result.traces = {std::move(trace)};
  return result;
}

}  // namespace polyfly
