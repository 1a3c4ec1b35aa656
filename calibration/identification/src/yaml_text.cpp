#include "identification/yaml_text.hpp"

#include <cmath>

#include "identification/provenance.hpp"
#include "sentence.hpp"

namespace polyfly {

std::string yamlNumber(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value > 0.0 ? ".inf" : "-.inf";
  return sentence("%.6g", value);
}

std::string provenanceMap(const Provenance& provenance) {
  return "{file: " + yamlString(provenance.file) + ", checksum: " + yamlString(provenance.checksum) +
         ", recorded: " + yamlString(provenance.recorded) + "}";
}

void writeSentences(const char* key, const std::string& indent, const std::vector<std::string>& sentences,
                    std::ostream& out) {
  out << indent << key << ":" << (sentences.empty() ? " []" : "") << "\n";
  for (const std::string& sentence : sentences) out << indent << "  - " << yamlString(sentence) << "\n";
}

std::string windowList(const std::vector<TimeWindow>& windows) {
  std::string text;
  for (const TimeWindow& window : windows)
    text += (text.empty() ? "[" : ", [") + yamlNumber(window.from) + ", " + yamlNumber(window.to) + "]";
  return "[" + text + "]";
}

std::string vehicleLine(const VehicleKind& vehicle) {
  return "vehicle: {kind: " + vehicle.name + ", reason: " + yamlString(vehicle.reason) + "}\n";
}

std::string valueText(double value, double half_width) {
  // Half width from which on the data say nothing, for any quantity here.
  constexpr double kNoInterval = 1e4;
  return sentence("%.5g", value) + (std::abs(half_width) < kNoInterval
                                        ? sentence(" +- %.2g", half_width)
                                        : " (no interval: the data do not bound it)");
}

}  // namespace polyfly
