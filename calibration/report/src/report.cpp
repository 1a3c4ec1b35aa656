#include "report/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/visible.hpp"
#include "polyfly_base/write_file.hpp"

namespace polyfly {
namespace {

// Numbers of at least this size, and those below the other, have an exponent.
constexpr double kGreatestPlain = 1e7;
constexpr double kLeastPlain = 1e-4;
constexpr const char* kDash = "–";

// No font, script or image comes from elsewhere.
constexpr const char* kStyle = R"css(
:root { --ink: #22272e; --soft: #5b6570; --line: #dfe3e8; --bad: #c04a00; --good: #00775a; }
* { box-sizing: border-box; }
body { margin: 0; background: #f3f5f7; color: var(--ink); font: 16px/1.5 system-ui, Helvetica, Arial, sans-serif; }
main { max-width: 1140px; margin: 0 auto; padding: 28px 20px 60px; }
h1 { margin: 0 0 4px; font-size: 30px; }
h2 { margin: 0 0 2px; font-size: 20px; }
p { margin: 0; }
.source { color: var(--soft); overflow-wrap: anywhere; }
.verdict { padding: 12px 16px; border-radius: 8px; color: #fff; font-weight: 600; margin: 18px 0; }
.verdict.good { background: var(--good); }
.verdict.bad { background: var(--bad); }
.verdict ul { margin: 4px 0 0; padding-left: 20px; font-weight: 400; }
.tiles { display: grid; grid-template-columns: repeat(auto-fill, minmax(165px, 1fr)); gap: 12px; margin-bottom: 20px; }
.tile, section { background: #fff; border: 1px solid var(--line); border-radius: 8px; padding: 12px 14px; }
.tile b { display: block; font-size: 25px; line-height: 1.25; white-space: nowrap; }
.tile span { color: var(--soft); font-size: 14px; line-height: 1.3; display: block; }
.tile.bad b, tr.bad td { color: var(--bad); }
section { padding: 18px 20px; margin-bottom: 18px; overflow-x: auto; }
section > p { color: var(--soft); margin-bottom: 10px; max-width: 92ch; }
section svg { display: block; width: 100%; height: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; font-size: 15px; }
th, td { text-align: left; vertical-align: top; padding: 5px 10px; border-bottom: 1px solid var(--line); }
th { font-weight: 600; color: var(--soft); }
)css";

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

const char* classOf(bool good) { return good ? "" : " class='bad'"; }

void writeTable(const ReportTable& table, std::ostream& out) {
  out << "<table><tr>";
  for (const std::string& name : table.columns) out << "<th>" << escaped(name) << "</th>";
  out << "</tr>\n";
  for (const ReportTable::Row& row : table.rows) {
    out << "<tr" << classOf(row.good) << ">";
    for (const std::string& cell : row.cells) out << "<td>" << escaped(cell) << "</td>";
    out << "</tr>\n";
  }
  out << "</table>";
}

void writeSection(const ReportSection& section, std::ostream& out) {
  out << "<section><h2>" << escaped(section.heading) << "</h2>";
  for (const std::string& sentence : section.sentences) out << "<p>" << escaped(sentence) << "</p>\n";
  for (const ReportLink& link : section.links)
    out << "<p><a href='" << escaped(link.address) << "'>" << escaped(link.text) << "</a></p>\n";
  if (section.table) writeTable(*section.table, out);
  if (section.figure) {
    // Without what only a file of its own needs in front of it.
    const std::string svg = renderFigure(*section.figure, ImageFormat::kSvg);
    const std::size_t begin = svg.find("<svg");
    if (begin == std::string::npos) throw Error("gnuplot: wrote no SVG");
    out << svg.substr(begin);
  }
  out << "</section>\n";
}

// Of an array or an object.
std::string listOf(const Json& value) {
  std::string text;
  for (const auto& [name, item] : value.items()) {
    if (!text.empty()) text += ", ";
    text += (value.is_object() ? name + " " : "") + wordsOn(item);
  }
  return text.empty() ? kDash : text;
}

bool isGood(const Json& value, ReportColumn::Rule rule) {
  switch (rule) {
    case ReportColumn::Rule::kNone:
      return true;
    case ReportColumn::Rule::kZero:
      return value == 0;
    case ReportColumn::Rule::kTrue:
      return value == true;
  }
  return true;
}

const Json& fieldOf(const Json& object, const std::string& field) {
  static const Json kNone;
  const Json::json_pointer pointer(field);
  return object.contains(pointer) ? object.at(pointer) : kNone;
}

void addCell(const Json& object, const ReportColumn& column, ReportTable::Row* row) {
  const Json& value = fieldOf(object, column.field);
  row->cells.push_back(wordsOn(value));
  row->good = row->good && isGood(value, column.rule);
}

// Characters that a terminal shows: bytes of UTF-8 that begin one.
std::size_t widthOf(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char one) { return (static_cast<unsigned char>(one) & 0xC0u) != 0x80u; }));
}

void writeAligned(const ReportTable& table, std::ostream& out) {
  std::vector<std::vector<std::string>> lines = {table.columns};
  for (const ReportTable::Row& row : table.rows) lines.push_back(row.cells);
  std::vector<std::size_t> widths(table.columns.size(), 0);
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], widthOf(line[i]));
  }
  for (const auto& line : lines) {
    std::string text = "   ";
    for (std::size_t i = 0; i < line.size(); ++i)
      text += " " + line[i] + std::string(i + 1 < line.size() ? widths[i] + 1 - widthOf(line[i]) : 0, ' ');
    out << text << "\n";
  }
}

}  // namespace

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return kDash;
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

std::string fileName(const std::string& path) { return std::filesystem::path(path).filename().string(); }

std::string percent(double share) {
  if (share >= 1.0) return "100 %";
  char text[32];
  std::snprintf(text, sizeof text, "%.2f %%", std::floor(share * 1e4) / 1e2);
  return text;
}

std::string wordsOn(const Json& value) {
  if (value.is_null()) return kDash;
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return number(value.get<double>());
  return value.is_structured() ? listOf(value) : value.dump();
}

ReportTable tableOf(const Json& rows, const std::vector<ReportColumn>& columns) {
  ReportTable table;
  for (const ReportColumn& column : columns) table.columns.push_back(column.name);
  for (const Json& row : rows) {
    ReportTable::Row line;
    for (const ReportColumn& column : columns) addCell(row, column, &line);
    table.rows.push_back(line);
  }
  return table;
}

ReportTable tableAcross(const Json& objects, const std::string& head,
                        const std::vector<ReportColumn>& lines) {
  ReportTable table;
  table.columns = {""};
  for (const Json& object : objects) table.columns.push_back(wordsOn(fieldOf(object, head)));
  for (const ReportColumn& line : lines) {
    ReportTable::Row row = {{line.name}};
    for (const Json& object : objects) addCell(object, line, &row);
    table.rows.push_back(row);
  }
  return table;
}

std::string toHtml(const Report& report) {
  std::ostringstream out;
  out << "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'>"
         "<meta name='viewport' content='width=device-width, initial-scale=1'><title>"
      << escaped(report.title) << "</title><style>" << kStyle << "</style></head><body><main>\n<h1>"
      << escaped(report.title) << "</h1>\n";
  for (const std::string& source : report.sources) out << "<p class='source'>" << escaped(source) << "</p>\n";
  out << "<div class='verdict " << (report.good ? "good" : "bad") << "'>" << escaped(report.verdict)
      << "<ul>";
  for (const std::string& reason : report.reasons) out << "<li>" << escaped(reason) << "</li>";
  out << "</ul></div>\n<div class='tiles'>\n";
  for (const ReportTile& tile : report.tiles) {
    out << "<div class='tile" << (tile.good ? "" : " bad") << "'><b>" << escaped(tile.value) << "</b><span>"
        << escaped(tile.label) << "</span></div>\n";
  }
  out << "</div>\n";
  for (const ReportSection& section : report.sections) writeSection(section, out);
  out << "</main></body></html>\n";
  return out.str();
}

std::string toText(const Report& report) {
  std::ostringstream out;
  for (const std::string& source : report.sources) out << source << "\n";
  for (const ReportTile& tile : report.tiles) out << "  " << tile.value << "  " << tile.label << "\n";
  for (const ReportSection& section : report.sections) {
    if (section.figure) continue;
    out << "\n  " << section.heading << "\n";
    for (const std::string& sentence : section.sentences) out << "    " << sentence << "\n";
    if (section.table) writeAligned(*section.table, out);
  }
  out << "\n  " << report.verdict << "\n";
  for (const std::string& reason : report.reasons) out << "  - " << reason << "\n";
  return out.str();
}

std::string dumped(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void writePage(const std::string& folder, const Report& report, const std::string& data_name,
               const std::string& data) {
  const std::string html = toHtml(report);
  makeFolder(folder);
  const std::filesystem::path base(folder);
  writeFileAtomically(base / "index.html", html);
  writeFileAtomically(base / data_name, data);
}

}  // namespace polyfly
