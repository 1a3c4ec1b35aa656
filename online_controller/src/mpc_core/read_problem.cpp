#include "mpc_core/read_problem.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "mpc_core/apply_calibration.hpp"
#include "mpc_core/read_text.hpp"
#include "mpc_core/yaml_field.hpp"

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
  const std::vector<YamlField> files = field.isList() ? field.items() : std::vector<YamlField>{field};
  if (files.empty()) field.fail("must name a file that `calibrate` wrote, or several");
  return files;
}

}  // namespace

std::string readProblem(const std::string& path) {
  const std::string key = "calibration";
  const std::string text = readText(path);
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

}  // namespace polyfly
