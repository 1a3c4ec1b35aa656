#include "ground_time.hpp"

#include <algorithm>
#include <limits>

namespace polyfly {
namespace {

constexpr double kEver = std::numeric_limits<double>::infinity();

// Numbers of ArduPilot's events.
constexpr int kArmed = 10;
constexpr int kDisarmed = 11;
constexpr int kLanded = 18;
constexpr int kNotLanded = 28;

// Whether the vehicle stands, from a time on.
struct Step {
  double time = 0.0;
  bool stands = false;
};

// `stands_before`: what held until the first step.
GroundTime fromSteps(const std::string& by, const std::vector<Step>& steps, bool stands_before) {
  GroundTime result;
  result.by = by;
  bool stands = stands_before;
  double since = -kEver;
  for (const Step& step : steps) {
    if (step.stands == stands) continue;
    if (stands) result.windows.push_back({since, step.time});
    stands = step.stands;
    since = step.time;
  }
  if (stands) result.windows.push_back({since, kEver});
  return result;
}

// Steps of a field that is written again and again: `standing` is its value on the ground.
GroundTime fromState(const AutopilotLog& log, const char* table, const char* field, double standing) {
  const auto found = log.tables.find(table);
  if (found == log.tables.end() || !found->second.has(field) || found->second.time.empty()) return {};
  const std::vector<double>& value = found->second.column.at(field);
  std::vector<Step> steps;
  for (std::size_t row = 0; row < value.size(); ++row)
    steps.push_back({found->second.time[row], value[row] == standing});
  return fromSteps(std::string(table) + "." + field, steps, steps.front().stands);
}

// Steps of events, which are written when something changes: before the first the other state held.
GroundTime fromEvents(const AutopilotLog& log, int flies, const std::vector<int>& stands) {
  const auto found = log.tables.find("EV");
  if (found == log.tables.end() || !found->second.has("Id")) return {};
  const std::vector<double>& id = found->second.column.at("Id");
  if (std::find(id.begin(), id.end(), static_cast<double>(flies)) == id.end()) return {};
  std::vector<Step> steps;
  for (std::size_t row = 0; row < id.size(); ++row) {
    const int event = static_cast<int>(id[row]);
    const bool standing = std::find(stands.begin(), stands.end(), event) != stands.end();
    if (standing || event == flies) steps.push_back({found->second.time[row], standing});
  }
  return fromSteps("EV", steps, !steps.front().stands);
}

}  // namespace

const std::vector<std::string>& groundTables() {
  static const std::vector<std::string> kNames = {"vehicle_land_detected", "STAT", "EV", "ARM"};
  return kNames;
}

GroundTime groundTime(const AutopilotLog& log) {
  if (log.kind == AutopilotLog::Kind::kULog) return fromState(log, "vehicle_land_detected", "landed", 1.0);
  for (const GroundTime& told :
       {fromState(log, "STAT", "isFlying", 0.0), fromEvents(log, kNotLanded, {kLanded, kDisarmed}),
        fromEvents(log, kArmed, {kDisarmed}), fromState(log, "ARM", "ArmState", 0.0)}) {
    if (!told.by.empty()) return told;
  }
  return {};
}

}  // namespace polyfly
