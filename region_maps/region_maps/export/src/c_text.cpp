#include "c_text.hpp"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cstdio>
#include <cstdlib>

#include "polyfly_base/decimal.hpp"
#include "polyfly_base/visible.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kLineWidth = 110;

std::string join(const std::vector<std::string>& elements, std::size_t width) {
  std::string text = "{\n";
  std::string line = "   ";
  for (std::size_t i = 0; i < elements.size(); ++i) {
    std::string element = elements[i];
    if (width > 0 && i % width == 0) element.insert(0, "{");
    if (width > 0 && i % width == width - 1) element += "}";
    if (i + 1 != elements.size()) element += ",";
    if (line.size() + 1 + element.size() > kLineWidth) {
      text += line + "\n";
      line = "   ";
    }
    line += " " + element;
  }
  return text + line + "\n}";
}

}  // namespace

std::string replaced(const std::string& text, const Replacements& replacements) {
  std::string result;
  std::size_t place = 0;
  while (true) {
    const std::size_t first = text.find('@', place);
    result += text.substr(place, first - place);
    if (first == std::string::npos) return result;
    const std::size_t end = text.find('@', first + 1);
    const auto found = replacements.find(text.substr(first + 1, end - first - 1));
    assert(found != replacements.end());
    result += found->second;
    place = end + 1;
  }
}

std::string constant(double value, ExportType type) {
  std::string text =
      type == ExportType::kDouble ? shortestText(value) : shortestText(static_cast<float>(value));
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return type == ExportType::kDouble ? text : text + "f";
}

std::string roundedUp(double value) {
  // One unit of the last of four digits exceeds what rounding takes away.
  constexpr double kUnit = 1.001;
  char digits[40];
  std::snprintf(digits, sizeof digits, "%.3e", value);
  if (std::strtod(digits, nullptr) < value) std::snprintf(digits, sizeof digits, "%.3e", value * kUnit);
  return digits;
}

std::string roundedDown(double value) {
  constexpr double kUnit = 0.999;
  char digits[40];
  std::snprintf(digits, sizeof digits, "%.3e", value);
  if (std::strtod(digits, nullptr) > value) std::snprintf(digits, sizeof digits, "%.3e", value * kUnit);
  return digits;
}

std::string initialiser(const std::vector<double>& values, std::size_t width, ExportType type) {
  std::vector<std::string> elements;
  for (const double value : values) elements.push_back(constant(value, type));
  if (elements.empty()) elements.assign(std::max<std::size_t>(width, 1), constant(0.0, type));
  return join(elements, width);
}

std::string initialiser(const std::vector<std::uint32_t>& values, std::size_t width) {
  std::vector<std::string> elements;
  for (const std::uint32_t value : values) elements.push_back(std::to_string(value) + "u");
  if (elements.empty()) elements.assign(std::max<std::size_t>(width, 1), "0u");
  return join(elements, width);
}

std::size_t rowCount(std::size_t values, std::size_t width) {
  return std::max<std::size_t>(values / width, 1);
}

std::string commentText(const std::string& text) {
  std::string result = visible(text);
  // Ends of comments, line splices and trigraphs.
  for (char& letter : result) {
    if (letter == '*' || letter == '\\' || letter == '?') letter = '_';
  }
  return result;
}

std::string signalLines(const char* kind, const std::vector<Signal>& signals) {
  std::string text;
  char range[80];
  for (std::size_t i = 0; i < signals.size(); ++i) {
    std::snprintf(range, sizeof range, "%.6g .. %.6g ", signals[i].lower, signals[i].upper);
    text += std::string(" * ") + kind + "[" + std::to_string(i) + "]: " + commentText(signals[i].name) +
            ", " + range + commentText(signals[i].unit) + "\n";
  }
  return text;
}

std::string upperCase(const std::string& name) {
  std::string result = name;
  for (char& letter : result) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  return result;
}

}  // namespace polyfly
