#include "identification/thrust_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "identification/several_flights.hpp"
#include "identification/several_motions.hpp"
#include "polyfly_base/error.hpp"
#include "thrust_model.hpp"
#include "thrust_support.hpp"

namespace polyfly {
namespace {

// Lags and delays that are tried first [s].
constexpr double kLags[] = {0.02, 0.06, 0.14, 0.3};
constexpr double kDelays[] = {0.0, 0.05, 0.12, 0.3};
// Their ends [s].
constexpr double kLeastLag = 0.005, kGreatestLag = 0.8, kGreatestDelay = 0.6;
// First and last step of the search around the best of them [s].
constexpr double kFirstLagStep = 0.03, kLastLagStep = 0.001;
// Share of the samples that lies beyond each end of the curve.
constexpr double kBeyondEnd = 0.01;
// Least range of the logarithm of the voltage, and least root mean square of the climb rate [m/s].
constexpr double kLeastVoltageRange = 0.01, kLeastClimb = 0.1;
constexpr int kGreatestDegree = 3;

struct Batteries {
  bool logged = false;
  bool changes = false;
  FlownVoltage voltage;
};

Batteries batteriesOf(const std::vector<ThrustRecord>& records) {
  Batteries result;
  result.logged = std::all_of(records.begin(), records.end(),
                              [](const ThrustRecord& record) { return record.voltage.size() > 0; });
  if (!result.logged) return result;
  double sum = 0.0, count = 0.0;
  double least = records.front().voltage.minCoeff(), greatest = records.front().voltage.maxCoeff();
  for (const ThrustRecord& record : records) {
    sum += record.voltage.sum();
    count += static_cast<double>(record.voltage.size());
    least = std::min(least, record.voltage.minCoeff());
    greatest = std::max(greatest, record.voltage.maxCoeff());
  }
  result.voltage = {true, sum / count, least, greatest, false};
  result.changes = std::log(greatest / least) >= kLeastVoltageRange;
  return result;
}

bool climbsTell(const std::vector<ThrustRecord>& records, double mass) {
  double squares = 0.0, count = 0.0;
  for (const ThrustRecord& record : records) {
    if (record.climb.size() == 0) return false;
    squares += record.climb.squaredNorm() / (mass * mass);
    count += static_cast<double>(record.climb.size());
  }
  return std::sqrt(squares / count) >= kLeastClimb;
}

// All but the command.
ThrustSamples samplesOf(const ThrustRecord& record, const Batteries& batteries, bool climbs) {
  ThrustSamples samples;
  samples.time = record.time;
  samples.force = record.force;
  if (climbs) samples.climb = record.climb;
  if (batteries.changes) {
    samples.battery = (record.voltage.array() / batteries.voltage.mean).log();
  } else if (!batteries.logged) {
    const double length = record.time[record.time.size() - 1] - record.time[0];
    samples.battery = (record.time.array() - record.time[0]) / length - 0.5;
  }
  samples.starts = {0};
  for (const LoopSegment& segment : record.segments)
    samples.starts.push_back(samples.starts.back() + static_cast<Eigen::Index>(segment.time.size()));
  return samples;
}

LoopShape lagOf(double tau, double delay) {
  LoopShape shape;
  shape.tau = tau;
  shape.delay = delay;
  return shape;
}

// Lag and delay with the least residual of a polynomial in the command.
class LagSearch {
 public:
  LagSearch(const std::vector<ThrustRecord>& records, ThrustSamples together)
      : records_(records), together_(std::move(together)) {}

  LoopShape find() {
    LoopShape best = lagOf(kLags[0], kDelays[0]);
    double least = lossOf(best);
    const auto offer = [&](const LoopShape& shape) {
      const double loss = lossOf(shape);
      if (!(loss < least)) return false;
      least = loss;
      best = shape;
      return true;
    };
    for (const double tau : kLags) {
      for (const double delay : kDelays) offer(lagOf(tau, delay));
    }
    for (double step = kFirstLagStep; step > kLastLagStep;) {
      bool better = false;
      // One for the other first: their sum is known best.
      for (const auto& [by_tau, by_delay] : {std::pair{1, -1}, std::pair{-1, 1}, std::pair{1, 0},
                                             std::pair{-1, 0}, std::pair{0, 1}, std::pair{0, -1}}) {
        better = offer(lagOf(std::clamp(best.tau + step * by_tau, kLeastLag, kGreatestLag),
                             std::clamp(best.delay + step * by_delay, 0.0, kGreatestDelay))) ||
                 better;
      }
      if (!better) step *= 0.5;
    }
    return best;
  }

 private:
  double lossOf(const LoopShape& shape) {
    Eigen::Index row = 0;
    for (const ThrustRecord& record : records_) {
      const Eigen::VectorXd command = laggedCommand(record, shape);
      together_.command.segment(row, command.size()) = command;
      row += command.size();
    }
    return regressOnCommand(together_).mean_square;
  }

  const std::vector<ThrustRecord>& records_;
  ThrustSamples together_;
};

void setLag(const ThrustRecord& record, const LoopShape& shape, ThrustSamples* samples) {
  samples->command = laggedCommand(record, shape);
  samples->by_lag =
      (laggedCommand(record, lagOf(shape.tau, shape.delay + kLastLagStep)) - samples->command) / kLastLagStep;
}

double quantileOf(Eigen::VectorXd values, double share) {
  const auto at = values.data() + static_cast<Eigen::Index>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.data(), at, values.data() + values.size());
  return *at;
}

double fitPercent(const Eigen::VectorXd& measured, const Eigen::VectorXd& modelled) {
  const double spread = (measured.array() - measured.mean()).matrix().norm();
  return 100.0 * (1.0 - (measured - modelled).norm() / spread);
}

// The greatest degree whose highest coefficient differs from zero, or the one that is asked for.
std::pair<CurveShape, ThrustModel> chooseCurve(const ThrustSamples& samples, int asked) {
  const Eigen::VectorXd modelled = regressOnCommand(samples).modelled;
  const double least = quantileOf(modelled, kBeyondEnd);
  const double greatest = quantileOf(modelled, 1.0 - kBeyondEnd);
  const double middle = 0.5 * (least + greatest);
  const double farthest = (modelled.array() - middle).abs().maxCoeff();
  if (!(least < greatest)) throw Error("thrust_cmd does not move the thrust");
  for (int degree = asked == 0 ? kGreatestDegree : asked;; --degree) {
    const CurveShape shape(degree, least, greatest, farthest);
    ThrustModel model = fitThrustModel(shape, samples);
    findCovariance(shape, samples, &model);
    if (degree == asked || degree == 1) return {shape, model};
    const Eigen::RowVectorXd highest = shape.highestRow();
    const auto count = model.values.size();
    const double error =
        std::sqrt((highest * model.covariance.topLeftCorner(count, count) * highest.transpose()).value());
    if (model.rises && std::abs(highest.dot(model.values)) > model.interval_factor * error)
      return {shape, model};
  }
}

// Each part is predicted by the model of the others.
double validated(const CurveShape& shape, const std::vector<ThrustSamples>& parts) {
  std::vector<double> measured, modelled;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::vector<ThrustSamples> others;
    for (std::size_t j = 0; j < parts.size(); ++j) {
      if (j != i) others.push_back(parts[j]);
    }
    const Eigen::VectorXd predicted = fitThrustModel(shape, stacked(others)).predict(shape, parts[i]);
    const Eigen::VectorXd& force = parts[i].force;
    measured.insert(measured.end(), force.data(), force.data() + force.size());
    modelled.insert(modelled.end(), predicted.data(), predicted.data() + predicted.size());
  }
  const auto rows = static_cast<Eigen::Index>(measured.size());
  return fitPercent(Eigen::Map<Eigen::VectorXd>(measured.data(), rows),
                    Eigen::Map<Eigen::VectorXd>(modelled.data(), rows));
}

// The first and third quarter, and the others: what the battery does is in both.
std::vector<ThrustSamples> quartersOf(const ThrustSamples& samples) {
  const auto edge = [&](Eigen::Index quarter) { return quarter * samples.rows() / 4; };
  return {rowsOf(samples, {{edge(0), edge(1)}, {edge(2), edge(3)}}),
          rowsOf(samples, {{edge(1), edge(2)}, {edge(3), edge(4)}})};
}

std::vector<FittedParameter> parametersOf(const ThrustModel& model, const Batteries& batteries,
                                          const ThrustSamples& samples) {
  std::vector<FittedParameter> parameters;
  const auto add = [&](const std::string& name, const char* unit, double value) {
    const auto place = static_cast<Eigen::Index>(parameters.size());
    const double error = std::sqrt(model.covariance(place, place));
    parameters.push_back({name, unit, value, error, model.interval_factor * error});
  };
  for (Eigen::Index i = 0; i < model.values.size(); ++i)
    add("command_" + std::to_string(i + 1), "1", model.values[i]);
  if (samples.battery.size() > 0) add(batteries.logged ? "voltage_exponent" : "drift", "1", model.battery);
  if (samples.climb.size() > 0) add("drag_climb", "1/s", model.climb_drag);
  return parameters;
}

// Adds the command at hover, which follows from the values of the curve.
void addHover(const CurveEvidence& evidence, std::vector<FittedParameter>* parameters) {
  const Eigen::RowVectorXd row = evidence.shape.valueRow(evidence.weight);
  const double half = evidence.halfWidth(row);
  const FittedParameter& first = parameters->front();
  // By the same factor as those that it follows from.
  const double factor = first.half_width > 0.0 ? first.standard_error / first.half_width : 0.0;
  parameters->push_back({"hover_command", "1", row.dot(evidence.values), factor * half, half});
}

CurveEvidence evidenceOf(const CurveShape& shape, const ThrustModel& model, double weight) {
  const auto count = model.values.size();
  return {shape, model.values,
          model.interval_factor * model.interval_factor * model.covariance.topLeftCorner(count, count),
          weight, model.rises};
}

// Values and intervals of means over flights.
void takeMeans(const std::vector<FittedParameter>& parameters, CurveEvidence* evidence) {
  const Eigen::Index count = evidence->values.size();
  evidence->intervals = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const FittedParameter& one = parameters[static_cast<std::size_t>(i)];
    evidence->values[i] = one.value;
    evidence->intervals(i, i) = one.half_width * one.half_width;
  }
}

const FittedParameter* findParameter(const std::vector<FittedParameter>& parameters, const char* name) {
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [name](const FittedParameter& one) { return one.name == name; });
  return found == parameters.end() ? nullptr : &*found;
}

// The model of all, with what is told as mean of flights.
ThrustModel modelOf(ThrustModel model, const std::vector<FittedParameter>& parameters,
                    const CurveEvidence& evidence) {
  model.values = evidence.values;
  for (const char* name : {"voltage_exponent", "drift"}) {
    if (const FittedParameter* one = findParameter(parameters, name)) model.battery = one->value;
  }
  if (const FittedParameter* drag = findParameter(parameters, "drag_climb")) model.climb_drag = drag->value;
  return model;
}

// The thrust without what the climb does, over the command that counts.
MotionTrace traceOf(const CurveShape& shape, const ThrustModel& model, const ThrustSamples& samples) {
  const Eigen::VectorXd climb = samples.climb.size() > 0
                                    ? Eigen::VectorXd(model.climb_drag * samples.climb)
                                    : Eigen::VectorXd(Eigen::VectorXd::Zero(samples.rows()));
  const Eigen::VectorXd measured = samples.force + climb;
  const Eigen::VectorXd modelled = model.predict(shape, samples) + climb;
  Eigen::VectorXd command = samples.command;
  if (samples.battery.size() > 0) command.array() *= (model.battery * samples.battery.array()).exp();
  const auto list = [](const Eigen::VectorXd& values) {
    return std::vector<double>(values.data(), values.data() + values.size());
  };
  return {"thrust along the body's z",
          "N",
          "thrust command, behind its lag, at the mean voltage",
          list(samples.time),
          {samples.starts.begin(), samples.starts.end()},
          list(measured),
          list(modelled),
          list(command)};
}

std::string voltageSentence(const FlownVoltage& voltage, const FittedParameter& exponent) {
  char text[320];
  std::snprintf(text, sizeof text,
                "The curve is for %.2f V. At %.2f V the command for a thrust is %.1f %% greater, at %.2f V "
                "%.1f %% less. "
                "The controller does not know the voltage: fly within this range.",
                voltage.mean, voltage.least,
                100.0 * (std::pow(voltage.mean / voltage.least, exponent.value) - 1.0), voltage.greatest,
                100.0 * (1.0 - std::pow(voltage.mean / voltage.greatest, exponent.value)));
  return text;
}

struct ThrustData {
  std::vector<ThrustRecord> records;
  std::vector<ThrustSamples> each;
  Batteries batteries;
  LoopShape lag;
};

ThrustData readThrust(const ThrustFlights& flights, const ThrustOptions& options) {
  ThrustData data;
  for (std::size_t i = 0; i < flights.signals.size(); ++i)
    data.records.push_back(
        thrustRecordOf(flights.signals[i], flights.windows[i], options.mass, options.gravity));
  data.batteries = batteriesOf(data.records);
  const bool climbs = climbsTell(data.records, options.mass);
  for (const ThrustRecord& record : data.records) {
    data.each.push_back(samplesOf(record, data.batteries, climbs));
    data.each.back().command = data.each.back().by_lag = Eigen::VectorXd::Zero(record.time.size());
  }
  data.lag = LagSearch(data.records, stacked(data.each)).find();
  const std::vector<double> shifts =
      flights.signals.size() > 1 ? joinFlights(flights.signals).shifts : std::vector<double>{0.0};
  for (std::size_t i = 0; i < data.each.size(); ++i) {
    setLag(data.records[i], data.lag, &data.each[i]);
    data.each[i].time.array() += shifts[i];
  }
  return data;
}

ThrustFit fitData(const ThrustData& data, const ThrustOptions& options) {
  const double weight = options.mass * options.gravity;
  const bool several = data.each.size() > 1;
  const ThrustSamples together = stacked(data.each);
  auto [shape, model] = chooseCurve(together, options.degree);
  CurveEvidence evidence = evidenceOf(shape, model, weight);
  evidence.degree_given = options.degree > 1;
  for (const ThrustRecord& record : data.records)
    evidence.accelerometer_error =
        std::max(evidence.accelerometer_error, std::abs(record.accelerometer_scale - 1.0));
  ThrustFit result;
  result.parameters = parametersOf(model, data.batteries, together);
  if (several) {
    for (const ThrustSamples& samples : data.each) {
      ThrustModel own = fitThrustModel(shape, samples);
      findCovariance(shape, samples, &own);
      result.flights.push_back(parametersOf(own, data.batteries, samples));
    }
    result.parameters = poolParameters(result.flights);
    takeMeans(result.parameters, &evidence);
    for (auto& parameters : result.flights) {
      CurveEvidence own = evidence;
      takeMeans(parameters, &own);
      addHover(own, &parameters);
    }
  }
  const bool rises = shape.rises(evidence.values);
  if (rises) model = modelOf(model, result.parameters, evidence);
  addHover(evidence, &result.parameters);
  IdentifiedCurve& curve = result.curve;
  curve.polynomial = shape.coefficients(evidence.values);
  curve.thrusts = shape.thrusts();
  curve.mass = options.mass;
  curve.voltage = data.batteries.voltage;
  curve.lag = data.lag.tau;
  curve.delay = data.lag.delay;
  curve.fit_percent = fitPercent(together.force, model.predict(shape, together));
  curve.validation_percent = validated(shape, several ? data.each : quartersOf(together));
  result.traces = {traceOf(shape, model, together)};
  evidence.rises = evidence.rises && rises;
  evidence.climb_drag = model.climb_drag;
  evidence.drift = findParameter(result.parameters, "drift");
  curve.reasons = reasonsAgainstCurve(curve, evidence);
  for (FittedParameter& parameter : result.parameters) parameter.supported = curve.supported();
  result.warnings = curve.reasons;
  if (const FittedParameter* exponent = findParameter(result.parameters, "voltage_exponent")) {
    curve.voltage.matters = voltageMatters(curve.voltage, *exponent);
    if (curve.voltage.matters) result.warnings.push_back(voltageSentence(curve.voltage, *exponent));
  }
  return result;
}

std::string sourcesOf(const ThrustFlights& flights) {
  std::string names;
  for (const FlightSignals& flight : flights.signals) names += (names.empty() ? "" : ", ") + flight.source;
  return names;
}

}  // namespace

ThrustFit fitThrust(const ThrustFlights& flights, const ThrustOptions& options) {
  const ThrustData data = readThrust(flights, options);
  try {
    return fitData(data, options);
  } catch (const Error& error) {
    throw Error(sourcesOf(flights) + ": " + error.what());
  }
}

}  // namespace polyfly
