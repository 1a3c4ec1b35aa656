#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>

#include "validation/validation.hpp"
#include "validation_names.hpp"

namespace polyfly {
namespace {

// The longest excursions from the map, with the answers of the controller.
void writeExcursions(const std::vector<Excursion>& excursions, std::ostream& out) {
  constexpr std::size_t kShown = 5;
  std::vector<const Excursion*> longest;
  for (const Excursion& excursion : excursions) longest.push_back(&excursion);
  std::stable_sort(longest.begin(), longest.end(), [](const Excursion* one, const Excursion* other) {
    return one->samples > other->samples;
  });
  for (std::size_t index = 0; index < std::min(kShown, longest.size()); ++index) {
    const Excursion& excursion = *longest[index];
    out << "    left the map from " << std::setprecision(12) << excursion.from << " to " << excursion.to
        << std::setprecision(4) << " s (" << excursion.samples << " samples): ";
    if (!excursion.parameter.empty()) {
      out << excursion.parameter << " up to " << excursion.beyond << " " << excursion.unit
          << " beyond its range";
    } else {
      out << (excursion.cause == LookupStatus::kNotFinite ? "not finite" : "in range, but in no region");
    }
    out << "; the controller answered";
    for (std::size_t status = 0; status < excursion.statuses.size(); ++status) {
      if (excursion.statuses[status] > 0)
        out << " " << kStatusNames[status] << " " << excursion.statuses[status];
    }
    out << "\n";
  }
  if (longest.size() > kShown) out << "    and " << longest.size() - kShown << " shorter stretches\n";
}

void writeDistances(const AxisValidation& axis, std::ostream& out) {
  if (axis.inside == 0) return;
  const double held = static_cast<double>(axis.inside);
  out << "    distance (ranges scaled to -1 .. 1) to the nearest face of the region: least "
      << axis.face.least << ", mean " << axis.face.sum / held << "; to the map's edge: least "
      << axis.edge.least << ", mean " << axis.edge.sum / held;
  if (axis.edge_parameter >= 0) {
    out << ", along " << axis.parameters[static_cast<std::size_t>(axis.edge_parameter)].name << " at "
        << std::setprecision(12) << axis.edge.stamp << std::setprecision(4) << " s";
  }
  out << "\n";
}

void writeAxis(const AxisValidation& axis, std::ostream& out) {
  out << "\n  " << axis.axis << ": " << axis.inside << " of " << axis.samples << " samples inside, "
      << axis.visited() << " of " << axis.regions() << " regions visited\n";
  if (axis.inside != axis.samples) {
    out << "    outside: box " << axis.outside_box << ", partition " << axis.outside_partition
        << ", not finite " << axis.not_finite << "\n";
    for (const ParameterUse& use : axis.parameters) {
      if (use.outside == 0) continue;
      out << "    " << use.name << " out of " << use.lower << " .. " << use.upper << " " << use.unit << " in "
          << use.outside << " samples (went from " << use.least << " to " << use.greatest << "); range: ["
          << use.proposedRange().first << ", " << use.proposedRange().second << "] would have held it\n";
    }
    writeExcursions(axis.excursions, out);
  }
  writeDistances(axis, out);
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

void writeComparison(const MapComparison& other, std::ostream& out) {
  out << "\n  " << other.axis << " with " << other.path << ": " << other.use.inside << " of "
      << other.use.samples << " samples inside (" << other.only_flown << " only the map that flew holds, "
      << other.only_other << " only this one), " << other.use.visited() << " of " << other.use.regions()
      << " regions visited\n    its answer differs at most by " << other.difference.max << " "
      << other.input_unit << ", rms " << other.difference.rms << "; from its own online QP at most by "
      << other.qp.max << "\n";
}

void printProposal(const MapProposal& proposal, std::ostream& out) {
  out << "\n  ranges that would have covered the flight, " << proposal.axis << " axis:\n";
  for (const MapProposal::Change& change : proposal.changes) {
    out << "    " << change.parameter << ": range [" << change.from[0] << ", " << change.from[1] << "] to ["
        << change.to[0] << ", " << change.to[1] << "] " << change.unit << "\n";
  }
  if (proposal.infeasible > 0) {
    out << "    " << proposal.infeasible
        << " samples lay in range, but had no solution: no range covers them\n";
  }
  if (!proposal.obstacle.empty()) out << "    " << proposal.obstacle << "\n";
  if (proposal.regions_then > 0) {
    out << "    " << (proposal.counted_all ? "" : "at least ") << proposal.regions_then
        << " regions, counted by solving; the map has " << proposal.regions << "\n";
  }
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

void writeParametersText(const ParametersTold& parameters, std::ostream& out) {
  out << "  in force: law " << parameters.law << ", told by " << parameters.node << "\n  calibrated options: "
      << (parameters.provenance.empty() ? "no provenance is stated" : parameters.provenance) << "\n";
  for (const ParametersTold::Change& change : parameters.changes) {
    out << "  changed at " << change.time << " s (" << change.cause << "):";
    for (const std::string& one : change.parameters) out << " " << one << ";";
    out << "\n";
  }
}

}  // namespace

const char* nameOf(Verdict verdict) { return kVerdictNames[static_cast<std::size_t>(verdict)]; }

const char* sentenceOn(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPassed:
      return "Passed: the maps held the flight, and the record agrees with them. Nothing is said of regions "
             "that were "
             "not visited.";
    case Verdict::kDoubtful:
      return "Doubtful: the maps held what was read of the flight, but the record may not say what it seems "
             "to say.";
    case Verdict::kFailed:
      return "Failed: the flight breaks a rule.";
  }
  return "";
}

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
  const bool nothing_known = report.tracked_samples == 0 && !report.incomparable.empty();
  check(nothing_known || report.coverage >= thresholds.min_coverage, "coverage", report.coverage,
        "must be at least", thresholds.min_coverage);
  check(report.maxQpDifference() <= thresholds.max_qp_difference, "difference to the online QP",
        report.maxQpDifference(), "must be at most", thresholds.max_qp_difference);
  check(report.commands.max_difference <= thresholds.max_command_difference,
        "difference to the recorded commands", report.commands.max_difference, "must be at most",
        thresholds.max_command_difference);
  check(report.violationCount() <= thresholds.max_violations, "number of commands out of bounds",
        static_cast<double>(report.violationCount()), "must be at most",
        static_cast<double>(thresholds.max_violations));
  const bool is_known = report.incomparable.empty();
  check(report.tracked_samples > 0 || !is_known, "number of samples with a reference", 0.0,
        "must be at least", 1.0);
  check(report.commands.compared > 0 || !is_known, "number of commands that answer a recorded odometry", 0.0,
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
      << 100.0 * report.coverage << " %: " << report.outside_map_samples << " samples outside a map, for "
      << report.outside_map_time << " s\n";
  if (report.share) out << "  read: " << describe(*report.share) << "\n";
  if (report.parameters) writeParametersText(*report.parameters, out);
  for (const AxisValidation& axis : report.axes) writeAxis(axis, out);
  writeCommands(report.commands, out);
  out << "\n  status:";
  for (std::size_t status = 0; status < kControlStatusCount; ++status) {
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
  for (const MapComparison& other : report.comparisons) writeComparison(other, out);
  for (const MapProposal& proposal : report.proposals) printProposal(proposal, out);
  out << "\n  " << sentenceOn(report.verdict()) << "\n";
  for (const std::string& sentence : report.broken) out << "  broken: " << sentence << "\n";
  for (const std::string& sentence : report.warnings) out << "  warning: " << sentence << "\n";
  return out.str();
}

}  // namespace polyfly
