#include <cmath>
#include <iomanip>
#include <locale>
#include <nlohmann/json.hpp>
#include <sstream>

#include "calibration/validation.hpp"

namespace polyfly {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kStatusNames[5] = {"optimal", "clipped", "hold_last", "level", "no_reference"};
constexpr const char* kCommandNames[4] = {"roll", "pitch", "yaw_rate", "thrust"};
constexpr const char* kCommandUnits[4] = {"rad", "rad", "rad/s", "N"};

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
  const auto [lower, upper] = use.proposedRange();
  out["proposed_range"] = {lower, upper};
  return out;
}

Json json(const AxisValidation& axis) {
  Json out;
  out["axis"] = axis.axis;
  out["input"] = axis.input;
  out["input_unit"] = axis.input_unit;
  out["regions"] = axis.regions;
  out["regions_visited"] = axis.visited;
  out["regions_never_visited"] = axis.never_visited;
  out["samples"] = axis.samples;
  out["inside"] = axis.inside;
  out["outside_box"] = axis.outside_box;
  out["outside_partition"] = axis.outside_partition;
  out["not_finite"] = axis.not_finite;
  for (const ParameterUse& use : axis.parameters) out["parameters"].push_back(json(use));
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
  for (std::size_t status = 0; status < 5; ++status) {
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

void writeAxis(const AxisValidation& axis, std::ostream& out) {
  out << "\n  " << axis.axis << ": " << axis.inside << " of " << axis.samples << " samples inside, "
      << axis.visited << " of " << axis.regions << " regions visited\n";
  if (axis.inside != axis.samples) {
    out << "    outside: box " << axis.outside_box << ", partition " << axis.outside_partition
        << ", not finite " << axis.not_finite << "\n";
    for (const ParameterUse& use : axis.parameters) {
      if (use.outside == 0) continue;
      out << "    " << use.name << " out of " << use.lower << " .. " << use.upper << " " << use.unit << " in "
          << use.outside << " samples (went from " << use.least << " to " << use.greatest << "); range: ["
          << use.proposedRange().first << ", " << use.proposedRange().second << "] would have held it\n";
    }
  }
  out << "    explicit against online: at most " << axis.qp.max << " " << axis.input_unit << " over "
      << axis.qp_compared << " samples";
  if (axis.qp.max > 0.0)
    out << ", at " << std::setprecision(12) << axis.qp.stamp << std::setprecision(4) << " s";
  if (axis.qp_failures > 0) out << "; no online solution in " << axis.qp_failures;
  out << "\n    look-up [ns]: median " << axis.lookup_ns.p50 << ", p99 " << axis.lookup_ns.p99 << ", max "
      << axis.lookup_ns.max << "; in random order median " << axis.lookup_shuffled_ns.p50 << ", p99 "
      << axis.lookup_shuffled_ns.p99 << "\n    position error: rms " << axis.tracking.rms << " m, max "
      << axis.tracking.max << " m\n";
}

void writeCommands(const CommandValidation& commands, std::ostream& out) {
  out << "\n  commands: " << commands.compared << " of " << commands.recorded << " recorded ones compared";
  if (commands.unmatched > 0) out << ", " << commands.unmatched << " answer no odometry";
  if (commands.unanswered > 0) out << ", " << commands.unanswered << " odometry messages unanswered";
  out << "\n";
  for (std::size_t entry = 0; entry < 4; ++entry) {
    const Difference& difference = commands.difference[entry];
    out << "    " << kCommandNames[entry] << ": recorded - replayed at most " << difference.max << " "
        << kCommandUnits[entry] << ", rms " << difference.rms << "\n";
  }
  out << "    out of bounds: angle " << commands.angle_violations << ", thrust " << commands.thrust_violations
      << ", yaw rate " << commands.yaw_rate_violations << ", not finite " << commands.not_finite << "\n";
}

}  // namespace

std::vector<std::string> brokenThresholds(const ValidationReport& report, const Thresholds& thresholds) {
  std::vector<std::string> broken;
  // Written so that a NaN breaks its threshold.
  const auto check = [&broken](bool good, const std::string& what, double value, const char* rule,
                               double limit) {
    if (good) return;
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << what << " is " << value << ", " << rule << " " << limit;
    broken.push_back(text.str());
  };
  check(report.coverage >= thresholds.min_coverage, "coverage", report.coverage, "must be at least",
        thresholds.min_coverage);
  check(report.maxQpDifference() <= thresholds.max_qp_difference, "difference to the online QP",
        report.maxQpDifference(), "must be at most", thresholds.max_qp_difference);
  check(report.commands.max_difference <= thresholds.max_command_difference,
        "difference to the recorded commands", report.commands.max_difference, "must be at most",
        thresholds.max_command_difference);
  check(report.violationCount() <= thresholds.max_violations, "number of commands out of bounds",
        static_cast<double>(report.violationCount()), "must be at most",
        static_cast<double>(thresholds.max_violations));
  check(report.tracked_samples > 0, "number of samples with a reference", 0.0, "must be at least", 1.0);
  check(report.commands.compared > 0, "number of commands that answer a recorded odometry", 0.0,
        "must be at least", 1.0);
  std::size_t failures = 0;
  for (const AxisValidation& axis : report.axes) failures += axis.qp_failures;
  check(failures == 0, "number of samples in the map without an online solution",
        static_cast<double>(failures), "must be at most", 0.0);
  return broken;
}

std::string toText(const ValidationReport& report) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << std::setprecision(4);
  out << report.source << "\n  " << report.samples << " samples over " << report.duration << " s, "
      << report.tracked_samples << " with a reference, top speed " << report.top_speed << " m/s\n  coverage "
      << 100.0 * report.coverage << " %: " << report.outside_map_samples << " samples outside a map\n";
  for (const AxisValidation& axis : report.axes) writeAxis(axis, out);
  writeCommands(report.commands, out);
  out << "\n  status:";
  for (std::size_t status = 0; status < 5; ++status) {
    out << (status == 0 ? " " : ", ") << kStatusNames[status] << " " << report.statuses.replayed[status];
  }
  if (report.statuses.compared > 0) {
    out << "; " << report.statuses.differing << " of " << report.statuses.compared
        << " differ from the record, parameters at most by " << report.statuses.max_theta_difference
        << "\n  control step in flight [ns]: median " << report.statuses.step_ns.p50 << ", p99 "
        << report.statuses.step_ns.p99 << ", max " << report.statuses.step_ns.max;
  }
  out << "\n  tracking: rms " << report.tracking.rms << " m, max " << report.tracking.max << " m\n";
  if (report.hold) {
    out << "  offset at rest: " << report.hold->offset.norm() << " m (" << report.hold->offset.transpose()
        << "), disturbance estimate " << report.hold->estimate.transpose() << " m/s^2";
    if (report.hold->disturbance) out << ", true one " << report.hold->disturbance->transpose();
    out << "\n";
  }
  return out.str();
}

std::string toJson(const ValidationReport& report) {
  Json out;
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
  return out.dump(2) + "\n";
}

}  // namespace polyfly
