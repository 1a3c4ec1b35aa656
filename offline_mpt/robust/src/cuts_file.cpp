#include <algorithm>
#include <nlohmann/json.hpp>

#include "integer_program.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"
#include "polyfly_base/write_file.hpp"
#include "rational_parts.hpp"
#include "robust_mpc/feasible_set.hpp"

namespace polyfly {
namespace {

using Parts = std::vector<FeasibleSet::Part>;

constexpr char kFormat[] = "polyfly_robust_cuts";
constexpr int kVersion = 1;

std::string signsText(const std::vector<bool>& negative) {
  std::string text;
  for (const bool minus : negative) text += minus ? '-' : '+';
  return text;
}

/// Throws nlohmann's exceptions, std::invalid_argument for a weight, or Error.
FeasibleSet::Part readPart(const nlohmann::json& json, const RobustProgram& program) {
  FeasibleSet::Part part;
  part.row = json.at(0).get<int>();
  if (part.row < 0 || at(part.row) >= program.rows.size()) throw Error("names a row that is not there");
  const auto signs = json.at(1).get<std::string>();
  if (signs.size() != program.rows[at(part.row)].terms.size()) throw Error("has another number of signs");
  for (const char sign : signs) part.negative.push_back(sign == '-');
  part.weight = Rational(json.at(2).get<std::string>());
  if (part.weight.get_den() == 0) throw Error("has a weight with the denominator 0");
  part.weight.canonicalize();
  if (part.weight <= 0) throw Error("has a weight that is not above 0");
  return part;
}

/// Throws Error where predictions do not cancel.
FeasibleSet::Facet readCut(const nlohmann::json& json, const RobustProgram& program,
                           const IntegerProgram& whole) {
  Parts parts;
  for (const nlohmann::json& part : json) parts.push_back(readPart(part, program));
  std::optional<FeasibleSet::Facet> facet = whole.sumOf(parts);
  if (!facet) throw Error("does not follow from the rows of the problem");
  const RationalVector& a = facet->half_space.a;
  if (std::all_of(a.begin(), a.end(), [](const Rational& value) { return value == 0; }))
    throw Error("has no normal");
  return std::move(*facet);
}

nlohmann::json parse(const std::string& path) {
  const nlohmann::json json = nlohmann::json::parse(readText(path), nullptr, false);
  if (!json.is_object() || json.value(kFormat, nlohmann::json()) != kVersion || !json.contains("cuts") ||
      !json["cuts"].is_array()) {
    throw Error(path + ": is no checkpoint of a robust MPC, of version " + std::to_string(kVersion));
  }
  return json;
}

}  // namespace

void writeCuts(const std::string& path, const std::vector<FeasibleSet::Facet>& cuts) {
  nlohmann::json list = nlohmann::json::array();
  for (const FeasibleSet::Facet& cut : cuts) {
    nlohmann::json parts = nlohmann::json::array();
    for (const FeasibleSet::Part& part : cut.parts)
      parts.push_back({part.row, signsText(part.negative), part.weight.get_str()});
    if (!parts.empty()) list.push_back(std::move(parts));
  }
  writeFileAtomically(path, nlohmann::json{{kFormat, kVersion}, {"cuts", std::move(list)}}.dump() + "\n");
}

std::vector<FeasibleSet::Facet> readCuts(const std::string& path, const RobustProgram& program) {
  const nlohmann::json json = parse(path);
  const IntegerProgram whole(program);
  std::vector<FeasibleSet::Facet> cuts;
  for (const nlohmann::json& cut : json["cuts"]) {
    const std::string name = path + ": half-space " + std::to_string(cuts.size()) + ": ";
    try {
      cuts.push_back(readCut(cut, program, whole));
    } catch (const Error& error) {
      throw Error(name + error.what());
    } catch (const std::exception&) {  // of nlohmann, or of GMP for a number
      throw Error(name + "is no list of rows, signs and weights");
    }
  }
  return cuts;
}

}  // namespace polyfly
