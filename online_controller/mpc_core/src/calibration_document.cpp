#include "mpc_core/calibration_document.hpp"

#include <algorithm>
#include <array>

#include "calibration_keys.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr std::array<const char*, 4> kCalibrationKinds = {"attitude", "drag", "disturbance", "mass"};
// Value of the key polyfly_calibration.
constexpr int kCalibrationFormat = 1;

std::string kindOf(const YamlField& root) {
  if (!root.has("polyfly_calibration"))
    root.failAt("polyfly_calibration", "must be 1, as `calibrate` writes it");
  root.at("polyfly_calibration").integer(kCalibrationFormat, kCalibrationFormat);
  const YamlField kind = root.at("kind");
  if (std::find(kCalibrationKinds.begin(), kCalibrationKinds.end(), kind.text()) == kCalibrationKinds.end())
    kind.fail("must be attitude, drag, disturbance or mass, got '" + kind.text() +
              "'; thrust, heading and wind are written by hand, see calibration/README.md");
  return kind.text();
}

// From the key `depth` of the place on. Fields are not assigned: assigning a YAML::Node changes the tree.
YamlField memberAt(const YamlField& field, const std::vector<std::string>& place, std::size_t depth) {
  return depth == place.size() ? field : memberAt(field.at(place[depth]), place, depth + 1);
}

bool hasMember(const YamlField& field, const std::vector<std::string>& place, std::size_t depth) {
  if (depth == place.size()) return true;
  return field.has(place[depth]) && hasMember(field.at(place[depth]), place, depth + 1);
}

// Empty if there is no such text: `recorded` is "" where the log has no date.
std::string textAt(const YamlField& flight, const char* key) {
  try {
    return flight.has(key) ? flight.at(key).text() : "";
  } catch (const Error&) {
    return "";
  }
}

// File, checksum and date of a flight, as a list; of several flights a list of such lists.
std::string flightEntries(const std::vector<YamlField>& flights) {
  std::string text;
  for (const YamlField& flight : flights) {
    text += (text.empty() ? "[" : ", [") + yamlString(textAt(flight, "file")) + ", " +
            yamlString(textAt(flight, "checksum")) + ", " + yamlString(textAt(flight, "recorded")) + "]";
  }
  return flights.size() > 1 ? "[" + text + "]" : text;
}

}  // namespace

CalibrationDocument::CalibrationDocument(const CalibrationFile& file)
    : file_(file), root_(YamlField::parse(file.text, file.source)), kind_(kindOf(root_)) {
  checkCalibrationKeys(root_, kind_);
}

void CalibrationDocument::requireVehicle(const std::string& vehicle, const std::string& target) const {
  if (!root_.has("vehicle")) return;
  const YamlField told = root_.at("vehicle");
  const std::string kind = told.at("kind").text();
  if (kind == vehicle || kind == "unknown") return;
  told.at("kind").fail("must be " + vehicle + " for " + target + ", got " + kind + " (" +
                       (told.has("reason") ? told.at("reason").text() : "no reason") +
                       "); `calibrate --vehicle` states another kind");
}

YamlField CalibrationDocument::at(const std::vector<std::string>& place) const {
  return memberAt(root_, place, 0);
}

bool CalibrationDocument::has(const std::vector<std::string>& place) const {
  return hasMember(root_, place, 0);
}

void CalibrationDocument::requireSupport(const std::vector<std::string>& place) const {
  if (file_.force) return;
  const YamlField map = at(place);
  if (!map.has("supported"))
    map.failAt("supported",
               "missing: calibrate the flight again (calibrate apply --force takes the numbers)");
  const YamlField supported = map.at("supported");
  if (supported.text() == "true") return;
  if (supported.text() != "false") supported.fail("must be true or false");
  std::string reasons;
  for (const char* key : {"reasons", "warnings"}) {
    if (!map.has(key)) continue;
    for (const YamlField& one : map.at(key).items()) reasons += "\n  " + one.text();
  }
  supported.fail("the data do not support these numbers; fly again (calibrate apply --force takes them)" +
                 reasons);
}

double CalibrationDocument::supported(const std::vector<std::string>& place, const char* key) const {
  requireSupport(place);
  return at(place).at(key).number();
}

double CalibrationDocument::supportedAbove0(const std::vector<std::string>& place, const char* key,
                                            const char* meaning) const {
  const double value = supported(place, key);
  if (!(value > 0.0)) at(place).at(key).fail(std::string("must be greater than 0") + meaning);
  return value;
}

std::pair<double, double> CalibrationDocument::intervalOf(const std::string& name) const {
  const YamlField interval = at({"parameters", name, "interval_95"});
  const std::vector<YamlField> ends = interval.items();
  if (ends.size() != 2) interval.fail("must be [least, greatest]");
  return {ends[0].number(), ends[1].number()};
}

double CalibrationDocument::positiveParameter(const std::string& name) const {
  const std::vector<std::string> place = {"parameters", name};
  const double value = supported(place, "value");
  if (value < 0.0) at(place).at("value").fail("must not be negative");
  if (file_.force) return value;
  if (!(intervalOf(name).first > 0.0))
    at(place).at("interval_95").fail("must be above 0 (calibrate apply --force takes the number)");
  return value;
}

std::vector<std::pair<std::string, std::pair<double, double>>> CalibrationDocument::disturbances() const {
  std::vector<std::pair<std::string, std::pair<double, double>>> bounds;
  for (const YamlField& bound : at({"disturbances"}).items()) {
    const std::string name = bound.at("name").name();
    double least = 0.0;
    double greatest = 0.0;
    bound.at("range").range(&least, &greatest);
    bounds.push_back({name.substr(name.size() - 1), {least, greatest}});
  }
  return bounds;
}

std::vector<YamlField> CalibrationDocument::flights() const {
  const YamlField data = root_.at("data");
  const YamlField flights = data.isList() || !data.has("training") ? data : data.at("training");
  return flights.isList() ? flights.items() : std::vector<YamlField>{flights};
}

std::string CalibrationDocument::provenanceEntry(const std::vector<std::string>& fields) const {
  std::string text = "  - {file: " + yamlString(file_.provenance.file) +
                     ", checksum: " + yamlString(file_.provenance.checksum) + ", kind: " + kind_ +
                     ",\n     tool_version: " +
                     yamlString(root_.has("tool_version") ? root_.at("tool_version").text() : "") +
                     ", data: " + flightEntries(flights()) + ",\n     fields: [";
  for (std::size_t index = 0; index < fields.size(); ++index)
    text += (index > 0 ? ", " : "") + yamlString(fields[index]);
  return text + "]}\n";
}

std::string CalibrationDocument::provenanceText(const std::vector<std::string>& fields) const {
  std::string text;
  for (const std::string& field : fields) text += (text.empty() ? "" : ", ") + field;
  text += " from " + file_.provenance.file + " (" + file_.provenance.checksum + ") of ";
  const std::vector<YamlField> all = flights();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string recorded = textAt(all[i], "recorded");
    text += (i > 0 ? ", " : "") + textAt(all[i], "file") + " (" + textAt(all[i], "checksum") +
            (recorded.empty() ? ")" : ", " + recorded + ")");
  }
  return text;
}

}  // namespace polyfly
