#include "thrust_support.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "identification/model_support.hpp"

namespace polyfly {
namespace {

// Least range of the thrust, as a share of the weight.
constexpr double kLeastThrustRange = 0.15;
// Greatest half of the interval of a command, relative to the command at hover: at hover, and at the ends.
constexpr double kVagueHover = 0.03;
constexpr double kVagueEnd = 0.08;
// Greatest drift of the command over a flight of which the voltage is not known.
constexpr double kGreatestDrift = 0.04;
// Drag against the climb rate from which on the command sets a climb rather than a thrust [1/s].
constexpr double kClimbCommand = 1.0;
// Greatest effect of the voltage that is not worth a word.
constexpr double kVoltageEffect = 0.03;
// Greatest error of an accelerometer's scale.
constexpr double kAccelerometerError = 0.04;

template <class... Values>
std::string curveSentence(const char* format, Values... values) {
  char buffer[320];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

void judgeFit(const IdentifiedCurve& curve, std::vector<std::string>* reasons) {
  if (!(curve.fit_percent >= kLeastFit)) {
    reasons->push_back(curveSentence("The fit is %.1f %%; a controller needs at least %.0f %%.",
                                     curve.fit_percent, kLeastFit));
  }
  if (!(curve.validation_percent >= kLeastValidation)) {
    reasons->push_back(
        curveSentence("On data that it was not fitted to, the model reaches %.1f %%, not %.0f %%.",
                      curve.validation_percent, kLeastValidation));
  }
}

void judgeRange(const CurveEvidence& evidence, std::vector<std::string>* reasons) {
  const double least = evidence.shape.least();
  const double greatest = evidence.shape.greatest();
  if (greatest - least < kLeastThrustRange * evidence.weight) {
    reasons->push_back(curveSentence(
        "Too little excitation: the thrust was %.3g to %.3g N, a range of %.0f %% of the weight; climb and "
        "descend briskly, for a range of %.0f %% or more.",
        least, greatest, 100.0 * (greatest - least) / evidence.weight, 100.0 * kLeastThrustRange));
  }
  if (!(least < evidence.weight && evidence.weight < greatest)) {
    reasons->push_back(curveSentence(
        "The weight, %.3g N, is not within the thrust that was flown, %.3g to %.3g N: wrong --mass, "
        "or an accelerometer of another scale.",
        evidence.weight, least, greatest));
  }
}

void judgeShape(const CurveEvidence& evidence, std::vector<std::string>* reasons) {
  const Eigen::VectorXd& values = evidence.values;
  Eigen::RowVectorXd rise = Eigen::RowVectorXd::Zero(values.size());
  rise[0] = -1.0;
  rise[values.size() - 1] = 1.0;
  if (!evidence.rises)
    reasons->emplace_back("The curve does not rise over all of the thrust that was flown.");
  if (!(rise.dot(values) - evidence.halfWidth(rise) > 0.0)) {
    reasons->push_back(curveSentence(
        "The interval of the rise of the command over the thrust that was flown holds zero: %.3g +- %.3g.",
        rise.dot(values), evidence.halfWidth(rise)));
  }
  const Eigen::RowVectorXd highest = evidence.shape.highestRow();
  if (evidence.degree_given && std::abs(highest.dot(values)) <= evidence.halfWidth(highest)) {
    reasons->emplace_back(
        "The interval of the coefficient of the highest power holds zero: take a lower --degree.");
  }
  const double hover = evidence.shape.valueRow(evidence.weight).dot(values);
  const auto check = [&](double thrust, double allowed, const char* place) {
    const Eigen::RowVectorXd row = evidence.shape.valueRow(thrust);
    const double half = evidence.halfWidth(row);
    if (half <= allowed * std::abs(hover)) return;
    reasons->push_back(
        curveSentence("The command %s is known to +- %.2g only (%.3g); fly longer, in calm air.", place, half,
                      row.dot(values)));
  };
  check(evidence.weight, kVagueHover, "at hover");
  check(evidence.shape.least(), kVagueEnd, "at the least thrust");
  check(evidence.shape.greatest(), kVagueEnd, "at the greatest thrust");
}

}  // namespace

double CurveEvidence::halfWidth(const Eigen::RowVectorXd& row) const {
  return std::sqrt(std::max(0.0, (row * intervals * row.transpose()).value()));
}

std::vector<std::string> reasonsAgainstCurve(const IdentifiedCurve& curve, const CurveEvidence& evidence) {
  std::vector<std::string> reasons;
  judgeFit(curve, &reasons);
  judgeRange(evidence, &reasons);
  judgeShape(evidence, &reasons);
  if (evidence.accelerometer_error > kAccelerometerError) {
    reasons.push_back(
        curveSentence("The accelerometer is off by %.1f %%: over the flight it does not show gravity's mean.",
                      100.0 * evidence.accelerometer_error));
  }
  if (evidence.climb_drag > kClimbCommand) {
    reasons.push_back(curveSentence(
        "The thrust falls by %.2g m/s^2 for each m/s of climb: the command sets a climb rate, not a thrust.",
        evidence.climb_drag));
  }
  const FittedParameter* drift = evidence.drift;
  if (drift != nullptr && std::abs(drift->value) > std::max(kGreatestDrift, drift->half_width)) {
    reasons.push_back(
        curveSentence("The same command gives another thrust at the end of a flight, as if it were %.1f %% "
                      "%s, and the voltage is "
                      "not known: log the battery (sensor_msgs/BatteryState).",
                      100.0 * std::abs(drift->value), drift->value < 0.0 ? "less" : "more"));
  }
  return reasons;
}

bool voltageMatters(const FlownVoltage& voltage, const FittedParameter& exponent) {
  return std::abs(exponent.value) > exponent.half_width &&
         std::abs(exponent.value) * (voltage.greatest - voltage.least) / voltage.mean > kVoltageEffect;
}

}  // namespace polyfly
