#include "report/yaml.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "polyfly_base/provenance.hpp"

namespace polyfly {
namespace {

// Whether a value stands in one line behind its key.
bool isShort(const Json& value) {
  if (!value.is_structured()) return true;
  if (value.is_object()) return value.empty();
  return std::all_of(value.begin(), value.end(),
                     [](const Json& item) { return !item.is_string() && isShort(item); });
}

std::string yamlNumber(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value > 0.0 ? ".inf" : "-.inf";
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string inLine(const Json& value) {
  if (value.is_number_float()) return yamlNumber(value.get<double>());
  if (value.is_string()) return yamlString(value.get<std::string>());
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const Json& item : value) text += (text.empty() ? "" : ", ") + inLine(item);
  return "[" + text + "]";
}

std::string linesOf(const Json& json, const std::string& indent) {
  std::string text;
  for (const auto& [key, value] : json.items()) {
    const std::string begin = indent + (json.is_array() ? "-" : key + ":");
    if (isShort(value)) {
      text += begin + " " + inLine(value) + "\n";
    } else if (json.is_array()) {
      // The first line of the item stands behind the dash.
      text += begin + " " + linesOf(value, indent + "  ").substr(indent.size() + 2);
    } else {
      text += begin + "\n" + linesOf(value, indent + "  ");
    }
  }
  return text;
}

}  // namespace

std::string yamlText(const Json& json) { return linesOf(json, ""); }

}  // namespace polyfly
