#include <algorithm>
#include <cmath>
#include <utility>

#include "fit_uncertainty.hpp"
#include "identification/motion.hpp"
#include "identification/several_flights.hpp"
#include "polyfly_base/error.hpp"
#include "report/report.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

const char* const kMotionAxes[] = {"x", "y", "z"};
// Least root mean square of velocity [m/s] and of acceleration [m/s^2].
constexpr double kLeastMotion = 0.1;
// Deviation below which nothing can be said about the frame [m/s^2].
constexpr double kLeastExpected = 0.1;
// Least correlation of measured and expected acceleration.
constexpr double kLeastCorrelation = 0.5;
// Greatest half width of a confidence interval [1/s].
constexpr double kVagueDrag = 0.1;
// Greatest half width of a confidence interval, relative to the value.
constexpr double kVagueShare = 0.3;

std::vector<double> list(const Eigen::VectorXd& values) {
  return {values.data(), values.data() + values.size()};
}

double rms(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, values.size())));
}

MotionTrace traceOf(const Motion& motion, const std::string& name, const std::string& unit,
                    const Eigen::VectorXd& measured, const Eigen::VectorXd& modelled) {
  std::vector<TimeWindow> stretches;
  for (std::size_t i = 1; i < motion.starts.size(); ++i) {
    stretches.push_back({motion.time[static_cast<std::size_t>(motion.starts[i - 1])],
                         motion.time[static_cast<std::size_t>(motion.starts[i] - 1)]});
  }
  return {name, unit, motion.time, stretches, list(measured), list(modelled)};
}

FittedParameter parameterOf(const std::string& name, const std::string& unit, const Regression& found,
                            Eigen::Index index, double scale = 1.0) {
  return {name, unit, scale * found.coefficients[index], scale * found.half_widths[index]};
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

void judgeDrag(FittedParameter& drag, std::vector<std::string>* warnings) {
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
  std::vector<Eigen::Index> starts = motion.starts;
  for (const Eigen::Index start : motion.starts) {
    if (start > 0) starts.push_back(motion.velocity.rows() + start);
  }
  return starts;
}

// Drag along heading and left of the body: a - expected = -R D R' v + d, both horizontal axes of W one below
// the other, with R the turn by the yaw.
void fitRotorDrag(const Motion& motion, MotionFit* result) {
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
  }
}

void judgeMass(std::vector<FittedParameter>* parameters, std::vector<std::string>* warnings) {
  const FittedParameter& first = parameters->front();
  if (first.half_width <= kVagueShare * std::abs(first.value) && first.least() > 0.0) return;
  for (FittedParameter& parameter : *parameters) parameter.supported = false;
  warnings->push_back(sentence("%s is not bounded by these data: %.2g +- %.2g.", first.name.c_str(),
                               first.value, first.half_width));
}

// What must be alike for one model.
void checkAlike(const std::vector<Motion>& flights) {
  for (const Motion& flight : flights) {
    if (flight.thrust_known != flights.front().thrust_known ||
        flight.lift_is_share != flights.front().lift_is_share)
      throw Error(flight.source +
                  ": its thrust_cmd is not that of the other flights: missing, or of another unit");
  }
}

// The fit of a single flight as it is; of several the means, with warnings and pictures of each under its name.
template <class Fit>
MotionFit fitEach(const std::vector<Motion>& flights, const Fit& fit) {
  checkAlike(flights);
  if (flights.size() == 1) return fit(flights.front());
  MotionFit mean;
  for (const Motion& flight : flights) {
    MotionFit one = fit(flight);
    const std::string name = fileName(flight.source) + ": ";
    if (!one.parameters.empty()) mean.flights.push_back(std::move(one.parameters));
    for (const std::string& warning : one.warnings) mean.warnings.push_back(name + warning);
    for (MotionTrace& trace : one.traces) {
      trace.name = name + trace.name;
      mean.traces.push_back(std::move(trace));
    }
  }
  if (!mean.flights.empty()) mean.parameters = meanParameters(mean.flights);
  return mean;
}

}  // namespace

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

namespace {

MotionFit dragOf(const Motion& motion) {
  MotionFit result;
  result.warnings = checkMotion(motion);
  for (Eigen::Index axis = 0; axis < (motion.thrust_known ? 3 : 2); ++axis) {
    Eigen::MatrixXd columns(motion.velocity.rows(), 2);
    columns.col(0) = -motion.velocity.col(axis);
    columns.col(1).setOnes();
    const Eigen::VectorXd left = motion.acceleration.col(axis) - motion.expected.col(axis);
    const Regression found = regress(columns, left, motion.starts);
    const std::string name = kMotionAxes[axis];
    result.parameters.push_back(parameterOf("drag_" + name, "1/s", found, 0));
    result.parameters.push_back(parameterOf("offset_" + name, "m/s^2", found, 1));
    result.traces.push_back(traceOf(motion, "unexplained acceleration along " + name, "m/s^2", left,
                                    columns * found.coefficients));
  }
  fitRotorDrag(motion, &result);
  return result;
}

MotionFit massOf(const Motion& motion, const MotionOptions& options) {
  if (motion.lift.isZero(0.0)) throw Error(motion.source + ": no thrust_cmd, or it is zero throughout");
  const Eigen::VectorXd load =
      (motion.acceleration.col(2) + options.drag.z() * motion.velocity.col(2)).array() + options.gravity;
  const Regression found = regress(load, motion.lift, motion.starts);
  MotionFit result;
  result.warnings = checkMotion(motion);
  const char* unit = motion.lift_is_share ? "1" : "N";
  if (motion.lift_is_share) {
    result.parameters = {parameterOf("hover_command", unit, found, 0, options.gravity)};
  } else {
    result.parameters = {parameterOf("mass", "kg", found, 0),
                         parameterOf("hover_thrust", unit, found, 0, options.gravity)};
  }
  result.traces = {traceOf(motion, "vertical part of the thrust command", unit, motion.lift,
                           load * found.coefficients[0])};
  return result;
}

}  // namespace

MotionFit traceDisturbance(const std::vector<Motion>& flights, const MotionOptions& options) {
  return fitEach(flights, [&options](const Motion& motion) {
    MotionFit result;
    result.warnings = checkMotion(motion);
    for (Eigen::Index axis = 0; axis < (motion.thrust_known ? 3 : 2); ++axis) {
      result.traces.push_back(
          traceOf(motion, std::string("acceleration along ") + kMotionAxes[axis], "m/s^2",
                  motion.acceleration.col(axis),
                  motion.expected.col(axis) - options.drag[axis] * motion.velocity.col(axis)));
    }
    return result;
  });
}

MotionFit fitDrag(const std::vector<Motion>& flights) {
  MotionFit result = fitEach(flights, dragOf);
  const bool sound = result.warnings.empty();
  for (FittedParameter& one : result.parameters) {
    if (one.name.rfind("drag_", 0) != 0) continue;
    one.supported = sound;
    judgeDrag(one, &result.warnings);
  }
  return result;
}

MotionFit fitMass(const std::vector<Motion>& flights, const MotionOptions& options) {
  MotionFit result = fitEach(flights, [&options](const Motion& flight) { return massOf(flight, options); });
  const bool sound = result.warnings.empty();
  for (FittedParameter& one : result.parameters) one.supported = sound;
  if (flights.front().lift_is_share) {
    result.warnings.emplace_back(
        "The thrust command is a share of full thrust, not newtons: it tells what hovers, but no mass.");
  }
  judgeMass(&result.parameters, &result.warnings);
  return result;
}

}  // namespace polyfly
