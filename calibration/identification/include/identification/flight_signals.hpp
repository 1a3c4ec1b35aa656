#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "identification/csv_log.hpp"
#include "identification/identify_axis.hpp"
#include "identification/loop_record.hpp"
#include "identification/vehicle_kind.hpp"

namespace polyfly {

/// What of a flight identification works with, by these names, in SI units. Attitude is yaw, pitch, roll of the body
/// (x forward) in W. W and body alike have z up for multirotors, or z down throughout (fixed wing, NED).
///
/// | name | |
/// |---|---|
/// | roll_cmd, pitch_cmd, yaw_rate_cmd | as sent to the attitude controller [rad], [rad/s] |
/// | thrust_cmd | as sent, whatever its unit |
/// | roll, pitch, yaw, yaw_rate | measured [rad], [rad/s] |
/// | specific_force_z | along the body's z, by the accelerometer, + g at rest [m/s^2] |
/// | vx, vy, vz | in W [m/s] |
/// | vn, ve | velocity over ground to north and east [m/s] |
/// | gyro_z | rate about the body's z axis, by the gyro; for readers that check others by it [rad/s] |
struct FlightSignals {
  /// File that the signals come from.
  std::string source;
  /// Signals by the names above.
  std::map<std::string, TimeSeries> series;
  /// Column or topic of each signal.
  std::map<std::string, std::string> origin;
  /// True: thrust_cmd is known to be a share of full thrust.
  bool thrust_is_share = false;
  /// Sentences on how the file was read.
  std::vector<std::string> remarks;
  /// True: parts of the record are lost, as of a bag that was cut off.
  bool lossy = false;
  /// Stretches in which the vehicle does not fly, see findNonFlight. A reader leaves them empty.
  std::vector<RejectedWindow> not_flight;
  /// Columns, topics or tables of the file, whatever they hold.
  std::vector<std::string> places;
  VehicleKind vehicle;

  bool has(const std::string& name) const { return series.count(name) > 0; }
  /// Throws Error naming source, signal, and the option that chooses one.
  const TimeSeries& at(const std::string& name) const;
};

/// Radians of a degree.
constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180.0;

/// Roll, pitch or yaw of a quaternion, by the name of the angle; NaN for another name [rad].
double angleOf(double w, double x, double y, double z, const std::string& angle);

/// From the first to the last sample, on the flight's own clock [s]; from infinity to minus infinity without one.
TimeWindow spanOf(const FlightSignals& flight);

/// Goes on with the next piece of a recording. Its units must be those of the piece before.
void append(FlightSignals piece, FlightSignals* recording);

/// All names that FlightSignals knows.
const std::vector<std::string>& signalNames();

/// A place as the user names it: `-PLACE:deg` turns the sign and makes radians of degrees.
struct ChosenPlace {
  std::string place;
  double sign = 1.0;
  bool in_degrees = false;

  /// From the value at the place to that of the signal.
  double factor() const;
};

/// Throws Error where FlightSignals knows no such signal.
ChosenPlace chosenPlace(const std::string& signal, const std::string& text);

/// The signal without samples that cannot be used (see cleaned). Empty if there is none.
TimeSeries cleanSignal(const FlightSignals& signals, const std::string& name);

/// Sentences on where the times of the signals jump far, in the order of the record, and of which signals.
std::vector<std::string> clockRemarks(const FlightSignals& signals);

/// Finds the signals among the columns by their names (`roll_cmd_rad`, `wz_radps`, `vd_mps` ...; FORMAT in
/// README.md). `choice` names the column of a signal outright, with the unit in its name. A minus before it turns the
/// sign. `:deg` after it makes radians of degrees whatever the name says. It binds times as `time` (`COLUMN`, or
/// `SECONDS,NANOSECONDS`), and those of the commands as `cmd_time`. Throws Error when a chosen column is not there, a
/// name is not one of the above, or there is no column of times.
FlightSignals signalsFromCsv(const CsvLog& log, const std::map<std::string, std::string>& choice);

/// Whether the signal only serves others: it tells of no motion by itself.
bool isAuxiliary(const std::string& name);

/// A sentence for each of the four loops that recordedAxes does not give, on what is missing. One more tells the
/// places that the file has. Empty if there is no such loop.
std::vector<std::string> missingAxes(const FlightSignals& signals);

/// The loops whose command and response are both there, of: roll, pitch, yaw_rate, thrust.
std::vector<std::string> recordedAxes(const FlightSignals& signals);

/// Command and response of one loop. The response of thrust is the acceleration along the body's z that is not
/// gravity's. It comes from the accelerometer, or else from the vertical velocity and the tilt. Throws Error.
AxisRecords axisRecords(const FlightSignals& signals, const std::string& axis);

}  // namespace polyfly
