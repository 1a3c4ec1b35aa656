#include "mpc_core/read_problem.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "mpc_core/apply_calibration.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"
#include "polyfly_base/yaml_field.hpp"

namespace polyfly {
namespace {

// The lines of a key of the file, with what is indented under it, as comments: line numbers stay.
std::string commented(const std::string& text, const std::string& key) {
  std::string result;
  bool within = false;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
    const std::string line = text.substr(begin, end - begin);
    const bool starts = line.compare(0, key.size() + 1, key + ":") == 0;
    const bool continues = within && (line[0] == ' ' || line[0] == '\t' || line[0] == '-');
    within = starts || continues;
    result += (within ? "# " : "") + line;
    begin = end;
  }
  return result;
}

std::vector<YamlField> citedFiles(const YamlField& field) {
  std::vector<YamlField> files = field.isList() ? field.items() : std::vector<YamlField>{field};
  if (files.empty()) field.fail("must name a file that `calibrate` wrote, or several");
  return files;
}

}  // namespace

std::string readProblem(const std::string& path) {
  const std::string key = "calibration";
  std::string text = readText(path);
  const YamlField root = YamlField::parse(text, path);
  if (!root.has(key)) return text;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::vector<CalibrationFile> files;
  for (const YamlField& cited : citedFiles(root.at(key))) {
    const std::string place = (folder / cited.text()).string();
    if (!std::filesystem::is_regular_file(place)) cited.fail("must name a file that is there, not " + place);
    files.push_back({readText(place), place, provenanceOf(place)});
  }
  return applyCalibrations(commented(text, key), path, files).problem;
}

std::vector<std::string> filesOfProblem(const std::string& path) {
  std::vector<std::string> files = {path};
  std::error_code ignored;
  const bool yaml = endsWith(path, ".yaml") || endsWith(path, ".yml");
  if (!yaml || !std::filesystem::is_regular_file(path, ignored)) return files;  // a FIFO is read once only
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  try {
    const YamlField root = YamlField::parse(readText(path), path);
    if (root.has("calibration")) {
      for (const YamlField& cited : citedFiles(root.at("calibration")))
        files.push_back((folder / cited.text()).string());
    }
    if (!root.has("model") || !root.at("model").has("disturbances")) return files;
    for (const YamlField& channel : root.at("model").at("disturbances").items()) {
      if (channel.has("range") && channel.at("range").has("from"))
        files.push_back((folder / channel.at("range").at("from").text()).string());
    }
  } catch (const Error&) {  // told by whoever reads the problem
  }
  return files;
}

}  // namespace polyfly
