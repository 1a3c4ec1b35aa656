#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "offline_mpt/verify.hpp"
#include "support/vector_text.hpp"

namespace polyfly {
namespace {

struct NamedFinding {
  const char* key;
  const char* sentence;
  // Meaning of `worst`. Empty: none.
  const char* measure;
  const Finding* finding;
};

std::vector<NamedFinding> findings(const VerifyReport& report) {
  return {
      {"errors", "answers off by more than the tolerance", "scaled error", &report.errors},
      {"missed", "feasible, but in no region", "", &report.missed},
      {"false_inside", "infeasible, but answered", "distance to the feasible set [scaled]",
       &report.false_inside},
      {"beyond", "off beyond a region's edge (no fault)", "share or distance", &report.beyond},
      {"overlaps", "in several regions that differ", "scaled difference", &report.overlaps},
      {"tree_errors", "tree and test of all regions disagree", "", &report.tree_errors},
      {"empty_regions", "drawn from a region without interior", "by [scaled]", &report.empty_regions},
      {"unbounded", "feasible, cost unbounded below", "", &report.unbounded},
      {"undecided", "undecided: the optimum was not found", "", &report.undecided},
  };
}

void writeVector(std::ostream& out, const Eigen::VectorXd& vector) {
  out << '(';
  for (Eigen::Index i = 0; i < vector.size(); ++i)
    out << (i > 0 ? ", " : "") << std::setprecision(17) << vector[i];
  out << ')' << std::setprecision(3);
}

}  // namespace

std::string verifyText(const VerifyReport& report) {
  std::ostringstream out;
  out << std::setprecision(3);
  out << "samples            " << report.samples << " of " << report.requested << ", seed " << report.seed
      << ", " << report.uniform << " uniform, " << report.samples - report.uniform
      << " at degenerate places\n";
  out << "inside the map     " << report.inside << ", infeasible " << report.infeasible << ", at the edge "
      << report.borderline << " (within " << report.edge_tolerance << " of half a range)\n";
  out << "regions hit        " << report.regions_hit << " of " << report.regions << "\n";
  out << "compared           u, at " << report.compared << " samples\n";
  out << "greatest error     " << report.max_error << ", scaled " << report.max_scaled_error << " (tolerance "
      << report.tolerance << ")";
  if (report.max_error_theta.size() > 0 && report.max_scaled_error > 0.0) {
    out << " at ";
    writeVector(out, report.max_error_theta);
    out << ", region " << report.max_error_region;
  }
  out << '\n';
  for (const NamedFinding& item : findings(report)) {
    out << std::left << std::setw(40) << item.sentence << std::right << item.finding->count;
    if (item.finding->count > 0) {
      if (*item.measure != '\0') out << ", worst " << item.measure << ' ' << item.finding->worst;
      out << ", at ";
      writeVector(out, item.finding->example);
    }
    out << '\n';
  }
  out << "not covered: what lies between samples, and gaps within " << report.edge_tolerance
      << " of the edge of the feasible set; --exact proves both\n";
  if (report.map_status != "complete") out << "the map says that it is " << report.map_status << "\n";
  if (report.interrupted) out << "stopped before the end\n";
  out << (report.passed() ? "PASSED\n" : "FAILED\n");
  return out.str();
}

std::string verifyJson(const VerifyReport& report) {
  nlohmann::ordered_json json;
  json["passed"] = report.passed();
  json["seed"] = report.seed;
  json["tolerance"] = report.tolerance;
  json["edge_tolerance"] = report.edge_tolerance;
  json["requested"] = report.requested;
  json["samples"] = report.samples;
  json["uniform"] = report.uniform;
  json["inside"] = report.inside;
  json["compared"] = report.compared;
  json["infeasible"] = report.infeasible;
  json["borderline"] = report.borderline;
  json["max_error"] = report.max_error;
  json["max_scaled_error"] = report.max_scaled_error;
  json["max_error_theta"] = numbersOf(report.max_error_theta);
  json["max_error_region"] = report.max_error_region;
  for (const NamedFinding& item : findings(report)) {
    auto& entry = json[item.key];
    entry["count"] = item.finding->count;
    if (item.finding->count == 0) continue;
    if (*item.measure != '\0') entry["worst"] = item.finding->worst;
    entry["example"] = numbersOf(item.finding->example);
  }
  json["regions"] = report.regions;
  json["regions_hit"] = report.regions_hit;
  json["map_status"] = report.map_status;
  json["interrupted"] = report.interrupted;
  return json.dump(2) + "\n";
}

}  // namespace polyfly
