#include "cited_ranges.hpp"

#include <filesystem>
#include <vector>

#include "mpc_core/calibration_document.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"
#include "polyfly_base/yaml_field.hpp"

namespace polyfly {
namespace {

/// What a file says of one disturbance.
struct Cited {
  /// The range as the file has it.
  std::string range;
  /// Origin of the range, without a line break.
  std::string remark;
};

std::string oneLine(std::string text) {
  for (char& letter : text) {
    if (letter == '\n' || letter == '\r') letter = ' ';
  }
  return text;
}

std::string origin(const YamlField& file, const std::string& path, const std::string& name) {
  std::string remark = name + " of " + path;
  if (file.has("data")) {
    const YamlField data = file.at("data");
    for (const YamlField& flight : data.isList() ? data.items() : std::vector<YamlField>{data}) {
      if (flight.has("file")) remark += ", from " + flight.at("file").text();
      if (flight.has("checksum")) remark += " " + flight.at("checksum").text();
    }
  }
  for (const char* key : {"share", "confidence"}) {
    if (file.has(key)) remark += std::string(", ") + key + " " + file.at(key).text();
  }
  return oneLine(remark);
}

/// `calibrate disturbance` says by the letter of each d_LETTER whether the data support its bound.
void refuseUnsupported(const YamlField& file, const std::string& name, const YamlField& from) {
  if (!file.has("axes") || name.size() < 2 || name.compare(0, 2, "d_") != 0) return;
  const YamlField axes = file.at("axes");
  const std::string axis = name.substr(2);
  if (!axes.has(axis) || !axes.at(axis).has("supported")) return;
  if (axes.at(axis).at("supported").text() != "false") return;
  from.at("name").fail("the data do not support the bound of " + name +
                       " (supported: false): fly longer, or write the range as numbers");
}

/// A file that `calibrate` wrote is read by the rules of `calibrate apply`. Another one may have what is read here, and
/// where its flights are from.
void checkCitedFile(const std::string& text, const std::string& place, const std::string& problem) {
  const YamlField file = YamlField::parse(text, place);
  if (!file.has("polyfly_calibration")) {
    file.checkKeys({"disturbances"}, {"kind", "data", "share", "confidence", "axes"});
    for (const YamlField& entry : file.at("disturbances").items())
      entry.checkKeys({"name", "unit", "range"}, {});
    return;
  }
  const CalibrationDocument calibration({text, place, {}, false});
  if (calibration.kind() != "disturbance")
    file.at("kind").fail("must be disturbance where a range is cited, got '" + calibration.kind() + "'");
  // No other vehicle flies these maps.
  calibration.requireVehicle("multirotor", problem);
}

Cited cite(const YamlField& channel, const std::string& folder, const std::string& problem) {
  const YamlField from = channel.at("range");
  from.checkKeys({"from", "name"}, {});
  const std::string path = from.at("from").text(), name = from.at("name").name();
  const std::string place = (std::filesystem::path(folder) / path).string();
  const std::string text = readText(place);
  checkCitedFile(text, place, problem);
  const YamlField file = YamlField::parse(text, place);
  for (const YamlField& entry : file.at("disturbances").items()) {
    if (entry.at("name").name() != name) continue;
    if (entry.at("unit").unit() != channel.at("unit").unit())
      entry.at("unit").fail("must be " + channel.at("unit").unit() + ", as where it is cited");
    refuseUnsupported(file, name, from);
    const std::vector<YamlField> ends = entry.at("range").items();
    if (ends.size() != 2) entry.at("range").fail("must be [lower, upper]");
    return {"[" + ends[0].text() + ", " + ends[1].text() + "]", origin(file, path, name)};
  }
  from.at("name").fail("must be a disturbance of " + place + ", got '" + name + "'");
}

/// From `begin` on, `range: {from: ...}` on one line: where the braces are, and where the line ends.
struct Place {
  std::size_t open = std::string::npos;
  std::size_t close = 0;
  std::size_t line_end = 0;
};

Place nextCitation(const std::string& text, std::size_t begin) {
  const std::string blank = " \t";
  for (std::size_t key = text.find("range:", begin); key != std::string::npos;
       key = text.find("range:", key + 1)) {
    const std::size_t open = text.find_first_not_of(blank, key + 6);
    if (open == std::string::npos || text[open] != '{') continue;
    const std::size_t line = std::min(text.find('\n', open), text.size());
    const std::size_t word = text.find_first_not_of(blank, open + 1);
    const std::size_t close = text.find('}', open);
    if (word == std::string::npos || text.compare(word, 5, "from:") != 0 || close >= line) continue;
    return {open, close, line};
  }
  return {};
}

}  // namespace

std::string withCitedRanges(const std::string& text, const std::string& path) {
  const YamlField root = YamlField::parse(text, path);
  if (!root.has("model") || !root.at("model").has("disturbances")) return text;
  const std::string folder = std::filesystem::path(path).parent_path().string();
  std::string result;
  std::size_t done = 0;
  for (const YamlField& channel : root.at("model").at("disturbances").items()) {
    if (!channel.has("range") || !channel.at("range").has("from")) continue;
    const Cited cited = cite(channel, folder, path);
    const Place place = nextCitation(text, done);
    if (place.open == std::string::npos)
      channel.at("range").fail("must be written as range: {from: FILE, name: NAME} on one line");
    result += text.substr(done, place.open - done) + cited.range +
              text.substr(place.close + 1, place.line_end - place.close - 1) + "  # " + cited.remark;
    done = place.line_end;
  }
  return result + text.substr(done);
}

}  // namespace polyfly
