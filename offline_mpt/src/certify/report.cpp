#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "offline_mpt/certify.hpp"
#include "support/vector_text.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kDefectsShown = 10;

std::string list(const Eigen::VectorXd& theta) {
  std::ostringstream text;
  text.precision(17);
  for (Eigen::Index j = 0; j < theta.size(); ++j) text << (j > 0 ? ", " : "") << theta(j);
  return text.str();
}

std::string list(const std::vector<int>& rows) {
  std::string text;
  for (const int row : rows) text += (text.empty() ? "" : ", ") + std::to_string(row);
  return text;
}

std::string verdict(const CertifyReport& report) {
  if (report.interrupted) return "INTERRUPTED";
  if (report.passed()) return "PROVEN";
  const bool may_be_right =
      std::all_of(report.defects.begin(), report.defects.end(), [](const Defect& defect) {
        return defect.kind == Defect::Kind::kLookup && defect.witness.size() == 0;
      });
  return may_be_right ? "NOT PROVEN" : "REFUTED";
}

void writeStatement(const CertifyReport& report, std::ostringstream& text) {
  constexpr double kUp = 1.00001;  // so that six digits are not below
  text << "exact verification: " << verdict(report) << "\n"
       << "  regions " << report.regions << ", conditions of optimality " << report.rows
       << ", of them implied " << report.implied_rows << "\n"
       << "  facets " << report.facets << ": " << report.matched_facets << " shared with one region, "
       << report.covered_facets << " with several, " << report.edge_facets
       << " at the edge of the feasible set, " << report.domain_facets << " at that of the parameters\n"
       << "  greatest difference from the exact solution: law " << report.law_error << " (relative), plane "
       << report.plane_error << " (scaled)\n";
  if (report.beyond_facet > 0.0)
    text << "  beyond a facet, u of a look-up differs by at most " << kUp * report.beyond_facet
         << " from that of the region behind it\n";
  if (report.slivers > 0 || report.left_out_rows > 0)
    text << "  slivers that are left to the regions about them " << report.slivers
         << ", half-spaces left out " << report.left_out_rows << ": within " << report.plane_tolerance
         << " (scaled)\n";
  if (report.widened)
    text << "  coverage: by the regions moved outwards by " << report.plane_tolerance << " (scaled)\n";
  if (report.forgiven_rows > 0)
    text << "  rows that hold within 2^-40 of their size in a region: " << report.forgiven_rows << "\n";
  if (report.linear) text << "  linear program: of several optima the shortest\n";
  if (!report.implied_equalities.empty())
    text << "  rows that can only hold with equality: " << list(report.implied_equalities) << "\n";
  if (!report.dropped_equalities.empty())
    text << "  equalities that follow from others, or contradict them, by rounding only, proven to hold "
            "within "
            "2^-40 of their size: "
         << list(report.dropped_equalities) << "\n";
  if (!report.dropped_rows.empty())
    text << "  rows that others imply up to rounding, proven to hold within 2^-30 of their size: "
         << list(report.dropped_rows) << "\n";
}

}  // namespace

const char* toString(Defect::Kind kind) {
  switch (kind) {
    case Defect::Kind::kActiveSet:
      return "active set";
    case Defect::Kind::kRepeated:
      return "repeated";
    case Defect::Kind::kLowerDimensional:
      return "flat";
    case Defect::Kind::kPlane:
      return "plane";
    case Defect::Kind::kUnlisted:
      return "unlisted";
    case Defect::Kind::kLaw:
      return "law";
    case Defect::Kind::kGap:
      return "gap";
    case Defect::Kind::kUnbounded:
      return "unbounded";
    case Defect::Kind::kLookup:
      return "look-up";
  }
  return "unknown";
}

std::string certifyText(const CertifyReport& report) {
  std::ostringstream text;
  writeStatement(report, text);
  if (report.passed())
    text << "  not covered: where a look-up answers within the map's tolerance beyond "
         << (report.beyond_facet > 0.0 ? "several facets at once" : "facets")
         << ", how far u is off and theta is outside of the feasible set; --samples tries it\n";
  if (!report.defects.empty()) text << "  defects " << report.defects.size() << "\n";
  const auto unbounded = std::find_if(report.defects.begin(), report.defects.end(), [](const Defect& defect) {
    return defect.kind == Defect::Kind::kUnbounded;
  });
  if (unbounded != report.defects.end())
    text << "  no map answers all parameters that have solutions: proven that the cost is unbounded below at "
         << list(unbounded->witness) << "\n";
  for (std::size_t k = 0; k < report.defects.size() && k < kDefectsShown; ++k) {
    const Defect& defect = report.defects[k];
    text << "  - " << defect.text << "\n";
    if (!defect.missing.empty()) text << "    missing active set: " << list(defect.missing) << "\n";
    if (defect.witness.size() > 0) text << "    at " << list(defect.witness) << "\n";
  }
  if (report.defects.size() > kDefectsShown)
    text << "  and " << report.defects.size() - kDefectsShown << " more\n";
  return text.str();
}

std::string certifyJson(const CertifyReport& report) {
  nlohmann::ordered_json json;
  json["verdict"] = verdict(report);
  json["regions"] = report.regions;
  json["rows"] = report.rows;
  json["implied_rows"] = report.implied_rows;
  json["facets"] = report.facets;
  json["matched_facets"] = report.matched_facets;
  json["covered_facets"] = report.covered_facets;
  json["edge_facets"] = report.edge_facets;
  json["domain_facets"] = report.domain_facets;
  json["slivers"] = report.slivers;
  json["left_out_rows"] = report.left_out_rows;
  json["law_error"] = report.law_error;
  json["plane_error"] = report.plane_error;
  json["beyond_facet"] = report.beyond_facet;
  json["forgiven_rows"] = report.forgiven_rows;
  json["widened"] = report.widened;
  json["linear"] = report.linear;
  json["implied_equalities"] = report.implied_equalities;
  json["dropped_equalities"] = report.dropped_equalities;
  json["dropped_rows"] = report.dropped_rows;
  json["defects"] = nlohmann::ordered_json::array();
  for (const Defect& defect : report.defects) {
    nlohmann::ordered_json entry;
    entry["kind"] = toString(defect.kind);
    entry["region"] = defect.region;
    entry["row"] = defect.row;
    entry["size"] = defect.size;
    entry["witness"] = numbersOf(defect.witness);
    entry["missing"] = defect.missing;
    entry["text"] = defect.text;
    json["defects"].push_back(std::move(entry));
  }
  return json.dump(2) + "\n";
}

}  // namespace polyfly
