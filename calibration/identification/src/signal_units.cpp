#include "identification/signal_units.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <optional>

#include "identification/excitation.hpp"
#include "identification/flight_phases.hpp"
#include "interpolate.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"

namespace polyfly {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;
constexpr double kFullTurn = 2.0 * kHalfTurn;
constexpr double kDegreesOfTurn = 360.0;
// Radian in degrees, in hundredths of degrees, and a hundred.
constexpr double kFactors[] = {57.29577951308232, 5729.577951308232, 100.0};
// A factor is one of these if it lies this close to it, as a ratio.
constexpr double kFactorMargin = 1.3;
// Correlation from which on two signals tell each other's unit; of a command, which its response follows late.
constexpr double kTells = 0.8;
constexpr double kFollowsCommand = 0.7;
// Time over which an angle's change is compared with its rate, and step between comparisons [s].
constexpr double kChange = 0.4;
constexpr double kCompareStep = 0.2;
constexpr std::size_t kLeastCompared = 50;
// Deviation of a rate from which on it is that of a flight [rad/s], and of an angle [rad].
constexpr double kFlightRate = 0.05;
constexpr double kFlightAngle = 0.005;
// An angle is beyond pi if it is so for this share of the flight.
constexpr double kBeyondShare = 0.005;
// Share of the record that must be flight for the units to be judged in it.
constexpr double kLeastFlown = 0.5;
// Gravity as the accelerometer may show it, as a ratio.
constexpr double kForceMargin = 1.5;
constexpr double kGravityShown = 9.80665;  // [m/s^2]
constexpr double kLongestLag = 1.0;        // [s]
// Behind a place: its angles are degrees.
constexpr const char* kDegreeMark = ":deg";

std::string unitText(const char* format, double value) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

double deviationOf(const std::vector<double>& values) {
  double mean = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  double square = 0.0;
  for (const double value : values) square += (value - mean) * (value - mean);
  return values.empty() ? 0.0 : std::sqrt(square / static_cast<double>(values.size()));
}

// How one signal goes with another: their ratio in size, and their correlation.
struct Comparison {
  double factor = 0.0;
  double correlation = 0.0;

  bool tells() const { return std::abs(correlation) >= kTells; }
};

Comparison compare(const std::vector<double>& one, const std::vector<double>& other) {
  if (one.size() < kLeastCompared) return {};
  double products = 0.0;
  double squares = 0.0;
  double other_squares = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    products += one[i] * other[i];
    squares += one[i] * one[i];
    other_squares += other[i] * other[i];
  }
  if (!(squares > 0.0 && other_squares > 0.0)) return {};
  return {std::sqrt(squares / other_squares), products / std::sqrt(squares * other_squares)};
}

// Without the jumps of an angle that is kept within a full turn.
void unwrap(std::vector<double>* angle) {
  if (angle->empty()) return;
  const auto [least, greatest] = std::minmax_element(angle->begin(), angle->end());
  const double turn = *greatest - *least > 1.05 * kFullTurn ? kDegreesOfTurn : kFullTurn;
  double shift = 0.0;
  for (std::size_t i = 1; i < angle->size(); ++i) {
    const double step = (*angle)[i] + shift - (*angle)[i - 1];
    shift -= turn * std::round(step / turn);
    (*angle)[i] += shift;
  }
}

// Calls back for times at which both series are sampled around [time, time + kChange].
template <class Use>
void overTimes(const TimeSeries& one, const TimeSeries& other, const Use& use) {
  std::size_t next = 0;
  double last = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < one.time.size(); ++i) {
    const double time = one.time[i];
    if (time < last + kCompareStep) continue;
    last = time;
    while (next + 1 < other.time.size() && other.time[next + 1] <= time) ++next;
    const auto end =
        std::lower_bound(one.time.begin() + static_cast<std::ptrdiff_t>(i), one.time.end(), time + kChange);
    if (other.time.empty() || end == one.time.end() || *end > time + 2.0 * kChange) continue;
    if (other.time[next] > time || other.time.back() < *end) continue;
    if (next + 1 < other.time.size() && other.time[next + 1] - other.time[next] > kChange) continue;
    use(i, static_cast<std::size_t>(end - one.time.begin()));
  }
}

// Change of the angle against the integral of the rate.
Comparison changeAgainstRate(TimeSeries angle, const TimeSeries& rate) {
  unwrap(&angle.value);
  const TimeSeries integral = {rate.time, cumulativeIntegral(rate.time, rate.value)};
  std::vector<double> changes;
  std::vector<double> turns;
  overTimes(angle, rate, [&](std::size_t from, std::size_t to) {
    changes.push_back(angle.value[to] - angle.value[from]);
    turns.push_back(interpolated(integral, angle.time[to]) - interpolated(integral, angle.time[from]));
  });
  return compare(changes, turns);
}

Comparison valueAgainstValue(const TimeSeries& one, const TimeSeries& other) {
  std::vector<double> values;
  std::vector<double> others;
  overTimes(one, other, [&](std::size_t at, std::size_t /*end*/) {
    values.push_back(one.value[at]);
    others.push_back(interpolated(other, one.time[at]));
  });
  return compare(values, others);
}

// The factor, or its inverse, that the ratio is close to; none if it is 1 or another one.
std::optional<double> knownFactor(double ratio) {
  for (const double factor : kFactors) {
    for (const double one : {factor, 1.0 / factor}) {
      if (ratio < one * kFactorMargin && ratio > one / kFactorMargin) return one;
    }
  }
  return std::nullopt;
}

// Whether an angle lies beyond pi, as none in radians does in flight.
bool isBeyond(const TimeSeries& series) {
  const auto beyond = std::count_if(series.value.begin(), series.value.end(),
                                    [](double value) { return std::abs(value) > kHalfTurn + kFlightAngle; });
  return static_cast<double>(beyond) > kBeyondShare * static_cast<double>(series.value.size());
}

// Where units are not judged: what is no flight, if all signals are in their units and the rest is most of the record.
// With other units hardly anything is flight.
std::vector<TimeWindow> withoutUnits(const FlightSignals& signals, bool on_ground) {
  std::vector<TimeWindow> windows;
  double left_out = 0.0;
  for (const RejectedWindow& one : findNonFlight(signals, on_ground)) {
    windows.push_back(one.window);
    left_out += one.window.to - one.window.from;
  }
  double whole = 0.0;
  for (const auto& [name, series] : signals.series) {
    if (!series.time.empty()) whole = std::max(whole, series.time.back() - series.time.front());
  }
  return left_out < kLeastFlown * whole ? windows : std::vector<TimeWindow>();
}

class Settlement {
 public:
  Settlement(FlightSignals* signals, bool on_ground)
      : signals_(*signals), left_out_(withoutUnits(*signals, on_ground)) {}

  std::vector<std::string> run() {
    const bool roll = angle("roll", "gyro_x");
    const bool pitch = angle("pitch", "gyro_y");
    bool yaw_rate = rate();
    angle("yaw", "gyro_z");
    yaw_rate = angle("yaw", "yaw_rate") || yaw_rate;
    command("roll", roll);
    command("pitch", pitch);
    command("yaw_rate", yaw_rate);
    force();
    return remarks_;
  }

 private:
  void scale(const std::string& name, double factor) {
    for (double& value : signals_.series[name].value) value *= factor;
  }

  // Samples of the flight.
  TimeSeries inFlight(const std::string& name) const {
    return without(cleanSignal(signals_, name), left_out_);
  }

  // Says by how much, and divides.
  void convert(const std::string& name, const std::string& other, double factor) {
    remarks_.push_back(name + unitText(" is %.3g times what ", factor) + other +
                       unitText(" says: divided by %.4g", factor));
    scale(name, 1.0 / factor);
  }

  [[noreturn]] void refuse(const std::string& name, const std::string& why) const {
    const auto origin = signals_.origin.find(name);
    const std::string place = origin == signals_.origin.end() ? "PLACE" : origin->second;
    const bool degrees = endsWith(place, kDegreeMark);
    throw Error(signals_.source + ": " + name + ": " + why + "; --signal " + name + "=" +
                (degrees ? place.substr(0, place.size() - std::strlen(kDegreeMark)) + " takes it for radians"
                         : place + kDegreeMark + " takes it for degrees"));
  }

  // True: the angle is in radians, by its rate.
  bool angle(const std::string& name, const std::string& rate) {
    const TimeSeries measured = inFlight(name);
    const TimeSeries turning = inFlight(rate);
    const Comparison found = changeAgainstRate(measured, turning);
    const bool beyond = name != "yaw" && isBeyond(measured);
    if (!found.tells()) {
      if (beyond) refuse(name, "lies beyond pi in flight, and no gyro tells its unit; factor 57.3?");
      return false;
    }
    if (found.correlation < 0.0)
      remarks_.push_back(name + " and " + rate + " have opposite signs: one of them is of another frame");
    const std::optional<double> factor = knownFactor(found.factor);
    if (!factor) {
      if (beyond && found.factor > kFactorMargin)
        refuse(name, unitText("lies beyond pi, and changes by %.3g times its rate", found.factor));
      return found.factor < kFactorMargin && found.factor > 1.0 / kFactorMargin;
    }
    // Of an angle that changes too much or a rate that turns too much, the one is wrong that no flight has.
    if (*factor > 1.0 && (beyond || deviationOf(turning.value) > kFlightRate)) {
      convert(name, rate, *factor);
    } else if (*factor < 1.0 && deviationOf(measured.value) > kFlightAngle) {
      convert(rate, name, 1.0 / *factor);
    } else {
      refuse(name, unitText("changes by %.3g times its rate, and both are too small to tell which is wrong",
                            found.factor));
    }
    return true;
  }

  // True: the yaw rate is that of the gyro.
  bool rate() {
    if (!signals_.has("gyro_z") || !signals_.has("yaw_rate")) return false;
    const TimeSeries rate = inFlight("yaw_rate");
    const Comparison found = valueAgainstValue(rate, inFlight("gyro_z"));
    if (!found.tells()) return false;
    if (found.correlation < 0.0)
      remarks_.emplace_back("yaw_rate and gyro_z have opposite signs: one of them is of another frame");
    const std::optional<double> factor = knownFactor(found.factor);
    if (factor) convert("yaw_rate", "gyro_z", *factor);
    return factor || std::abs(std::log(found.factor)) < std::log(kFactorMargin);
  }

  void command(const std::string& axis, bool response_is_right) {
    const std::string name = axis + "_cmd";
    const TimeSeries asked = inFlight(name);
    const TimeSeries answered = inFlight(axis);
    if (asked.time.size() < 2 || answered.time.size() < kLeastCompared) return;
    const TimeWindow whole = {std::max(asked.time.front(), answered.time.front()), answered.time.back()};
    double follows = 0.0;
    for (const TimeWindow& piece : cutAtFarSteps({whole}, answered.time)) {
      const double one = bestCorrelation(asked, answered, piece, kLongestLag);
      if (std::abs(one) > std::abs(follows)) follows = one;
    }
    const bool beyond = axis != "yaw_rate" && isBeyond(asked) && !isBeyond(answered);
    if (std::abs(follows) < kFollowsCommand || !(response_is_right || beyond)) return;
    const std::optional<double> factor = knownFactor(deviationOf(asked.value) / deviationOf(answered.value));
    if (factor) convert(name, axis, *factor);
  }

  void force() {
    std::vector<double> values = inFlight("specific_force_z").value;
    if (values.size() < kLeastCompared) return;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    const double shown = *middle;
    if (shown < 0.0) {
      remarks_.emplace_back("specific_force_z shows gravity with the wrong sign: turned");
      scale("specific_force_z", -1.0);
    }
    // m/s^2, g, thousandths of g.
    for (const double unit : {1.0, kGravityShown, kGravityShown / 1000.0}) {
      const double gravity = std::abs(shown) * unit / kGravityShown;
      if (gravity > kForceMargin || gravity < 1.0 / kForceMargin) continue;
      if (unit == 1.0) return;
      remarks_.push_back(unitText("specific_force_z shows gravity as %.4g", std::abs(shown)) +
                         unitText(": multiplied by %.4g", unit));
      for (const char* name : {"specific_force_x", "specific_force_y", "specific_force_z"}) {
        if (signals_.has(name)) scale(name, unit);
      }
      return;
    }
    remarks_.push_back(
        unitText("specific_force_z shows %.3g m/s^2 where gravity is 9.81: not used; its unit is "
                 "another, or gravity was taken out",
                 shown));
    for (const char* name : {"specific_force_x", "specific_force_y", "specific_force_z"})
      signals_.series.erase(name);
  }

  FlightSignals& signals_;
  std::vector<TimeWindow> left_out_;
  std::vector<std::string> remarks_;
};

}  // namespace

std::vector<std::string> settleUnits(FlightSignals* signals, bool on_ground) {
  return Settlement(signals, on_ground).run();
}

}  // namespace polyfly
