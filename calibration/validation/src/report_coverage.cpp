#include <algorithm>
#include <filesystem>
#include <ostream>

#include "report_page.hpp"
#include "report_parts.hpp"
#include "validation_names.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kShownExcursions = 20;

std::string fileName(const std::string& path) { return std::filesystem::path(path).filename().string(); }

std::string causeOf(const Excursion& excursion) {
  if (!excursion.parameter.empty()) {
    return excursion.parameter + ", up to " + number(excursion.beyond) + " " + excursion.unit +
           " beyond its range";
  }
  return excursion.cause == LookupStatus::kNotFinite ? "not finite"
                                                     : "in range, but in no region: no solution";
}

std::string range(const double (&ends)[2]) { return "[" + number(ends[0]) + ", " + number(ends[1]) + "]"; }

void writeProposal(const MapProposal& proposal, std::ostream& out) {
  out << "<h3>" << escaped(proposal.axis) << " (" << escaped(fileName(proposal.map_path)) << ")</h3><ul>";
  for (const MapProposal::Change& change : proposal.changes) {
    out << "<li>" << escaped(change.parameter) << ": range " << range(change.from) << " to "
        << range(change.to) << " " << escaped(change.unit) << "</li>";
  }
  if (proposal.infeasible > 0) {
    out << "<li>" << proposal.infeasible
        << " samples lay in range, but had no solution: no range covers them</li>";
  }
  if (!proposal.obstacle.empty()) out << "<li>" << escaped(proposal.obstacle) << "</li>";
  if (proposal.regions_then > 0) {
    out << "<li>" << (proposal.counted_all ? "" : "at least ") << proposal.regions_then
        << " regions, counted by solving" << (proposal.counted_all ? "" : " until the limit")
        << "; the map has " << proposal.regions << "</li>";
  }
  out << "</ul>\n";
}

}  // namespace

std::string answersText(const std::array<std::size_t, kControlStatusCount>& statuses) {
  std::string text;
  for (std::size_t status = 0; status < statuses.size(); ++status) {
    if (statuses[status] == 0) continue;
    text += (text.empty() ? "" : ", ") + std::string(kStatusNames[status]) + " " +
            std::to_string(statuses[status]);
  }
  return text;
}

void writeExcursions(const ValidationReport& report, std::ostream& out) {
  std::size_t count = 0;
  for (const AxisValidation& axis : report.axes) count += axis.excursions.size();
  if (count == 0) return;
  out << "<section><h2>Where the flight left the map</h2><p>Stretches outside a map, the longest first, and "
         "what "
         "the controller did.</p><div class='scroll'><table><tr><th>axis</th><th>from [s]</th><th>for "
         "[s]</th>"
         "<th>samples</th><th>why</th><th>answers</th></tr>\n";
  std::vector<std::pair<const AxisValidation*, const Excursion*>> all;
  for (const AxisValidation& axis : report.axes) {
    for (const Excursion& excursion : axis.excursions) all.emplace_back(&axis, &excursion);
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& one, const auto& other) {
    return one.second->samples > other.second->samples;
  });
  for (std::size_t index = 0; index < std::min(all.size(), kShownExcursions); ++index) {
    const auto& [axis, excursion] = all[index];
    out << "<tr><td>" << escaped(axis->axis) << "</td><td>" << number(excursion->from, 9) << "</td><td>"
        << number(excursion->to - excursion->from) << "</td><td>" << excursion->samples << "</td><td>"
        << escaped(causeOf(*excursion)) << "</td><td>" << escaped(answersText(excursion->statuses))
        << "</td></tr>\n";
  }
  out << "</table></div>";
  if (count > kShownExcursions) out << "<p>And " << count - kShownExcursions << " shorter ones.</p>";
  out << "</section>\n";
}

void writeProposals(const ValidationReport& report, std::ostream& out) {
  if (report.proposals.empty()) return;
  out << "<section><h2>What would have covered it</h2><p>Ranges that hold all that the flight met, with a "
         "tenth "
         "beyond where an end was passed.</p>\n";
  for (const MapProposal& proposal : report.proposals) writeProposal(proposal, out);
  out << "</section>\n";
}

void writeComparisons(const ValidationReport& report, std::ostream& out) {
  if (report.comparisons.empty()) return;
  out << "<section><h2>Other maps on this flight</h2><p>Looked up at the same parameters as the map that "
         "flew; the "
         "flight that they would have flown is another.</p><div "
         "class='scroll'><table><tr><th>map</th><th>axis</th>"
         "<th>samples inside</th><th>inside only the flown one</th><th>only the other</th><th>regions "
         "visited</th>"
         "<th>greatest difference</th><th>rms</th><th>to its online QP</th><th>median look-up</th></tr>\n";
  for (const MapComparison& other : report.comparisons) {
    out << "<tr><td>" << escaped(fileName(other.path)) << "</td><td>" << escaped(other.axis) << "</td><td>"
        << other.use.inside << " of " << other.use.samples << "</td><td>" << other.only_flown << "</td><td>"
        << other.only_other << "</td><td>" << other.use.visited() << " of " << other.use.regions()
        << "</td><td>" << number(other.difference.max) << " " << escaped(other.input_unit) << "</td><td>"
        << number(other.difference.rms) << "</td><td>" << number(other.qp.max, 2) << "</td><td>"
        << number(other.lookup_ns.p50) << " ns</td></tr>\n";
  }
  out << "</table></div></section>\n";
}

}  // namespace polyfly
