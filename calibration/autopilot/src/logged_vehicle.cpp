#include "logged_vehicle.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace polyfly {
namespace {

// One value of a field of vehicle_status that names a kind.
struct StatusValue {
  const char* field;
  double value;
  const char* kind;
};

// vehicle_type since PX4 1.10, is_rotary_wing before.
constexpr StatusValue kStatusValues[] = {{"vehicle_type", 1.0, "multirotor"},
                                         {"vehicle_type", 2.0, "fixed_wing"},
                                         {"is_rotary_wing", 1.0, "multirotor"},
                                         {"is_rotary_wing", 0.0, "fixed_wing"}};

VehicleKind ofStatus(const LogTable& table) {
  for (const StatusValue& status : kStatusValues) {
    const auto column = table.column.find(status.field);
    if (column == table.column.end() || column->second.empty()) continue;
    const std::vector<double>& values = column->second;
    if (!std::all_of(values.begin(), values.end(), [&](double value) { return value == status.value; }))
      continue;
    return {status.kind, std::string("The log names it (") + kVehicleTable + "." + status.field + ")."};
  }
  return {};
}

// Messages that one of ArduPilot's vehicles writes and the others do not.
VehicleKind ofMessages(const AutopilotLog& log) {
  const auto has = [&log](const char* name) {
    const auto found = log.counts.find(name);
    return found != log.counts.end() && found->second > 0;
  };
  if (has("QTUN")) return {};  // a plane with lift rotors
  for (const char* name : {"TECS", "AETR"}) {
    if (has(name)) return {"fixed_wing", std::string("The log has ") + name + ", which ArduPlane writes."};
  }
  if (has("MOTB")) return {"multirotor", "The log has MOTB, which ArduCopter writes."};
  return {};
}

}  // namespace

VehicleKind loggedVehicle(const AutopilotLog& log) {
  if (log.kind == AutopilotLog::Kind::kDataflash) return ofMessages(log);
  const auto status = log.tables.find(kVehicleTable);
  return status == log.tables.end() ? VehicleKind{} : ofStatus(status->second);
}

}  // namespace polyfly
