#include <iterator>

#include "validation/validation.hpp"

namespace polyfly {
namespace {

// In the order of ControlStatus, of LookupStatus, of Ignorance, of the fields of AttitudeCommand and of Verdict.
constexpr const char* kStatusNames[] = {"optimal",      "clipped",    "hold_last",      "level",
                                        "no_reference", "descend",    "stopped",        "manual",
                                        "motors_off",   "suboptimal", "least_violation"};
static_assert(std::size(kStatusNames) == kControlStatusCount, "each status has a name");
constexpr const char* kCauseNames[] = {"inside", "outside_box", "outside_partition", "not_finite"};
constexpr const char* kIgnoranceNames[] = {"begun_in_flight", "missing", "altered", "other_version"};
constexpr const char* kCommandNames[] = {"roll", "pitch", "yaw_rate", "thrust"};
constexpr const char* kCommandUnits[] = {"rad", "rad", "rad/s", "N"};
constexpr const char* kVerdictNames[] = {"passed", "doubtful", "failed"};

template <class Value>
Json orNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

template <class Part>
Json listOf(const std::vector<Part>& parts);

Json json(const TimeSpan& span) { return {span.from, span.to}; }

Json json(const Difference& difference) {
  return {{"max", difference.max}, {"rms", difference.rms}, {"at_s", difference.stamp}};
}

Json json(const Percentiles& times) {
  return {
      {"p50", times.p50}, {"p90", times.p90}, {"p99", times.p99}, {"p99_9", times.p999}, {"max", times.max}};
}

Json json(const DistanceUse& use, std::size_t samples) {
  const double count = samples > 0 ? static_cast<double>(samples) : 1.0;
  return {{"least", use.least}, {"mean", use.sum / count}, {"at_s", use.stamp}};
}

Json json(const ParameterUse& use) {
  const auto [lower, upper] = use.proposedRange();
  return {{"name", use.name},       {"unit", use.unit},
          {"lower", use.lower},     {"upper", use.upper},
          {"least", use.least},     {"greatest", use.greatest},
          {"outside", use.outside}, {"margin", use.margin()},
          {"room", use.room},       {"proposed_range", {lower, upper}}};
}

// Samples by status; of those that were met, or of all.
Json countsOf(const std::array<std::size_t, kControlStatusCount>& counts, bool all) {
  Json out = Json::object();
  for (std::size_t status = 0; status < counts.size(); ++status) {
    if (all || counts[status] > 0) out[kStatusNames[status]] = counts[status];
  }
  return out;
}

Json json(const Excursion& excursion) {
  return {
      {"from_s", excursion.from},         {"to_s", excursion.to},
      {"samples", excursion.samples},     {"cause", kCauseNames[static_cast<std::size_t>(excursion.cause)]},
      {"parameter", excursion.parameter}, {"beyond", excursion.beyond},
      {"unit", excursion.unit},           {"status", countsOf(excursion.statuses, false)}};
}

Json json(const AxisValidation& axis) {
  Json out = {{"axis", axis.axis},
              {"input", axis.input},
              {"input_unit", axis.input_unit},
              {"regions", axis.regions()},
              {"regions_visited", axis.visited()}};
  for (std::size_t region = 0; region < axis.regions(); ++region) {
    if (axis.region_samples[region] > 0)
      out["region_samples"].push_back({region, axis.region_samples[region]});
  }
  out["regions_never_visited"] = axis.neverVisited();
  out["samples"] = axis.samples;
  out["inside"] = axis.inside;
  out["outside_box"] = axis.outside_box;
  out["outside_partition"] = axis.outside_partition;
  out["not_finite"] = axis.not_finite;
  out["parameters"] = listOf(axis.parameters);
  out["face_distance"] = json(axis.face, axis.inside);
  out["edge_distance"] = json(axis.edge, axis.inside);
  out["edge_distance"]["parameter"] =
      axis.edge_parameter < 0 ? Json()
                              : Json(axis.parameters[static_cast<std::size_t>(axis.edge_parameter)].name);
  out["excursions"] = listOf(axis.excursions);
  out["qp_compared"] = axis.qp_compared;
  out["qp_failures"] = axis.qp_failures;
  out["qp_difference"] = json(axis.qp);
  out["lookup_ns"] = json(axis.lookup_ns);
  out["tracking_m"] = json(axis.tracking);
  return out;
}

Json json(const CommandValidation& commands) {
  Json out = {{"recorded", commands.recorded},
              {"compared", commands.compared},
              {"unmatched", commands.unmatched},
              {"unanswered", commands.unanswered}};
  for (std::size_t entry = 0; entry < commands.difference.size(); ++entry) {
    Json difference = json(commands.difference[entry]);
    difference["unit"] = kCommandUnits[entry];
    out["difference"][kCommandNames[entry]] = difference;
  }
  out["violations"] = {{"angle", commands.angle_violations},
                       {"thrust", commands.thrust_violations},
                       {"yaw_rate", commands.yaw_rate_violations},
                       {"not_finite", commands.not_finite}};
  return out;
}

Json json(const StatusValidation& statuses) {
  return {{"replayed", countsOf(statuses.replayed, true)},
          {"recorded", countsOf(statuses.recorded, true)},
          {"compared", statuses.compared},
          {"differing", statuses.differing},
          {"max_theta_difference", statuses.max_theta_difference},
          {"max_input_difference", statuses.max_input_difference},
          {"step_ns_in_flight", json(statuses.step_ns)}};
}

Json json(const HoldOffset& hold) {
  return {{"from_s", hold.from},
          {"to_s", hold.to},
          {"offset_m", {hold.offset.x(), hold.offset.y(), hold.offset.z()}}};
}

Json json(const RecordingShare::Amount& amount) {
  return {{"read", amount.read}, {"recorded", orNull(amount.recorded)}, {"share", orNull(amount.share())}};
}

Json json(const RecordingShare& share, bool is_whole) {
  return {{"messages", json(share.messages)},
          {"bytes", json(share.bytes)},
          {"seconds", json(share.seconds)},
          {"whole", is_whole},
          {"lost", listOf(share.lost)}};
}

Json json(const ParametersTold::Change& change) {
  return {{"at_s", change.time}, {"cause", change.cause}, {"parameters", change.parameters}};
}

Json json(const ParametersTold& parameters, const std::array<AxisValidation, 3>& names) {
  Json out = {{"node", parameters.node},
              {"version", parameters.version},
              {"law", parameters.law},
              {"provenance", parameters.provenance}};
  for (std::size_t i = 0; i < parameters.axes.size(); ++i) {
    const ParametersTold::Axis& axis = parameters.axes[i];
    out["axes"].push_back({{"axis", names[i].axis},
                           {"map", axis.map},
                           {"map_checksum", axis.map_checksum},
                           {"problem", axis.problem},
                           {"calibration", axis.calibration}});
  }
  out["changes"] = listOf(parameters.changes);
  return out;
}

Json json(const IncomparableStretch& stretch) {
  return {{"cause", kIgnoranceNames[static_cast<std::size_t>(stretch.cause)]},
          {"from_s", stretch.from},
          {"to_s", stretch.to},
          {"samples", stretch.samples}};
}

template <class Part>
Json listOf(const std::vector<Part>& parts) {
  Json list = Json::array();
  for (const Part& part : parts) list.push_back(json(part));
  return list;
}

}  // namespace

Json jsonOf(const ValidationReport& report) {
  Json out = {{"verdict", kVerdictNames[static_cast<std::size_t>(report.verdict())]},
              {"regions", report.regionCount()},
              {"regions_visited", report.visitedCount()},
              {"samples", report.samples},
              {"tracked_samples", report.tracked_samples},
              {"duration_s", report.duration},
              {"top_speed_m_s", report.top_speed},
              {"tracking_rms_m", report.tracking.rms},
              {"tracking_max_m", report.tracking.max},
              {"constraint_violations", report.violationCount()},
              {"coverage", report.coverage},
              {"outside_map_samples", report.outside_map_samples},
              {"outside_map_s", report.outside_map_time},
              {"max_qp_difference", report.maxQpDifference()},
              {"max_command_difference", report.commands.max_difference}};
  const Json lookup = json(report.lookup_ns);
  for (const auto& [name, time] : lookup.items()) out["lookup_ns_" + name] = time;
  out["steady_state_offset_m"] = report.hold ? Json(report.hold->offset.norm()) : Json();
  for (const AxisValidation& axis : report.axes) out["axes"].push_back(json(axis));
  out["commands"] = json(report.commands);
  out["status"] = json(report.statuses);
  out["hold"] = report.hold ? json(*report.hold) : Json();
  out["recording"] = report.share ? json(*report.share, report.isWhole()) : Json();
  out["incomparable"] = listOf(report.incomparable);
  out["parameters"] = report.parameters ? json(*report.parameters, report.axes) : Json();
  out["broken"] = report.broken;
  out["warnings"] = report.warnings;
  return out;
}

Json jsonOf(const ValidationReport& all, const std::vector<ValidationReport>& flights) {
  Json out = jsonOf(all);
  for (const ValidationReport& flight : flights) {
    Json one = {{"source", fileName(flight.source)}};
    one.update(jsonOf(flight));
    out["flights"].push_back(one);
  }
  return out;
}

}  // namespace polyfly
