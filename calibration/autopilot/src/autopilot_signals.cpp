#include "autopilot/autopilot_signals.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <set>

#include "autopilot/autopilot_log.hpp"
#include "ground_time.hpp"
#include "logged_vehicle.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegrees = kPi / 180.0;

// Where a signal may be: the first place that the log has counts.
struct Place {
  enum class Angle { kNone, kRoll, kPitch, kYaw, kNorth, kEast };
  const char* signal;
  const char* table;
  // Name of the field. For a quaternion it is the name of its array. For a speed with its course in GCrs it
  // is the name of the speed.
  const char* field;
  double scale = 1.0;
  double offset = 0.0;
  Angle angle = Angle::kNone;
};

// Roll is the same in both frames, pitch and yaw turn their sign, and yaw counts from east, not north.
constexpr Place kPx4[] = {{"roll_cmd", "vehicle_attitude_setpoint", "roll_body"},
                          {"roll_cmd", "vehicle_attitude_setpoint", "q_d", 1.0, 0.0, Place::Angle::kRoll},
                          {"pitch_cmd", "vehicle_attitude_setpoint", "pitch_body", -1.0},
                          {"pitch_cmd", "vehicle_attitude_setpoint", "q_d", -1.0, 0.0, Place::Angle::kPitch},
                          {"yaw_rate_cmd", "vehicle_rates_setpoint", "yaw", -1.0},
                          {"thrust_cmd", "vehicle_attitude_setpoint", "thrust_body[2]", -1.0},
                          {"thrust_cmd", "vehicle_attitude_setpoint", "thrust"},
                          {"thrust_cmd", "vehicle_rates_setpoint", "thrust_body[2]", -1.0},
                          {"thrust_cmd", "vehicle_rates_setpoint", "thrust"},
                          {"roll", "vehicle_attitude", "q", 1.0, 0.0, Place::Angle::kRoll},
                          {"roll", "vehicle_attitude", "roll"},
                          {"pitch", "vehicle_attitude", "q", -1.0, 0.0, Place::Angle::kPitch},
                          {"pitch", "vehicle_attitude", "pitch", -1.0},
                          {"yaw", "vehicle_attitude", "q", -1.0, 0.5 * kPi, Place::Angle::kYaw},
                          {"yaw", "vehicle_attitude", "yaw", -1.0, 0.5 * kPi},
                          {"yaw_rate", "vehicle_angular_velocity", "xyz[2]", -1.0},
                          {"yaw_rate", "vehicle_attitude", "yawspeed", -1.0},
                          {"yaw_rate", "sensor_combined", "gyro_rad[2]", -1.0},
                          {"specific_force_z", "sensor_combined", "accelerometer_m_s2[2]", -1.0},
                          {"specific_force_z", "vehicle_acceleration", "xyz[2]", -1.0},
                          {"specific_force_x", "sensor_combined", "accelerometer_m_s2[0]"},
                          {"specific_force_y", "sensor_combined", "accelerometer_m_s2[1]", -1.0},
                          {"gyro_x", "sensor_combined", "gyro_rad[0]"},
                          {"gyro_y", "sensor_combined", "gyro_rad[1]", -1.0},
                          {"gyro_z", "sensor_combined", "gyro_rad[2]", -1.0},
                          {"gyro_x", "vehicle_angular_velocity", "xyz[0]"},
                          {"gyro_y", "vehicle_angular_velocity", "xyz[1]", -1.0},
                          {"height", "vehicle_local_position", "z", -1.0},
                          {"vx", "vehicle_local_position", "vy"},
                          {"vy", "vehicle_local_position", "vx"},
                          {"vz", "vehicle_local_position", "vz", -1.0},
                          {"vn", "vehicle_local_position", "vx"},
                          {"ve", "vehicle_local_position", "vy"},
                          {"airspeed", "airspeed_validated", "true_airspeed_m_s"},
                          {"vn", "vehicle_global_position", "vel_n"},
                          {"ve", "vehicle_global_position", "vel_e"},
                          {"airspeed", "airspeed", "true_airspeed_m_s"}};

constexpr Place kArduPilot[] = {{"roll_cmd", "ATT", "DesRoll", kDegrees},
                                {"roll_cmd", "ATT", "RollIn", kDegrees},
                                {"roll_cmd", "CTUN", "NavRoll", kDegrees},
                                {"pitch_cmd", "ATT", "DesPitch", -kDegrees},
                                {"pitch_cmd", "ATT", "PitchIn", -kDegrees},
                                {"pitch_cmd", "CTUN", "NavPitch", -kDegrees},
                                {"roll", "ATT", "Roll", kDegrees},
                                {"pitch", "ATT", "Pitch", -kDegrees},
                                {"yaw", "ATT", "Yaw", -kDegrees, 0.5 * kPi},
                                {"yaw_rate_cmd", "RATE", "YDes", -kDegrees},
                                {"yaw_rate_cmd", "RATE", "YawDes", -0.01 * kDegrees},
                                {"yaw_rate", "RATE", "Y", -kDegrees},
                                {"yaw_rate", "RATE", "Yaw", -0.01 * kDegrees},
                                {"thrust_cmd", "CTUN", "ThO"},
                                {"thrust_cmd", "CTUN", "ThrOut"},
                                {"specific_force_z", "IMU", "AccZ", -1.0},
                                {"specific_force_x", "IMU", "AccX"},
                                {"specific_force_y", "IMU", "AccY", -1.0},
                                {"gyro_x", "IMU", "GyrX"},
                                {"gyro_y", "IMU", "GyrY", -1.0},
                                {"gyro_z", "IMU", "GyrZ", -1.0},
                                {"height", "XKF1", "PD", -1.0},
                                {"height", "NKF1", "PD", -1.0},
                                {"height", "EKF1", "PD", -1.0},
                                {"height", "GPS", "Alt"},
                                {"vx", "XKF1", "VE"},
                                {"vx", "NKF1", "VE"},
                                {"vx", "EKF1", "VE"},
                                {"vx", "GPS", "Spd", 1.0, 0.0, Place::Angle::kEast},
                                {"vy", "XKF1", "VN"},
                                {"vy", "NKF1", "VN"},
                                {"vy", "EKF1", "VN"},
                                {"vy", "GPS", "Spd", 1.0, 0.0, Place::Angle::kNorth},
                                {"vz", "XKF1", "VD", -1.0},
                                {"vz", "NKF1", "VD", -1.0},
                                {"vz", "EKF1", "VD", -1.0},
                                {"vz", "GPS", "VZ", -1.0},
                                {"vz", "GPS", "VelZ", -1.0},
                                {"vn", "XKF1", "VN"},
                                {"vn", "NKF1", "VN"},
                                {"vn", "EKF1", "VN"},
                                {"vn", "GPS", "Spd", 1.0, 0.0, Place::Angle::kNorth},
                                {"ve", "XKF1", "VE"},
                                {"ve", "NKF1", "VE"},
                                {"ve", "EKF1", "VE"},
                                {"ve", "GPS", "Spd", 1.0, 0.0, Place::Angle::kEast},
                                {"airspeed", "ARSP", "Airspeed"},
                                {"airspeed", "NTUN", "Arspd"}};

double angleOf(double w, double x, double y, double z, Place::Angle angle) {
  switch (angle) {
    case Place::Angle::kRoll:
      return std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y));
    case Place::Angle::kPitch:
      return std::asin(std::clamp(2.0 * (w * y - z * x), -1.0, 1.0));
    case Place::Angle::kYaw:
      return std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
    default:
      break;
  }
  return 0.0;
}

// None where the table lacks the field.
std::optional<TimeSeries> seriesAt(const LogTable& table, const Place& place) {
  TimeSeries series;
  series.time = table.time;
  if (place.angle == Place::Angle::kNone) {
    const auto column = table.column.find(place.field);
    if (column == table.column.end()) return std::nullopt;
    for (const double value : column->second) series.value.push_back(place.scale * value + place.offset);
    return series;
  }
  if (place.angle == Place::Angle::kNorth || place.angle == Place::Angle::kEast) {
    const auto speed = table.column.find(place.field);
    const auto course = table.column.find("GCrs");
    if (speed == table.column.end() || course == table.column.end()) return std::nullopt;
    for (std::size_t row = 0; row < table.time.size(); ++row) {
      const double angle = kDegrees * course->second[row];
      series.value.push_back(speed->second[row] *
                             (place.angle == Place::Angle::kNorth ? std::cos(angle) : std::sin(angle)));
    }
    return series;
  }
  const std::vector<double>* part[4] = {};
  for (std::size_t index = 0; index < 4; ++index) {
    const auto column = table.column.find(std::string(place.field) + "[" + std::to_string(index) + "]");
    if (column == table.column.end()) return std::nullopt;
    part[index] = &column->second;
  }
  for (std::size_t row = 0; row < table.time.size(); ++row) {
    const double angle =
        angleOf((*part[0])[row], (*part[1])[row], (*part[2])[row], (*part[3])[row], place.angle);
    series.value.push_back(place.scale * angle + place.offset);
  }
  return series;
}

template <std::size_t kSize>
std::vector<Place> listOf(const Place (&places)[kSize]) {
  return {std::begin(places), std::end(places)};
}

// A place that was chosen, as text: -TABLE:FIELD:deg.
struct Choice {
  std::string signal;
  std::string text;
  std::string table;
  std::string field;
  double scale = 1.0;
};

Choice parseChoice(const std::string& path, const std::string& signal, const std::string& text) {
  const ChosenPlace chosen = chosenPlace(signal, text);
  const std::size_t colon = chosen.place.find(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == chosen.place.size()) {
    throw Error(path + ": --signal " + signal + "=" + text + ": must be TABLE:FIELD");
  }
  return {signal, text, chosen.place.substr(0, colon), chosen.place.substr(colon + 1), chosen.factor()};
}

// The name of a table without its instance.
std::string baseName(const std::string& table) { return table.substr(0, table.find('[')); }

void addSeries(const Place& place, const AutopilotLog& log, FlightSignals* signals) {
  const auto table = log.tables.find(place.table);
  if (table == log.tables.end() || signals->has(place.signal)) return;
  std::optional<TimeSeries> series = seriesAt(table->second, place);
  if (!series) return;
  signals->series[place.signal] = std::move(*series);
  signals->origin[place.signal] = std::string(place.table) + ":" + place.field;
}

void addChoice(const Choice& choice, const AutopilotLog& log, FlightSignals* signals) {
  const auto table = log.tables.find(choice.table);
  if (table == log.tables.end() || !table->second.has(choice.field)) {
    std::string known;
    for (const auto& [name, count] : log.counts) known += (known.empty() ? "" : ", ") + name;
    throw Error(log.path + ": --signal " + choice.signal + "=" + choice.text +
                ": no such field; the log has " + known);
  }
  TimeSeries series;
  series.time = table->second.time;
  for (const double value : table->second.column.at(choice.field))
    series.value.push_back(choice.scale * value);
  signals->series[choice.signal] = std::move(series);
  signals->origin[choice.signal] = choice.text;
}

double rootMeanSquare(const TimeSeries& series) {
  double squares = 0.0;
  for (const double value : series.value) squares += std::isfinite(value) ? value * value : 0.0;
  return series.value.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(series.value.size()));
}

// ArduCopter before 3.4 wrote RATE in hundredths of degrees per second under the same names. The gyro tells which.
void settleRate(AutopilotSignals* result) {
  FlightSignals* signals = &result->signals;
  constexpr double kHundredth = 0.01;
  constexpr double kBetween = 10.0;
  for (const char* name : {"yaw_rate", "gyro_z"}) {
    if (!signals->has(name)) return;
  }
  if (signals->origin.at("yaw_rate") != "RATE:Y") return;
  if (!(rootMeanSquare(signals->at("yaw_rate")) > kBetween * rootMeanSquare(signals->at("gyro_z")))) return;
  for (const char* name : {"yaw_rate", "yaw_rate_cmd"}) {
    if (!signals->has(name) || signals->origin.at(name).rfind("RATE:Y", 0) != 0) continue;
    for (double& value : signals->series.at(name).value) value *= kHundredth;
  }
  result->remarks.emplace_back("RATE is in hundredths of degrees per second, by the gyro");
}

bool isCommand(const std::string& signal) { return signal.find("_cmd") != std::string::npos; }

// A command as the loop got it: an autopilot logs one of many values that it sent, so between two of them the
// straight line comes closer than the first of the two. In steps so short that holding them means nothing.
TimeSeries betweenSamples(const TimeSeries& logged) {
  constexpr double kStep = 0.005;  // [s]
  constexpr double kPause = 0.3;   // [s] from which on nothing is known of what was between
  TimeSeries series;
  for (std::size_t i = 0; i + 1 < logged.time.size(); ++i) {
    const double period = logged.time[i + 1] - logged.time[i];
    const double rise = logged.value[i + 1] - logged.value[i];
    const bool fine = !(period > kStep && period < kPause) || !std::isfinite(rise);
    const int steps = fine ? 1 : static_cast<int>(std::ceil(period / kStep));
    for (int step = 0; step < steps; ++step) {
      // what is held over the step is its mean
      series.time.push_back(logged.time[i] + period * step / steps);
      series.value.push_back(logged.value[i] + (fine ? 0.0 : rise * (step + 0.5) / steps));
    }
  }
  if (!logged.time.empty()) {
    series.time.push_back(logged.time.back());
    series.value.push_back(logged.value.back());
  }
  return series;
}

// Leaves out of all responses what was measured while the vehicle stood.
// `start` is the zero of the log's own time.
void leaveGroundOut(const GroundTime& ground, double start, AutopilotSignals* result) {
  if (ground.windows.empty()) return;
  double stood = 0.0;
  double all = 0.0;
  TimeWindow whole;
  bool left = false;
  for (auto& [name, series] : result->signals.series) {
    if (isCommand(name) || series.time.empty()) continue;
    const double first = series.time.front();
    const double last = series.time.back();
    double here = 0.0;
    for (const TimeWindow& window : ground.windows)
      here += std::max(0.0, std::min(last, window.to) - std::max(first, window.from));
    if (last - first > all) {
      all = last - first;
      stood = here;
      whole = {first, last};
    }
    series = without(series, ground.windows);
    left = left || !series.time.empty();
  }
  if (!left) {
    throw Error(result->signals.source + ": " + ground.by +
                ": the vehicle never left the ground; --on-ground uses such times too");
  }
  char text[160];
  std::snprintf(text, sizeof text, "%.1f s of %.1f s were left out: the vehicle stood, by ", stood, all);
  if (stood > 0.0) result->remarks.push_back(text + ground.by);
  for (const TimeWindow& window : ground.windows) {
    const TimeWindow part = {std::max(whole.from, window.from) - start,
                             std::min(whole.to, window.to) - start};
    if (part.from < part.to)
      result->signals.not_flight.push_back({part, "the vehicle stood, by " + ground.by});
  }
}

}  // namespace

bool isAutopilotLog(const std::string& path) { return isULog(path) || isDataflash(path); }

AutopilotSignals signalsFromAutopilot(const std::string& path,
                                      const std::map<std::string, std::string>& choice, bool on_ground) {
  const bool px4 = isULog(path);
  const std::vector<Place> places = px4 ? listOf(kPx4) : listOf(kArduPilot);
  std::vector<Choice> choices;
  std::set<std::string> tables;
  for (const Place& place : places) tables.insert(place.table);
  for (const auto& [signal, text] : choice) {
    choices.push_back(parseChoice(path, signal, text));
    tables.insert(baseName(choices.back().table));
  }
  tables.insert(groundTables().begin(), groundTables().end());
  tables.insert(kVehicleTable);
  const std::vector<std::string> wanted(tables.begin(), tables.end());
  const AutopilotLog log = px4 ? readULog(path, wanted) : readDataflash(path, wanted);
  AutopilotSignals result;
  result.remarks = log.remarks;
  result.signals.source = path;
  result.signals.lossy = log.lossy;
  for (const auto& [name, count] : log.counts) result.signals.places.push_back(name);
  result.signals.vehicle = loggedVehicle(log);
  for (const Choice& one : choices) addChoice(one, log, &result.signals);
  for (const Place& place : places) addSeries(place, log, &result.signals);
  settleRate(&result);
  const bool chosen = choice.count("thrust_cmd") > 0;
  result.signals.thrust_is_share = result.signals.has("thrust_cmd") && !chosen;
  for (auto& [name, series] : result.signals.series) {
    if (isCommand(name)) series = betweenSamples(series);
  }
  double start = std::numeric_limits<double>::infinity();
  for (const auto& [name, series] : result.signals.series) {
    if (isAuxiliary(name)) continue;
    for (const double time : series.time) start = std::min(start, std::isfinite(time) ? time : start);
  }
  if (!std::isfinite(start)) {
    std::string known;
    for (const auto& [name, count] : log.counts) known += (known.empty() ? "" : ", ") + name;
    throw Error(path + ": holds no attitude, rate or thrust; choose with --signal from " + known);
  }
  if (!on_ground) leaveGroundOut(groundTime(log), start, &result);
  for (auto& [name, series] : result.signals.series) {
    for (double& time : series.time) time -= start;
  }
  return result;
}

}  // namespace polyfly
