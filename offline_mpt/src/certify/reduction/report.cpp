#include <nlohmann/json.hpp>
#include <sstream>

#include "offline_mpt/verify_reduction.hpp"
#include "support/vector_text.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kShown = 10;  // defects in the text

const char* verdict(const ReductionReport& report) {
  if (report.interrupted) return "stopped before the end: nothing is proven";
  return report.passed() ? "PROVEN" : "REFUTED";
}

}  // namespace

std::string reductionText(const ReductionReport& report) {
  std::ostringstream out;
  out << "regions            " << report.reduced_regions << " for " << report.original_regions
      << " of the original\n"
      << "looked at          " << report.cells << " parts of regions, without rounding\n"
      << "within             " << report.slack << " of half a range of each half-space\n"
      << "laws               differ by at most " << report.law_error << " from those that they stand for\n";
  if (report.flat_regions > 0) out << "without interior   " << report.flat_regions << " regions\n";
  for (std::size_t i = 0; i < report.defects.size() && i < kShown; ++i) {
    const ReductionDefect& defect = report.defects[i];
    out << toString(defect.kind) << ": " << defect.text;
    if (defect.witness.size() > 0) out << ", at theta = " << vectorText(defect.witness);
    out << "\n";
  }
  if (report.defects.size() > kShown) out << "and " << report.defects.size() - kShown << " more\n";
  out << verdict(report) << "\n";
  return out.str();
}

std::string reductionJson(const ReductionReport& report) {
  nlohmann::ordered_json json;
  json["proven"] = report.passed();
  json["interrupted"] = report.interrupted;
  json["original_regions"] = report.original_regions;
  json["reduced_regions"] = report.reduced_regions;
  json["flat_regions"] = report.flat_regions;
  json["cells"] = report.cells;
  json["slack"] = report.slack;
  json["law_tolerance"] = report.law_tolerance;
  json["law_error"] = report.law_error;
  json["defects"] = nlohmann::ordered_json::array();
  for (const ReductionDefect& defect : report.defects) {
    json["defects"].push_back({{"kind", toString(defect.kind)},
                               {"region", defect.region},
                               {"witness", numbersOf(defect.witness)},
                               {"text", defect.text}});
  }
  return json.dump(2) + "\n";
}

}  // namespace polyfly
