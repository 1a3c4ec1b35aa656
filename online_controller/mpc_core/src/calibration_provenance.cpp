#include "mpc_core/calibration_provenance.hpp"

#include <yaml-cpp/yaml.h>

#include <exception>

#include "polyfly_base/load_yaml.hpp"

namespace polyfly {
namespace {

std::string scalarAt(const YAML::Node& map, const char* key) {
  const YAML::Node value = map[key];
  return value.IsDefined() && value.IsScalar() ? value.Scalar() : std::string();
}

// File, checksum and date of a flight, as CalibrationDocument::provenanceEntry writes them.
std::string flightText(const YAML::Node& flight) {
  std::string text = flight[0].Scalar();
  if (flight.size() > 2 && !flight[2].Scalar().empty()) text += " (" + flight[2].Scalar() + ")";
  return text;
}

std::string flightsText(const YAML::Node& data) {
  if (!data.IsDefined() || !data.IsSequence() || data.size() == 0) return "";
  if (!data[0].IsSequence()) return flightText(data);
  std::string text;
  for (const auto& flight : data) text += (text.empty() ? "" : ", ") + flightText(flight);
  return text;
}

}  // namespace

std::string calibrationsOf(const std::string& problem) {
  std::string text;
  try {
    const YAML::Node root = loadYaml(problem, "the problem");
    if (!root.IsMap()) return "";
    const YAML::Node provenance = root["provenance"];
    if (!provenance.IsDefined() || !provenance.IsSequence()) return "";
    for (const auto& entry : provenance) {
      if (!entry.IsMap()) continue;
      const std::string flights = flightsText(entry["data"]);
      text += (text.empty() ? "" : "; ") + scalarAt(entry, "kind") + " from " + scalarAt(entry, "file") +
              " (" + scalarAt(entry, "checksum") + ")" + (flights.empty() ? "" : " of " + flights);
    }
  } catch (const std::exception&) {
    return "";
  }
  return text;
}

}  // namespace polyfly
