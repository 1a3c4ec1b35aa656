#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "polytope_sets/analyze_map.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

using Json = nlohmann::ordered_json;

std::string number(double value, const char* format = "%.17g") {
  char text[40];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::vector<double> doubles(const RationalVector& values) {
  std::vector<double> result;
  for (const Rational& value : values) result.push_back(nearestDouble(value));
  return result;
}

// "2 e_p - 0.5 e_v <= 3"
std::string facetText(const ExactHalfSpace& facet, const RegionMap& map) {
  std::string text;
  for (std::size_t j = 0; j < facet.a.size(); ++j) {
    const double value = facet.a[j].get_d();
    if (value == 0.0) continue;
    text += text.empty() ? (value < 0.0 ? "-" : "") : (value < 0.0 ? " - " : " + ");
    if (std::abs(value) != 1.0) text += number(std::abs(value), "%.9g") + " ";
    text += map.parameters()[j].name;
  }
  return (text.empty() ? "0" : text) + " <= " + number(facet.b.get_d(), "%.9g");
}

template <typename Signals>
std::string values(const Signals& signals, const std::vector<double>& numbers) {
  std::string text;
  for (std::size_t j = 0; j < numbers.size(); ++j)
    text += (j == 0 ? "" : ", ") + signals[j].name + " = " + number(numbers[j]);
  return text;
}

std::string witnessText(const AnalyzeReport& report, const RegionMap& map, const SetModel& model) {
  const AnalyzeWitness& witness = *report.witness;
  std::string text = "witness, region " + std::to_string(witness.region) + "\n";
  text += "  theta      " + values(map.parameters(), witness.theta) + "\n";
  text += "  u          " + values(map.inputs(), witness.u) + "\n";
  if (!witness.d.empty()) text += "  d          " + values(model.disturbances, doubles(witness.d)) + "\n";
  text += "  successor  " + values(map.parameters(), doubles(witness.successor)) + "\n";
  text += "  breaks     " + facetText(witness.facet, map) + "  by " + number(witness.excess, "%.6g") +
          " [scaled]\n";
  text += std::string("  evaluated  ") +
          (witness.verified ? "again from these numbers: it leaves" : "not confirmed from rounded numbers") +
          "; the map " + (witness.successor_outside ? "has no answer" : "still answers") +
          " at the successor" + (report.is_within ? ", or it lies outside of the set" : "") + "\n";
  return text;
}

std::string coverText(const AnalyzeReport& report, const RegionMap& map) {
  const std::string set = report.is_within ? "set" : "domain";
  std::string text = set + "\n";
  text += "  half-spaces         " + std::to_string(report.domain.size()) + "\n";
  if (report.covered) {
    text += "  covered by regions  proven\n";
    if (!report.is_within)
      text += "  convex              proven: no region reaches farther out than " +
              number(report.region_excess, "%.3g") + " [scaled]\n";
  } else {
    text += "  covered by regions  NO";
    if (report.gap) text += ": in no region is " + values(map.parameters(), doubles(*report.gap));
    text += "\n";
  }
  return text;
}

Json witnessJson(const AnalyzeReport& report, const RegionMap& map) {
  const AnalyzeWitness& witness = *report.witness;
  Json json;
  json["region"] = witness.region;
  json["theta"] = witness.theta;
  json["u"] = witness.u;
  json["d"] = doubles(witness.d);
  json["successor"] = doubles(witness.successor);
  json["successor_exact"] = Json::array();
  for (const Rational& value : witness.successor) json["successor_exact"].push_back(value.get_str());
  json["facet"] = facetText(witness.facet, map);
  json["excess"] = witness.excess;
  json["verified"] = witness.verified;
  json["successor_outside"] = witness.successor_outside;
  return json;
}

}  // namespace

std::string analyzeText(const AnalyzeReport& report, const RegionMap& map, const SetModel& model) {
  std::string text = map.path() + ", model " + model.name + "\n";
  text += "regions               " + std::to_string(report.regions);
  text += "\ntolerance             " + number(report.tolerance, "%.3g") + " [scaled]\n";
  text += coverText(report, map);
  const bool both = report.successors_inside && report.covered;
  const bool is_tested = report.covered || report.is_within;
  text += std::string("recursive feasibility ") + (both                       ? "HOLDS: "
                                                   : !is_tested               ? "NOT TESTED: "
                                                   : report.successors_inside ? "of what the regions hold: "
                                                                              : "FAILS: ");
  if (!is_tested) {
    text += "the regions do not cover the domain";
  } else if (report.successors_inside) {
    text += "every successor lies in the ";
    text += report.is_within ? "set" : "domain";
    if (report.greatest_excess > 0.0)
      text += ", up to " + number(report.greatest_excess, "%.3g") + " [scaled]";
  } else {
    text += std::to_string(report.offending_regions) + " of " + std::to_string(report.regions) +
            " regions have successors outside";
  }
  const std::string set = report.is_within ? "the set" : "the domain";
  text += "\ninvariance            ";
  if (both) {
    text += "HOLDS: " + set + " is positively invariant for all disturbances\n";
  } else {
    text += "FAILS: " + set + (report.witness ? " is left\n" : " is not known as a whole\n");
  }
  if (report.witness) text += witnessText(report, map, model);
  return text;
}

std::string analyzeJson(const AnalyzeReport& report, const RegionMap& map, const SetModel& model) {
  Json json;
  json["map"] = map.path();
  json["model"] = model.name;
  json["holds"] = report.holds();
  json["tolerance"] = report.tolerance;
  json["regions"] = report.regions;
  json["target"] = report.is_within ? "set" : "domain";
  json["half_spaces"] = Json::array();
  for (const ExactHalfSpace& facet : report.domain) json["half_spaces"].push_back(facetText(facet, map));
  json["covered"] = report.covered;
  json["region_excess"] = report.region_excess;
  json["gap"] = report.gap ? Json(doubles(*report.gap)) : Json();
  json["successors_inside"] = report.successors_inside;
  json["greatest_excess"] = report.greatest_excess;
  json["offending_regions"] = report.offending_regions;
  json["witness"] = report.witness ? witnessJson(report, map) : Json();
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace polyfly
