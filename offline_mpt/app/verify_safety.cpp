#include "verify_safety.hpp"

#include <nlohmann/json.hpp>

#include "mpc_core/safety_filter.hpp"
#include "region_maps/region_map.hpp"
#include "safety_filter/prove_filter.hpp"

namespace polyfly {

std::string SafetyVerdict::addTo(const std::string& report) const {
  if (json.empty()) return report;
  nlohmann::ordered_json whole = nlohmann::ordered_json::parse(report);
  whole["safe_set"] = nlohmann::ordered_json::parse(json);
  whole["safe_set"]["passes_wishes"] = passes_wishes;
  return whole.dump(2) + "\n";
}

SafetyVerdict verifySafety(const ParametricProgram& program, const std::string& map) {
  SafetyVerdict verdict;
  const std::string source = map + ": problem text";
  if (program.text_kind != "yaml" || !isSafetyFilter(program.text, source)) return verdict;
  const SafetyFilterProblem problem = parseSafetyFilter(program.text, source);
  const FilterProof proof = proveFilter(problem);
  verdict.passes_wishes = passesWishes(RegionMap::open(map), problem);
  verdict.holds = proof.holds() && verdict.passes_wishes;
  verdict.text = filterProofText(problem, proof);
  verdict.text += verdict.passes_wishes ? "  an admissible wish comes back unchanged\n"
                                        : "  NOT PROVEN: an admissible wish may come back changed\n";
  verdict.json = filterProofJson(problem, proof);
  return verdict;
}

}  // namespace polyfly
