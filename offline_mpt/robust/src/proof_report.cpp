#include <nlohmann/json.hpp>
#include <sstream>

#include "robust_mpc/prove_map.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kDefectsShown = 10;

std::string list(const RationalVector& values) {
  std::ostringstream text;
  text.precision(17);
  for (std::size_t j = 0; j < values.size(); ++j) text << (j > 0 ? ", " : "") << nearestDouble(values[j]);
  return text.str();
}

const char* answer(bool proven) { return proven ? "proven" : "NOT PROVEN"; }

void describe(const RobustWitness& witness, std::ostringstream& text) {
  text << "    from theta = " << list(witness.theta) << " with w = " << list(witness.disturbance)
       << " (half widths): " << witness.rule << "\n";
}

nlohmann::ordered_json toJson(const std::optional<RobustWitness>& witness) {
  if (!witness) return nullptr;
  nlohmann::ordered_json json;
  json["rule"] = witness->rule;
  json["theta"] = nlohmann::ordered_json::array();
  json["disturbance"] = nlohmann::ordered_json::array();
  json["theta_exact"] = nlohmann::ordered_json::array();
  for (const Rational& value : witness->theta) {
    json["theta"].push_back(nearestDouble(value));
    json["theta_exact"].push_back(value.get_str());
  }
  for (const Rational& value : witness->disturbance) json["disturbance"].push_back(nearestDouble(value));
  return json;
}

}  // namespace

std::string proofText(const RobustProblem& problem, const RobustProof& proof) {
  std::ostringstream text;
  text << "exact verification: " << (proof.passed() ? "PROVEN" : "REFUTED") << "\n"
       << "  feasible set: " << proof.facets
       << " facets, none cuts off a feasible point: " << answer(proof.set_valid) << "\n"
       << "  " << proof.vertices
       << " vertices, each with a plan that meets every bound for every disturbance: "
       << answer(proof.set_feasible) << "\n"
       << "  map: " << proof.regions
       << " regions cover all feasible parameters, in each tau is least, then the move nearest to K e, and "
          "look-ups answer so: "
       << answer(!proof.certificate.empty()) << "\n"
       << "  bounds and tau after one step, " << proof.steps
       << " vertices of region and disturbance: " << answer(!proof.broken_bound) << "\n";
  if (proof.broken_bound) describe(*proof.broken_bound, text);
  text << "  feasibility is never lost within the box: " << (proof.recursivelyFeasible() ? "proven" : "NO")
       << "\n";
  if (proof.lost) {
    describe(*proof.lost, text);
    if (problem.invariance == InvarianceRule::kNone)
      text << "    (invariance: first_step would make it hold)\n";
  }
  for (const RobustProof::BoxExit& exit : proof.box_exits) {
    text << "  a successor may leave the box along "
         << problem.parameters[static_cast<std::size_t>(exit.parameter)].signal.name << ", by " << exit.excess
         << " of its half width: "
         << (exit.clips_safely ? "cut to the box it keeps all bounds, as none depends on it\n"
                               : "the map ends there\n");
  }
  text << "  greatest difference from the exact solution: law " << proof.law_error << ", plane "
       << proof.plane_error << " (scaled)\n";
  for (std::size_t k = 0; k < proof.defects.size() && k < kDefectsShown; ++k)
    text << "  - " << proof.defects[k] << "\n";
  if (proof.defects.size() > kDefectsShown)
    text << "  - and " << proof.defects.size() - kDefectsShown << " more\n";
  return text.str();
}

std::string proofJson(const RobustProblem& problem, const RobustProof& proof) {
  nlohmann::ordered_json json;
  json["name"] = problem.name;
  json["proven"] = proof.passed();
  json["facets"] = proof.facets;
  json["vertices"] = proof.vertices;
  json["facets_valid"] = proof.set_valid;
  json["vertices_feasible"] = proof.set_feasible;
  json["regions"] = proof.regions;
  json["map_proven"] = !proof.certificate.empty();
  json["steps"] = proof.steps;
  json["bounds_hold"] = !proof.broken_bound;
  json["broken_bound"] = toJson(proof.broken_bound);
  json["recursively_feasible"] = proof.recursivelyFeasible();
  json["lost"] = toJson(proof.lost);
  json["box_exits"] = nlohmann::ordered_json::array();
  for (const RobustProof::BoxExit& exit : proof.box_exits) {
    nlohmann::ordered_json entry;
    entry["parameter"] = exit.parameter;
    entry["excess"] = exit.excess;
    entry["clips_safely"] = exit.clips_safely;
    json["box_exits"].push_back(entry);
  }
  json["law_error"] = proof.law_error;
  json["plane_error"] = proof.plane_error;
  json["defects"] = proof.defects;
  return json.dump(2) + "\n";
}

}  // namespace polyfly
