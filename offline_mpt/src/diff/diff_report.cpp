#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>

#include "offline_mpt/diff.hpp"
#include "support/vector_text.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kShownDifferences = 10;  // differences in the text

std::string differenceText(const LawDifference& difference) {
  char size[32];
  std::snprintf(size, sizeof size, "%.6g", difference.size);
  std::string text = size;
  if (difference.theta.size() > 0) {
    text += " between regions " + std::to_string(difference.first_region) + " and " +
            std::to_string(difference.second_region) + ", at theta = " + vectorText(difference.theta);
  }
  return text;
}

std::string coverText(const char* map, const char* other, const MapCover& cover) {
  if (cover.covers) return std::string(map) + " answers wherever the " + other + " does\n";
  return std::string(map) + " has no answer at theta = " + vectorText(cover.witness) + ", in region " +
         std::to_string(cover.region) + " of the " + other + "\n";
}

nlohmann::ordered_json differenceJson(const LawDifference& difference,
                                      const std::vector<std::string>& inputs) {
  nlohmann::ordered_json json;
  json["input"] = inputs[static_cast<std::size_t>(difference.input)];
  json["size"] = difference.size;
  if (difference.theta.size() == 0) return json;
  json["first_region"] = difference.first_region;
  json["second_region"] = difference.second_region;
  json["theta"] = numbersOf(difference.theta);
  return json;
}

nlohmann::ordered_json coverJson(const MapCover& cover) {
  nlohmann::ordered_json json;
  json["covers"] = cover.covers;
  if (cover.covers) return json;
  json["region"] = cover.region;
  json["theta"] = numbersOf(cover.witness);
  return json;
}

}  // namespace

std::string diffText(const DiffReport& report, const std::vector<std::string>& inputs) {
  std::ostringstream out;
  out << "regions     " << report.first_regions << " and " << report.second_regions << ", " << report.pairs
      << " pairs meet\n";
  for (const LawDifference& greatest : report.greatest) {
    out << "greatest    " << inputs[static_cast<std::size_t>(greatest.input)] << ": "
        << differenceText(greatest) << "\n";
  }
  out << "different   " << report.different_pairs << " pairs by more than " << report.tolerance << "\n";
  for (std::size_t i = 0; i < report.differences.size() && i < kShownDifferences; ++i) {
    const LawDifference& difference = report.differences[i];
    out << "            " << inputs[static_cast<std::size_t>(difference.input)] << ": "
        << differenceText(difference) << "\n";
  }
  if (report.differences.size() > kShownDifferences)
    out << "            and " << report.differences.size() - kShownDifferences << " more\n";
  out << coverText("first map  ", "second", report.first_covers_second)
      << coverText("second map ", "first", report.second_covers_first)
      << (report.interrupted ? "stopped before the end"
          : report.same()    ? "the same answers"
                             : "different answers")
      << "\n";
  return out.str();
}

std::string diffJson(const DiffReport& report, const std::vector<std::string>& inputs) {
  nlohmann::ordered_json json;
  json["same"] = report.same();
  json["interrupted"] = report.interrupted;
  json["first_regions"] = report.first_regions;
  json["second_regions"] = report.second_regions;
  json["pairs"] = report.pairs;
  json["different_pairs"] = report.different_pairs;
  json["tolerance"] = report.tolerance;
  json["greatest"] = nlohmann::ordered_json::array();
  for (const LawDifference& greatest : report.greatest)
    json["greatest"].push_back(differenceJson(greatest, inputs));
  json["differences"] = nlohmann::ordered_json::array();
  for (const LawDifference& one : report.differences)
    json["differences"].push_back(differenceJson(one, inputs));
  json["first_covers_second"] = coverJson(report.first_covers_second);
  json["second_covers_first"] = coverJson(report.second_covers_first);
  return json.dump(2) + "\n";
}

}  // namespace polyfly
