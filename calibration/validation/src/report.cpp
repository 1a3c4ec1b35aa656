#include "validation/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "report_page.hpp"
#include "report_parts.hpp"

namespace polyfly {
namespace {

std::string percent(double share) {
  if (share >= 1.0) return "100 %";
  // Never rounded up to 100.
  char text[32];
  std::snprintf(text, sizeof text, "%.2f %%", std::floor(share * 1e4) / 1e2);
  return text;
}

void writeTile(const std::string& value, const std::string& label, bool good, std::ostream& out) {
  out << "<div class='tile" << (good ? "" : " bad") << "'><b>" << escaped(value) << "</b><span>"
      << escaped(label) << "</span></div>\n";
}

void writeList(const std::vector<std::string>& sentences, std::ostream& out) {
  if (sentences.empty()) return;
  out << "<ul>";
  for (const std::string& sentence : sentences) out << "<li>" << escaped(sentence) << "</li>";
  out << "</ul>";
}

void writeVerdict(const ValidationReport& report, std::ostream& out) {
  const Verdict verdict = report.verdict();
  out << "<div class='verdict " << (verdict == Verdict::kPassed ? "good" : "bad") << "'>"
      << sentenceOn(verdict);
  writeList(report.broken, out);
  if (!report.broken.empty() && !report.warnings.empty())
    out << "The record may not say what it seems to say:";
  writeList(report.warnings, out);
  out << "</div>\n";
}

void writeTiles(const ValidationReport& report, std::ostream& out) {
  out << "<div class='tiles'>\n";
  writeTile(number(100.0 * report.tracking.rms) + " cm", "tracking error, root mean square", true, out);
  writeTile(number(100.0 * report.tracking.max) + " cm", "tracking error, greatest", true, out);
  writeTile(number(report.top_speed) + " m/s", "top speed", true, out);
  if (report.hold) {
    writeTile(number(1000.0 * report.hold->offset.norm()) + " mm", "offset at rest at the end", true, out);
  }
  writeTile(std::to_string(report.violationCount()),
            "commands out of bounds, of " + std::to_string(report.commands.recorded),
            report.violationCount() == 0, out);
  writeTile(percent(report.coverage),
            "of " + std::to_string(report.tracked_samples) + " samples inside the maps; outside for " +
                number(report.outside_map_time) + " s",
            report.outside_map_samples == 0, out);
  writeTile(std::to_string(report.visitedCount()) + " of " + std::to_string(report.regionCount()),
            "regions visited", true, out);
  writeTile(number(report.maxQpDifference(), 2), "greatest difference to the online QP", true, out);
  const bool exact = report.commands.max_difference == 0.0 && report.commands.compared > 0;
  writeTile(
      exact ? "exact" : number(report.commands.max_difference, 2),
      exact ? "replay: the recorded commands, bit for bit" : "greatest difference to the recorded commands",
      true, out);
  writeTile(number(report.lookup_ns.p50) + " ns",
            "median look-up; 99 % below " + number(report.lookup_ns.p99) + " ns", true, out);
  if (report.statuses.compared > 0) {
    writeTile(number(report.statuses.step_ns.p50 / 1000.0, 2) + " µs",
              "median control step in flight; 99 % below " + number(report.statuses.step_ns.p99 / 1000.0, 2) +
                  " µs",
              true, out);
  }
  out << "</div>\n";
}

void writeRow(const std::string& name, const std::array<std::string, 3>& cells, bool bad, std::ostream& out) {
  out << "<tr" << (bad ? " class='bad'" : "") << "><td>" << escaped(name) << "</td>";
  for (const std::string& cell : cells) out << "<td>" << escaped(cell) << "</td>";
  out << "</tr>\n";
}

template <class Cell>
void writeAxisRow(const ValidationReport& report, const std::string& name, Cell cell, bool bad,
                  std::ostream& out) {
  writeRow(name, {cell(report.axes[0]), cell(report.axes[1]), cell(report.axes[2])}, bad, out);
}

// A row of counts that ought to be zero.
void writeFaultRow(const ValidationReport& report, const std::string& name,
                   std::size_t AxisValidation::*count, std::ostream& out) {
  const bool bad = std::any_of(report.axes.begin(), report.axes.end(),
                               [count](const AxisValidation& axis) { return axis.*count > 0; });
  writeAxisRow(
      report, name, [count](const AxisValidation& axis) { return std::to_string(axis.*count); }, bad, out);
}

void writeAxes(const ValidationReport& report, std::ostream& out) {
  out << "<section><h2>The three axes in numbers</h2><p>Each axis has its own region map.</p><div "
         "class='scroll'><table>"
         "<tr><th></th>";
  for (const AxisValidation& axis : report.axes) out << "<th>" << escaped(axis.axis) << "</th>";
  out << "</tr>\n";
  using Axis = AxisValidation;
  writeAxisRow(
      report, "regions in the map", [](const Axis& axis) { return std::to_string(axis.regions()); }, false,
      out);
  writeAxisRow(
      report, "regions visited", [](const Axis& axis) { return std::to_string(axis.visited()); }, false, out);
  writeAxisRow(
      report, "samples inside the map",
      [](const Axis& axis) { return std::to_string(axis.inside) + " of " + std::to_string(axis.samples); },
      false, out);
  writeFaultRow(report, "outside: a parameter out of its range", &Axis::outside_box, out);
  writeFaultRow(report, "outside: in range, but in no region", &Axis::outside_partition, out);
  writeFaultRow(report, "not finite", &Axis::not_finite, out);
  writeAxisRow(
      report, "greatest difference to the online QP",
      [](const Axis& axis) { return number(axis.qp.max, 2) + " " + axis.input_unit; }, false, out);
  writeFaultRow(report, "samples that the online QP could not solve", &Axis::qp_failures, out);
  writeAxisRow(
      report, "position error, rms", [](const Axis& axis) { return number(axis.tracking.rms) + " m"; }, false,
      out);
  writeAxisRow(
      report, "position error, greatest", [](const Axis& axis) { return number(axis.tracking.max) + " m"; },
      false, out);
  writeAxisRow(
      report, "look-up, median", [](const Axis& axis) { return number(axis.lookup_ns.p50) + " ns"; }, false,
      out);
  writeAxisRow(
      report, "look-up, 99 % below", [](const Axis& axis) { return number(axis.lookup_ns.p99) + " ns"; },
      false, out);
  writeAxisRow(
      report, "look-up, 99.9 % below", [](const Axis& axis) { return number(axis.lookup_ns.p999) + " ns"; },
      false, out);
  writeAxisRow(
      report, "shuffled look-up, median",
      [](const Axis& axis) { return number(axis.lookup_shuffled_ns.p50) + " ns"; }, false, out);
  if (report.hold) {
    const Eigen::Vector3d& offset = report.hold->offset;
    writeRow("offset at rest",
             {number(offset.x()) + " m", number(offset.y()) + " m", number(offset.z()) + " m"}, false, out);
  }
  out << "</table></div></section>\n";
}

void writeUse(const ParameterUse& use, std::ostream& out) {
  const auto place = [&use](double value) {
    return 100.0 * std::clamp((value - use.lower) / (use.upper - use.lower), 0.0, 1.0);
  };
  const bool met = use.least <= use.greatest;
  const char* bad = use.outside > 0 ? " class='bad'" : "";
  out << "<span class='name'>" << escaped(use.name) << "</span><span class='left'>" << number(use.lower)
      << "</span><div class='track'>";
  if (met) {
    out << "<i" << bad << " style='left:" << number(place(use.least), 5)
        << "%;width:" << number(place(use.greatest) - place(use.least), 5) << "%'></i>";
  }
  out << "</div><span class='right'>" << number(use.upper) << " " << escaped(use.unit) << "</span><span"
      << bad << ">" << (use.outside > 0 ? std::to_string(use.outside) + " outside" : "all inside")
      << "</span>\n";
}

void writeCoverage(const ValidationReport& report, std::ostream& out) {
  out << "<section><h2>Coverage</h2><p>What the flight used (blue) of each parameter's range in the maps "
         "(grey, from the "
         "number on the left to that on the right).</p><div class='use'>\n";
  for (const AxisValidation& axis : report.axes) {
    const double share =
        axis.samples > 0 ? static_cast<double>(axis.inside) / static_cast<double>(axis.samples) : 0.0;
    out << "<h3>" << escaped(axis.axis) << ": " << percent(share) << " of the samples inside</h3>\n";
    for (const ParameterUse& use : axis.parameters) writeUse(use, out);
  }
  out << "</div></section>\n";
}

void writeRecord(const ValidationReport& report, std::ostream& out) {
  const CommandValidation& commands = report.commands;
  constexpr const char* kNames[4] = {"roll", "pitch", "yaw rate", "thrust"};
  constexpr const char* kUnits[4] = {"rad", "rad", "rad/s", "N"};
  out << "<section><h2>Replay against the record</h2><p>The recorded odometry, run through the same "
         "controller again: "
      << commands.compared << " of " << commands.recorded << " recorded commands compared";
  if (commands.unanswered > 0) out << ", " << commands.unanswered << " odometry messages without a command";
  if (report.statuses.compared > 0) {
    out << "; status and regions differ in " << report.statuses.differing << " of "
        << report.statuses.compared << " samples; one control step took "
        << number(report.statuses.step_ns.p50 / 1000.0) << " µs in flight (median; 99 % below "
        << number(report.statuses.step_ns.p99 / 1000.0) << " µs)";
  }
  out << ". Its answers: " << answersText(report.statuses.replayed)
      << ".</p><div class='scroll'><table><tr><th></th><th>greatest difference</th><th>rms</th></tr>\n";
  for (std::size_t entry = 0; entry < 4; ++entry) {
    const Difference& difference = commands.difference[entry];
    out << "<tr><td>" << kNames[entry] << "</td><td>" << number(difference.max, 2) << " " << kUnits[entry]
        << "</td><td>" << number(difference.rms, 2) << " " << kUnits[entry] << "</td></tr>\n";
  }
  out << "</table></div></section>\n";
}

void writeHead(const ValidationReport& report, std::ostream& out) {
  out << "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'>"
         "<meta name='viewport' content='width=device-width, initial-scale=1'><title>Flight "
         "report</title><style>"
      << kReportStyle << "</style></head><body><main>\n<h1>Flight report</h1>\n<p class='source'>"
      << escaped(std::filesystem::path(report.source).filename().string()) << " · " << number(report.duration)
      << " s · " << report.samples << " samples";
  if (report.share) out << "<br>Read: " << escaped(describe(*report.share));
  out << "</p>\n";
}

void writeFlights(const std::vector<ValidationReport>& flights, std::ostream& out) {
  out << "<section><h2>The flights</h2><div "
         "class='scroll'><table><tr><th>flight</th><th>samples</th><th>inside the "
         "maps</th><th>tracking error, rms</th><th>regions visited</th><th>verdict</th></tr>\n";
  for (std::size_t index = 0; index < flights.size(); ++index) {
    const ValidationReport& report = flights[index];
    const bool good = report.verdict() == Verdict::kPassed;
    out << "<tr" << (good ? "" : " class='bad'") << "><td><a href='flight_" << index + 1 << "/index.html'>"
        << escaped(std::filesystem::path(report.source).filename().string()) << "</a></td><td>"
        << report.samples << "</td><td>" << percent(report.coverage) << "</td><td>"
        << number(100.0 * report.tracking.rms) << " cm</td><td>" << report.visitedCount() << " of "
        << report.regionCount() << "</td><td>" << nameOf(report.verdict()) << "</td></tr>\n";
  }
  out << "</table></div></section>\n";
}

void writeMapPages(const std::vector<ReportLink>& links, std::ostream& out) {
  if (links.empty()) return;
  out << "<section><h2>Explore the maps</h2><p>A page for each map, with slices, this flight's samples and "
         "simulated flights:";
  const char* separator = " ";
  for (const ReportLink& link : links) {
    out << separator << "<a href='" << escaped(link.address) << "'>" << escaped(link.text) << "</a>";
    separator = ", ";
  }
  out << ".</p></section>\n";
}

// What follows the pictures.
void writeNumbers(const ValidationReport& report, std::ostream& out) {
  writeCoverage(report, out);
  writeExcursions(report, out);
  writeProposals(report, out);
  writeComparisons(report, out);
  writeAxes(report, out);
  writeRecord(report, out);
  out << kPageEnd;
}

}  // namespace

std::string toHtml(const ReportContent& content) {
  std::ostringstream out;
  writeHead(content.validation, out);
  writeVerdict(content.validation, out);
  writeTiles(content.validation, out);
  writeMapPages(content.map_pages, out);
  const std::vector<ReportFigure> figures = reportFigures(content);
  for (const ReportFigure& figure : figures) {
    writeFigureSection(figure, out);
  }
  writeParameters(content.validation, out);
  writeNumbers(content.validation, out);
  return out.str();
}

void writeReport(const ReportContent& content, const std::string& folder) {
  writePage(folder, toHtml(content), "summary.json", toJson(content.validation));
}

void writeOverview(const std::vector<ValidationReport>& flights, const ValidationReport& all,
                   const std::string& folder) {
  std::ostringstream out;
  writeHead(all, out);
  writeVerdict(all, out);
  writeTiles(all, out);
  writeFlights(flights, out);
  writeNumbers(all, out);
  writePage(folder, out.str(), "summary.json", toJson(all, flights));
}

}  // namespace polyfly
