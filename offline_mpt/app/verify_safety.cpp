#include "verify_safety.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "mpc_core/safety_filter.hpp"
#include "region_maps/region_map.hpp"
#include "safety_filter/prove_filter.hpp"

namespace polyfly {
namespace {

std::string filterAnswersText(const FilterAnswers& answers) {
  char line[160];
  std::snprintf(line, sizeof line, "  %san answer of the map needs at most %.3g of the margin (1: all)\n",
                answers.within_slack ? "" : "NOT PROVEN: ", answers.used);
  return std::string(answers.passes_wishes ? "  an admissible wish comes back unchanged\n"
                                           : "  NOT PROVEN: an admissible wish may come back changed\n") +
         line;
}

}  // namespace

std::string SafetyVerdict::addTo(const std::string& report) const {
  if (json.empty()) return report;
  nlohmann::ordered_json whole = nlohmann::ordered_json::parse(report);
  whole["safe_set"] = nlohmann::ordered_json::parse(json);
  return whole.dump(2) + "\n";
}

SafetyVerdict verifySafety(const ParametricProgram& program, const std::string& map) {
  SafetyVerdict verdict;
  const std::string source = map + ": problem text";
  if (program.text_kind != "yaml" || !isSafetyFilter(program.text, source)) return verdict;
  const SafetyFilterProblem problem = parseSafetyFilter(program.text, source);
  const FilterProof proof = proveFilter(problem);
  const FilterAnswers answers = proveAnswers(RegionMap::open(map), problem);
  verdict.holds = proof.holds() && answers.hold();
  verdict.text = filterProofText(problem, proof) + filterAnswersText(answers);
  verdict.json = filterProofJson(problem, proof, answers);
  return verdict;
}

}  // namespace polyfly
