#include "identification/vehicle_kind.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "identification/flight_signals.hpp"
#include "interpolate.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Share of the flight below kStall from which on it is no fixed wing's.
constexpr double kSlowShare = 0.1;
// Share of the flight below kStall up to which it is a fixed wing's: noise, and gusts.
constexpr double kSlowNoise = 0.01;
// Greatest speed of a vehicle that never flies fast, of which it is known that it moves [m/s].
constexpr double kMoves = 0.5;
// Cosine of the angle between course and heading above which a vehicle flies forward.
constexpr double kForward = 0.7;
// Least share of the time in which a fixed wing flies forward.
constexpr double kForwardShare = 0.9;

bool hasSamples(const FlightSignals& signals, const char* name) {
  return !cleanSignal(signals, name).time.empty();
}

// Size of the vector of two signals, at the times of the first.
TimeSeries sizeOf(const TimeSeries& one, const TimeSeries& other) {
  TimeSeries size = one;
  for (std::size_t i = 0; i < size.time.size(); ++i)
    size.value[i] = std::hypot(one.value[i], interpolated(other, size.time[i]));
  return size;
}

// Share of the fast samples in which the velocity points along the heading; 1 if that is not known.
double forwardShare(const FlightSignals& signals) {
  if (!hasSamples(signals, "vx") || !hasSamples(signals, "vy") || !hasSamples(signals, "yaw")) return 1.0;
  const TimeSeries vx = cleanSignal(signals, "vx");
  const TimeSeries vy = cleanSignal(signals, "vy");
  TimeSeries sine = cleanSignal(signals, "yaw");
  TimeSeries cosine = sine;
  for (double& value : sine.value) value = std::sin(value);
  for (double& value : cosine.value) value = std::cos(value);
  std::size_t fast = 0;
  std::size_t forward = 0;
  for (std::size_t i = 0; i < vx.time.size(); ++i) {
    const double time = vx.time[i];
    const double east = vx.value[i];
    const double north = interpolated(vy, time);
    const double speed = std::hypot(east, north);
    if (speed < kFastFlight) continue;
    ++fast;
    const double along = east * interpolated(cosine, time) + north * interpolated(sine, time);
    forward += along > kForward * speed ? 1 : 0;
  }
  return fast == 0 ? 1.0 : static_cast<double>(forward) / static_cast<double>(fast);
}

template <class... Values>
std::string told(const char* format, Values... values) {
  char buffer[240];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

RecognisedVehicle bySpeed(const TimeSeries& speed, const std::string& name, double forward) {
  const auto fast = [](double value) { return value > kFastFlight; };
  const auto first = std::find_if(speed.value.begin(), speed.value.end(), fast);
  if (first == speed.value.end()) {
    const double greatest = *std::max_element(speed.value.begin(), speed.value.end());
    if (name == "airspeed" || !(greatest > kMoves)) return {};
    return {VehicleKind::kMultirotor,
            told("The %s never exceeds %.1f m/s, below that of a fixed wing.", name.c_str(), greatest)};
  }
  const auto last = std::find_if(speed.value.rbegin(), speed.value.rend(), fast).base();
  const auto slow = std::count_if(first, last, [](double value) { return value < kStall; });
  const double share = static_cast<double>(slow) / static_cast<double>(last - first);
  const double seconds = speed.time[static_cast<std::size_t>(last - speed.value.begin()) - 1] -
                         speed.time[static_cast<std::size_t>(first - speed.value.begin())];
  if (share > kSlowShare && name != "airspeed") {
    return {VehicleKind::kMultirotor, told("In flight the %s is below %.0f m/s in %.0f %% of the time.",
                                           name.c_str(), kStall, 100.0 * share)};
  }
  if (share <= kSlowNoise && seconds >= kLongFlight && forward >= kForwardShare) {
    return {VehicleKind::kFixedWing,
            told("The %s stays above %.0f m/s for %.0f s of flight.", name.c_str(), kStall, seconds)};
  }
  return {};
}

}  // namespace

const char* nameOf(VehicleKind kind) {
  switch (kind) {
    case VehicleKind::kUnknown:
      return "unknown";
    case VehicleKind::kMultirotor:
      return "multirotor";
    case VehicleKind::kFixedWing:
      return "fixed_wing";
  }
  return "unknown";
}

VehicleKind vehicleKindOf(const std::string& name) {
  for (const VehicleKind kind : {VehicleKind::kUnknown, VehicleKind::kMultirotor, VehicleKind::kFixedWing}) {
    if (name == nameOf(kind)) return kind;
  }
  throw Error("vehicle: must be unknown, multirotor or fixed_wing, got '" + name + "'");
}

RecognisedVehicle recogniseVehicle(const FlightSignals& signals) {
  if (signals.vehicle.kind != VehicleKind::kUnknown) return signals.vehicle;
  if (hasSamples(signals, "airspeed")) {
    const RecognisedVehicle vehicle =
        bySpeed(cleanSignal(signals, "airspeed"), "airspeed", forwardShare(signals));
    if (vehicle.kind != VehicleKind::kUnknown) return vehicle;
  }
  for (const auto& [one, other] : {std::pair<const char*, const char*>{"vx", "vy"}, {"vn", "ve"}}) {
    if (!hasSamples(signals, one) || !hasSamples(signals, other)) continue;
    return bySpeed(sizeOf(cleanSignal(signals, one), cleanSignal(signals, other)), "ground speed",
                   forwardShare(signals));
  }
  return {};
}

}  // namespace polyfly
