#include "autopilot/autopilot_signals.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <set>
#include <sstream>

#include "autopilot/autopilot_log.hpp"
#include "ground_time.hpp"
#include "logged_vehicle.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"

namespace polyfly {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegrees = kPi / 180.0;

// Where a signal may be, in the words of --signal: [-]TABLE:FIELD[:deg], separated by blanks. The first place that the log
// has counts. Of a quaternion .roll, .pitch or .yaw is an angle; of a speed in GPS .north or .east is the part along
// that direction, by the course GCrs; :cdeg is hundredths of degrees.
struct Places {
  const char* signal;
  const char* words;
};

// Roll is the same in both frames, pitch and yaw turn their sign, and yaw counts from east, not north.
constexpr Places kPx4[] = {
    {"roll_cmd", "vehicle_attitude_setpoint:roll_body vehicle_attitude_setpoint:q_d.roll"},
    {"pitch_cmd", "-vehicle_attitude_setpoint:pitch_body -vehicle_attitude_setpoint:q_d.pitch"},
    {"yaw_rate_cmd", "-vehicle_rates_setpoint:yaw"},
    {"thrust_cmd",
     "-vehicle_attitude_setpoint:thrust_body[2] vehicle_attitude_setpoint:thrust "
     "-vehicle_rates_setpoint:thrust_body[2] vehicle_rates_setpoint:thrust"},
    {"roll", "vehicle_attitude:q.roll vehicle_attitude:roll"},
    {"pitch", "-vehicle_attitude:q.pitch -vehicle_attitude:pitch"},
    {"yaw", "-vehicle_attitude:q.yaw -vehicle_attitude:yaw"},
    {"yaw_rate", "-vehicle_angular_velocity:xyz[2] -vehicle_attitude:yawspeed -sensor_combined:gyro_rad[2]"},
    {"specific_force_z", "-sensor_combined:accelerometer_m_s2[2] -vehicle_acceleration:xyz[2]"},
    {"gyro_z", "-sensor_combined:gyro_rad[2]"},
    {"vx", "vehicle_local_position:vy"},
    {"vy", "vehicle_local_position:vx"},
    {"vz", "-vehicle_local_position:vz"},
    {"vn", "vehicle_local_position:vx vehicle_global_position:vel_n"},
    {"ve", "vehicle_local_position:vy vehicle_global_position:vel_e"}};

constexpr Places kArduPilot[] = {{"roll_cmd", "ATT:DesRoll:deg ATT:RollIn:deg CTUN:NavRoll:deg"},
                                 {"pitch_cmd", "-ATT:DesPitch:deg -ATT:PitchIn:deg -CTUN:NavPitch:deg"},
                                 {"roll", "ATT:Roll:deg"},
                                 {"pitch", "-ATT:Pitch:deg"},
                                 {"yaw", "-ATT:Yaw:deg"},
                                 {"yaw_rate_cmd", "-RATE:YDes:deg -RATE:YawDes:cdeg"},
                                 {"yaw_rate", "-RATE:Y:deg -RATE:Yaw:cdeg"},
                                 {"thrust_cmd", "CTUN:ThO CTUN:ThrOut"},
                                 {"specific_force_z", "-IMU:AccZ"},
                                 {"gyro_z", "-IMU:GyrZ"},
                                 {"vx", "XKF1:VE NKF1:VE EKF1:VE GPS:Spd.east"},
                                 {"vy", "XKF1:VN NKF1:VN EKF1:VN GPS:Spd.north"},
                                 {"vz", "-XKF1:VD -NKF1:VD -EKF1:VD -GPS:VZ -GPS:VelZ"},
                                 {"vn", "XKF1:VN NKF1:VN EKF1:VN GPS:Spd.north"},
                                 {"ve", "XKF1:VE NKF1:VE EKF1:VE GPS:Spd.east"}};

// One such place.
struct Place {
  std::string signal;
  std::string word;
  std::string table;
  std::string field;
  // What is taken of a quaternion or of a speed: roll, pitch, yaw, north, east; empty: the number itself.
  std::string part;
  double scale = 1.0;
  double offset = 0.0;
};

Place placeOf(const std::string& signal, const std::string& word) {
  const std::string hundredths = ":cdeg";
  const bool is_hundredth = endsWith(word, hundredths);
  const std::string plain = is_hundredth ? word.substr(0, word.size() - hundredths.size()) : word;
  const ChosenPlace chosen = chosenPlace(signal, plain);
  const std::size_t colon = chosen.place.find(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == chosen.place.size())
    throw Error("--signal " + signal + "=" + word + ": must be TABLE:FIELD");
  Place place = {signal, word, chosen.place.substr(0, colon), chosen.place.substr(colon + 1), ""};
  place.scale = chosen.factor() * (is_hundredth ? 0.01 * kDegrees : 1.0);
  for (const std::string part : {"roll", "pitch", "yaw", "north", "east"}) {
    if (!endsWith(place.field, "." + part)) continue;
    place.part = part;
    place.field.resize(place.field.size() - part.size() - 1);
  }
  return place;
}

template <std::size_t kSize>
std::vector<Place> listOf(const Places (&list)[kSize]) {
  std::vector<Place> places;
  for (const Places& one : list) {
    std::istringstream words(one.words);
    for (std::string word; words >> word;) {
      places.push_back(placeOf(one.signal, word));
      if (places.back().signal == "yaw") places.back().offset = 0.5 * kPi;
    }
  }
  return places;
}

// None where the table lacks the field.
std::optional<TimeSeries> seriesAt(const LogTable& table, const Place& place) {
  const bool is_speed = place.part == "north" || place.part == "east";
  std::vector<std::string> fields = {place.field};
  if (is_speed) fields.emplace_back("GCrs");
  if (!place.part.empty() && !is_speed)
    fields = {place.field + "[0]", place.field + "[1]", place.field + "[2]", place.field + "[3]"};
  std::vector<const std::vector<double>*> columns;
  for (const std::string& field : fields) {
    if (!table.has(field)) return std::nullopt;
    columns.push_back(&table.column.at(field));
  }
  TimeSeries series;
  series.time = table.time;
  for (std::size_t row = 0; row < table.time.size(); ++row) {
    const auto at = [&](std::size_t column) { return (*columns[column])[row]; };
    double value = at(0);
    if (is_speed) {
      value *= place.part == "north" ? std::cos(kDegrees * at(1)) : std::sin(kDegrees * at(1));
    } else if (!place.part.empty()) {
      value = angleOf(at(0), at(1), at(2), at(3), place.part);
    }
    series.value.push_back(place.scale * value + place.offset);
  }
  return series;
}

// The name of a table without its instance.
std::string baseName(const std::string& table) { return table.substr(0, table.find('[')); }

std::string namesOf(const AutopilotLog& log) {
  std::string known;
  for (const auto& [name, count] : log.counts) known += (known.empty() ? "" : ", ") + name;
  return known;
}

// Whether the log has the place.
bool addSeries(const Place& place, const AutopilotLog& log, FlightSignals* signals) {
  const auto table = log.tables.find(place.table);
  if (table == log.tables.end()) return false;
  std::optional<TimeSeries> series = seriesAt(table->second, place);
  if (!series) return false;
  signals->series[place.signal] = std::move(*series);
  signals->origin[place.signal] = place.word;
  return true;
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
  if (signals->origin.at("yaw_rate") != "-RATE:Y:deg") return;
  if (!(rootMeanSquare(signals->at("yaw_rate")) > kBetween * rootMeanSquare(signals->at("gyro_z")))) return;
  for (const char* name : {"yaw_rate", "yaw_rate_cmd"}) {
    if (!signals->has(name) || signals->origin.at(name).rfind("-RATE:Y", 0) != 0) continue;
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
  std::vector<Place> choices;
  std::set<std::string> tables;
  for (const Place& place : places) tables.insert(place.table);
  for (const auto& [signal, text] : choice) {
    choices.push_back(placeOf(signal, text));
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
  for (const Place& one : choices) {
    if (!addSeries(one, log, &result.signals))
      throw Error(path + ": --signal " + one.signal + "=" + one.word + ": no such field; the log has " +
                  namesOf(log));
  }
  for (const Place& place : places) {
    if (!result.signals.has(place.signal)) addSeries(place, log, &result.signals);
  }
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
  if (!std::isfinite(start))
    throw Error(path + ": holds no attitude, rate or thrust; choose with --signal from " + namesOf(log));
  if (!on_ground) leaveGroundOut(groundTime(log), start, &result);
  for (auto& [name, series] : result.signals.series) {
    for (double& time : series.time) time -= start;
  }
  return result;
}

}  // namespace polyfly
