#include <filesystem>
#include <nlohmann/json.hpp>

#include "validation/validation.hpp"
#include "validation_names.hpp"

namespace polyfly {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Difference& difference) {
  return {{"max", difference.max}, {"rms", difference.rms}, {"at_s", difference.stamp}};
}

Json json(const Percentiles& times) {
  return {
      {"p50", times.p50}, {"p90", times.p90}, {"p99", times.p99}, {"p99_9", times.p999}, {"max", times.max}};
}

Json json(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

Json json(const ParameterUse& use) {
  Json out = {{"name", use.name}, {"unit", use.unit}, {"lower", use.lower}, {"upper", use.upper}};
  out["least"] = use.least;
  out["greatest"] = use.greatest;
  out["outside"] = use.outside;
  out["margin"] = use.margin();
  out["room"] = use.room;
  out["histogram"] = use.histogram;
  const auto [lower, upper] = use.proposedRange();
  out["proposed_range"] = {lower, upper};
  return out;
}

Json json(const Excursion& excursion) {
  Json out = {{"from_s", excursion.from}, {"to_s", excursion.to}, {"samples", excursion.samples}};
  out["cause"] = kCauseNames[static_cast<std::size_t>(excursion.cause)];
  out["parameter"] = excursion.parameter;
  out["beyond"] = excursion.beyond;
  out["unit"] = excursion.unit;
  for (std::size_t status = 0; status < excursion.statuses.size(); ++status) {
    if (excursion.statuses[status] > 0) out["status"][kStatusNames[status]] = excursion.statuses[status];
  }
  return out;
}

Json json(const AxisValidation& axis) {
  Json out;
  out["axis"] = axis.axis;
  out["input"] = axis.input;
  out["input_unit"] = axis.input_unit;
  out["regions"] = axis.regions();
  out["regions_visited"] = axis.visited();
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
  for (const ParameterUse& use : axis.parameters) out["parameters"].push_back(json(use));
  const double held = axis.inside > 0 ? static_cast<double>(axis.inside) : 1.0;
  out["face_distance"] = {
      {"least", axis.face.least}, {"mean", axis.face.sum / held}, {"at_s", axis.face.stamp}};
  out["edge_distance"] = {
      {"least", axis.edge.least}, {"mean", axis.edge.sum / held}, {"at_s", axis.edge.stamp}};
  out["edge_distance"]["parameter"] =
      axis.edge_parameter < 0 ? Json()
                              : Json(axis.parameters[static_cast<std::size_t>(axis.edge_parameter)].name);
  out["excursions"] = Json::array();
  for (const Excursion& excursion : axis.excursions) out["excursions"].push_back(json(excursion));
  for (const MapUse::Window& window : axis.windows) {
    out["by_second"].push_back({window.from, window.samples, window.inside});
  }
  out["qp_compared"] = axis.qp_compared;
  out["qp_failures"] = axis.qp_failures;
  out["qp_difference"] = json(axis.qp);
  out["lookup_ns"] = json(axis.lookup_ns);
  out["lookup_shuffled_ns"] = json(axis.lookup_shuffled_ns);
  out["tracking_m"] = json(axis.tracking);
  return out;
}

Json json(const CommandValidation& commands) {
  Json out;
  out["recorded"] = commands.recorded;
  out["compared"] = commands.compared;
  out["unmatched"] = commands.unmatched;
  out["unanswered"] = commands.unanswered;
  for (std::size_t entry = 0; entry < 4; ++entry) {
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
  Json out;
  for (std::size_t status = 0; status < kControlStatusCount; ++status) {
    out["replayed"][kStatusNames[status]] = statuses.replayed[status];
    out["recorded"][kStatusNames[status]] = statuses.recorded[status];
  }
  out["compared"] = statuses.compared;
  out["differing"] = statuses.differing;
  out["max_theta_difference"] = statuses.max_theta_difference;
  out["step_ns_in_flight"] = json(statuses.step_ns);
  return out;
}

Json json(const HoldOffset& hold) {
  Json out;
  out["from_s"] = hold.from;
  out["to_s"] = hold.to;
  out["offset_m"] = json(hold.offset);
  out["disturbance_estimate_m_s2"] = json(hold.estimate);
  out["disturbance_m_s2"] = hold.disturbance ? json(*hold.disturbance) : Json();
  return out;
}

Json json(const MapComparison& other) {
  Json out = {{"axis", other.axis}, {"map", std::filesystem::path(other.path).filename().string()}};
  out["regions"] = other.use.regions();
  out["regions_visited"] = other.use.visited();
  out["samples"] = other.use.samples;
  out["inside"] = other.use.inside;
  out["inside_both"] = other.both;
  out["inside_only_flown"] = other.only_flown;
  out["inside_only_other"] = other.only_other;
  out["difference"] = json(other.difference);
  out["unit"] = other.input_unit;
  out["qp_difference"] = json(other.qp);
  out["qp_failures"] = other.qp_failures;
  out["lookup_ns"] = json(other.lookup_ns);
  return out;
}

Json json(const MapProposal& proposal) {
  Json out = {{"axis", proposal.axis}, {"map", std::filesystem::path(proposal.map_path).filename().string()}};
  out["changes"] = Json::array();
  for (const MapProposal::Change& change : proposal.changes) {
    out["changes"].push_back({{"parameter", change.parameter}, {"from", change.from}, {"to", change.to}});
  }
  out["samples_without_solution"] = proposal.infeasible;
  out["obstacle"] = proposal.obstacle;
  out["regions"] = proposal.regions;
  out["regions_then"] = proposal.regions_then;
  out["counted_all"] = proposal.counted_all;
  return out;
}

Json json(const RecordingShare::Amount& amount) {
  Json out = {{"read", amount.read}};
  out["recorded"] = amount.recorded ? Json(*amount.recorded) : Json();
  out["share"] = amount.share() ? Json(*amount.share()) : Json();
  return out;
}

Json json(const RecordingShare& share, bool is_whole) {
  Json lost = Json::array();
  for (const TimeSpan& span : share.lost) lost.push_back({span.from, span.to});
  return {{"messages", json(share.messages)},
          {"bytes", json(share.bytes)},
          {"seconds", json(share.seconds)},
          {"whole", is_whole},
          {"lost", std::move(lost)}};
}

Json json(const ParametersTold& parameters) {
  Json out = {{"node", parameters.node}, {"law", parameters.law}, {"provenance", parameters.provenance}};
  out["axes"] = Json::array();
  for (const ParametersTold::Axis& axis : parameters.axes) {
    out["axes"].push_back({{"map", axis.map},
                           {"map_checksum", axis.map_checksum},
                           {"problem", axis.problem},
                           {"calibration", axis.calibration}});
  }
  out["changes"] = Json::array();
  for (const ParametersTold::Change& change : parameters.changes)
    out["changes"].push_back(
        {{"at_s", change.time}, {"cause", change.cause}, {"parameters", change.parameters}});
  return out;
}

Json json(const ValidationReport& report) {
  Json out;
  out["verdict"] = nameOf(report.verdict());
  out["regions"] = report.regionCount();
  out["regions_visited"] = report.visitedCount();
  out["samples"] = report.samples;
  out["tracked_samples"] = report.tracked_samples;
  out["duration_s"] = report.duration;
  out["top_speed_m_s"] = report.top_speed;
  out["tracking_rms_m"] = report.tracking.rms;
  out["tracking_max_m"] = report.tracking.max;
  out["constraint_violations"] = report.violationCount();
  out["coverage"] = report.coverage;
  out["outside_map_samples"] = report.outside_map_samples;
  out["outside_map_s"] = report.outside_map_time;
  out["max_qp_difference"] = report.maxQpDifference();
  out["max_command_difference"] = report.commands.max_difference;
  out["lookup_ns_p50"] = report.lookup_ns.p50;
  out["lookup_ns_p90"] = report.lookup_ns.p90;
  out["lookup_ns_p99"] = report.lookup_ns.p99;
  out["lookup_ns_p99_9"] = report.lookup_ns.p999;
  out["lookup_ns_max"] = report.lookup_ns.max;
  out["steady_state_offset_m"] = report.hold ? Json(report.hold->offset.norm()) : Json();
  for (const AxisValidation& axis : report.axes) out["axes"].push_back(json(axis));
  out["commands"] = json(report.commands);
  out["status"] = json(report.statuses);
  out["hold"] = report.hold ? json(*report.hold) : Json();
  out["recording"] = report.share ? json(*report.share, report.isWhole()) : Json();
  out["incomparable"] = Json::array();
  for (const IncomparableStretch& stretch : report.incomparable) {
    out["incomparable"].push_back({{"cause", kIgnoranceNames[static_cast<std::size_t>(stretch.cause)]},
                                   {"from_s", stretch.from},
                                   {"to_s", stretch.to},
                                   {"samples", stretch.samples}});
  }
  out["parameters"] = report.parameters ? json(*report.parameters) : Json();
  out["broken"] = report.broken;
  out["warnings"] = report.warnings;
  out["comparisons"] = Json::array();
  for (const MapComparison& comparison : report.comparisons) out["comparisons"].push_back(json(comparison));
  out["proposals"] = Json::array();
  for (const MapProposal& proposal : report.proposals) out["proposals"].push_back(json(proposal));
  return out;
}

// Names of files need not be UTF-8, but JSON must be.
std::string dumped(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string toJson(const ValidationReport& report) { return dumped(json(report)); }

std::string toJson(const ValidationReport& all, const std::vector<ValidationReport>& flights) {
  Json out = json(all);
  for (const ValidationReport& flight : flights) {
    Json one = {{"source", std::filesystem::path(flight.source).filename().string()}};
    one.update(json(flight));
    out["flights"].push_back(one);
  }
  return dumped(out);
}

}  // namespace polyfly
