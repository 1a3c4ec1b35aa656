#include "report_page.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <ostream>

#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/visible.hpp"
#include "polyfly_base/write_file.hpp"
#include "report_parts.hpp"

namespace polyfly {
namespace {

// Numbers of at least this size, and those below the other, have an exponent.
constexpr double kGreatestPlain = 1e7;
constexpr double kLeastPlain = 1e-4;

}  // namespace

const char* const kReportStyle = R"css(
:root { --ink: #22272e; --soft: #5b6570; --line: #dfe3e8; --blue: #0072b2; --bad: #c04a00; --good: #00775a; }
* { box-sizing: border-box; }
body { margin: 0; background: #f3f5f7; color: var(--ink); font: 16px/1.5 system-ui, "Segoe UI", Helvetica, Arial, sans-serif; }
main { max-width: 1140px; margin: 0 auto; padding: 28px 20px 60px; }
h1 { margin: 0 0 4px; font-size: 30px; }
h2 { margin: 0 0 2px; font-size: 20px; }
p { margin: 0; }
.source { color: var(--soft); margin-bottom: 18px; overflow-wrap: anywhere; }
.verdict { padding: 12px 16px; border-radius: 8px; color: #fff; font-weight: 600; margin-bottom: 18px; }
.verdict.good { background: var(--good); }
.verdict.bad { background: var(--bad); }
.verdict ul { margin: 4px 0 0; padding-left: 20px; font-weight: 400; }
.tiles { display: grid; grid-template-columns: repeat(auto-fill, minmax(165px, 1fr)); gap: 12px; margin-bottom: 20px; }
.tile { background: #fff; border: 1px solid var(--line); border-radius: 8px; padding: 12px 14px; }
.tile b { display: block; font-size: 25px; font-weight: 650; line-height: 1.25; white-space: nowrap; }
.tile span { color: var(--soft); font-size: 14px; line-height: 1.3; display: block; }
.tile.bad b { color: var(--bad); }
section { background: #fff; border: 1px solid var(--line); border-radius: 8px; padding: 18px 20px; margin-bottom: 18px; }
section > p { color: var(--soft); margin-bottom: 10px; max-width: 92ch; }
section svg { display: block; width: 100%; height: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; font-size: 15px; }
th, td { text-align: right; padding: 5px 10px; border-bottom: 1px solid var(--line); }
th { font-weight: 600; color: var(--soft); }
th:first-child, td:first-child { text-align: left; padding-left: 0; }
.numbers td:not(:first-child) { white-space: nowrap; }
.numbers td:first-child { overflow-wrap: anywhere; }
tr.bad td { color: var(--bad); font-weight: 600; }
.use { display: grid; grid-template-columns: 150px 90px 1fr 90px 130px; gap: 4px 12px; align-items: center; font-size: 14px;
       font-variant-numeric: tabular-nums; }
.use .name { font-weight: 600; }
.use .left { text-align: right; color: var(--soft); }
.use .right { color: var(--soft); }
.use .bad { color: var(--bad); font-weight: 600; }
.use h3 { grid-column: 1 / -1; margin: 10px 0 2px; font-size: 15px; }
.track { position: relative; height: 14px; background: #e8edf2; border-radius: 3px; overflow: hidden; }
.track i { position: absolute; top: 0; bottom: 0; background: var(--blue); min-width: 2px; }
.track i.bad { background: #d55e00; }
.scroll { overflow-x: auto; }
.facts td, .facts th { text-align: left; vertical-align: top; overflow-wrap: anywhere; }
.facts td:first-child { white-space: nowrap; }
section > p + table, table + p { margin-top: 10px; }
.mark { display: inline-block; padding: 1px 9px; border-radius: 9px; font-size: 13px; font-weight: 600; vertical-align: 2px; }
.mark.good { background: #e0f2ec; color: var(--good); }
.mark.bad { background: #fbe6da; color: var(--bad); }
h3 { margin: 14px 0 2px; font-size: 16px; }
)css";

void writeCalibrationHead(const std::vector<Provenance>& flights, const std::vector<std::string>& sentences,
                          std::ostream& out) {
  out << "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'>"
         "<meta name='viewport' content='width=device-width, initial-scale=1'><title>Calibration "
         "report</title><style>"
      << kReportStyle << "</style></head><body><main>\n<h1>Calibration report</h1>\n<p class='source'>";
  for (const Provenance& flight : flights) {
    if (&flight != &flights.front()) out << "<br>";
    out << escaped(flight.file) << " · " << escaped(flight.checksum);
    if (!flight.recorded.empty()) out << " · " << escaped(flight.recorded);
  }
  out << "</p>\n";
  if (sentences.empty()) {
    out << "<div class='verdict good'>The data support these numbers</div>\n";
    return;
  }
  out << "<div class='verdict bad'>To be looked at before these numbers are used<ul>";
  for (const std::string& sentence : sentences) out << "<li>" << escaped(sentence) << "</li>";
  out << "</ul></div>\n";
}

void writeFigureSection(const ReportFigure& figure, std::ostream& out) {
  out << "<section><h2>" << escaped(figure.heading) << "</h2><p>" << escaped(figure.caption) << "</p>\n"
      << inlineSvg(figure.figure) << "</section>\n";
}

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  char text[48];
  const double size = std::abs(value);
  if (size >= kGreatestPlain || size < kLeastPlain) {
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    return text;
  }
  const int decimals = std::max(0, digits - 1 - static_cast<int>(std::floor(std::log10(size))));
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  std::string result = text;
  if (decimals > 0) result.erase(result.find_last_not_of('0') + 1);
  if (result.back() == '.') result.pop_back();
  return result;
}

namespace {

// The search has ended at the least delay: the data show none.
bool isLeastDelay(const FittedParameter& parameter) {
  return parameter.name == "delay" && std::isnan(parameter.half_width);
}

}  // namespace

bool isBounded(const FittedParameter& parameter) {
  if (isLeastDelay(parameter)) return true;
  // Half width from which on the data say nothing, for any quantity here.
  constexpr double kNoInterval = 1e4;
  return std::abs(parameter.half_width) < kNoInterval;
}

std::string intervalText(const FittedParameter& parameter) {
  if (isLeastDelay(parameter)) return "at its least: none is seen";
  if (!isBounded(parameter)) return "not bounded by the data";
  return number(parameter.least(), 4) + " .. " + number(parameter.greatest(), 4);
}

std::string valueWithin(const FittedParameter& parameter) {
  if (isLeastDelay(parameter) || !isBounded(parameter)) return number(parameter.value);
  return number(parameter.value) + " ± " + number(parameter.half_width, 2);
}

void writeFlights(const std::vector<FlightNumbers>& flights, std::ostream& out) {
  if (flights.empty()) return;
  out << "<h3>What each flight says</h3><p>The numbers above are the means of " << flights.size()
      << " flights.</p><div class='scroll'><table class='numbers'><tr><th>flight</th>";
  for (const FittedParameter& parameter : flights.front().parameters)
    out << "<th>" << escaped(withUnit(parameter.name, parameter.unit)) << "</th>";
  out << "</tr>\n";
  for (const FlightNumbers& flight : flights) {
    out << "<tr><td>" << escaped(flight.file) << "</td>";
    for (const FittedParameter& parameter : flight.parameters)
      out << "<td>" << valueWithin(parameter) << "</td>";
    out << "</tr>\n";
  }
  out << "</table></div>\n";
}

std::string supportMark(bool supported) {
  return supported ? " <span class='mark good'>supported</span>"
                   : " <span class='mark bad'>not supported</span>";
}

// Names of files and topics come from outside: a page is UTF-8 whatever they are.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char character : visibleLines(text)) {
    switch (character) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += character;
    }
  }
  return result;
}

// Without what only a file of its own needs in front of it.
std::string inlineSvg(const Figure& figure) {
  const std::string svg = renderFigure(figure, ImageFormat::kSvg);
  const std::size_t begin = svg.find("<svg");
  if (begin == std::string::npos) throw Error("gnuplot: wrote no SVG");
  return svg.substr(begin);
}

void writePage(const std::string& folder, const std::string& html, const std::string& data_name,
               const std::string& data) {
  makeFolder(folder);
  const std::filesystem::path base(folder);
  writeFileAtomically(base / "index.html", html);
  writeFileAtomically(base / data_name, data);
}

}  // namespace polyfly
