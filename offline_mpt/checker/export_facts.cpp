#include <cstdlib>

#include "checksum.hpp"
#include "export_bound.hpp"
#include "lookup_work.hpp"

namespace checker {
namespace {

/// Where the value of a key of NAME.json begins.
std::size_t valueOf(const std::string& facts, const std::string& key) {
  const std::string quoted = "\"" + key + "\": ";
  const std::size_t found = facts.find(quoted);
  require(found != std::string::npos && facts.find(quoted, found + 1) == std::string::npos,
          "the facts must have '" + key + "' once");
  return found + quoted.size();
}

double numberAt(const std::string& facts, std::size_t& place) {
  const char* const begin = facts.c_str() + place;
  char* end = nullptr;
  const double value = std::strtod(begin, &end);
  require(end != begin && value >= 0.0, "a bound of the facts is no number");
  place += static_cast<std::size_t>(end - begin);
  return value;
}

void requireWord(const std::string& facts, const std::string& key, const std::string& word) {
  const std::string quoted = "\"" + word + "\"";
  require(facts.compare(valueOf(facts, key), quoted.size(), quoted) == 0,
          "the facts must have '" + key + "': " + word);
}

/// No look-up takes more operations than the facts state.
void confirmWork(const std::string& facts, const ExportedCode& code) {
  const std::size_t first = valueOf(facts, "worst_case");
  const std::string stated = facts.substr(first, facts.find('}', first) - first);
  const LookupWork work = greatestWork(code.tables);
  const auto confirm = [&stated](const std::string& key, std::uint64_t needed) {
    std::size_t place = valueOf(stated, key);
    require(numberAt(stated, place) >= static_cast<double>(needed),
            "a look-up may take more " + key + " than stated");
  };
  confirm("multiply_adds", work.sums * code.tables.p);
  confirm("comparisons", work.comparisons);
}

}  // namespace

void confirmExport(const std::string& facts, const std::string& code, const std::string& header,
                   const Map& map) {
  const ExportedCode exported = readCode(code);
  requireHeader(header, exported, map);
  requireWord(facts, "name", exported.name);
  requireWord(facts, "type", nameOf(exported.type));
  requireWord(facts, "map", "xxh64:" + hexText(map.checksum));
  requireWord(facts, "problem", "xxh64:" + hexText(xxh64(map.problem)));
  const ExportedAnswers proven = exportedAnswers(map, exported);
  require(proven.missing.empty(),
          "the code may have no answer where the map has region " +
              std::to_string(proven.missing.empty() ? 0 : proven.missing.begin()->second));
  std::size_t place = valueOf(facts, "error_bound") + 1;
  for (std::size_t j = 0; j < proven.error.size(); ++j) {
    require(numberAt(facts, place) >= proven.error[j],
            "the error of input " + std::to_string(j) + " may exceed its bound");
    require(facts.compare(place, 1, j + 1 == proven.error.size() ? "]" : ",") == 0,
            "the facts have another number of bounds than inputs");
    ++place;
  }
  place = valueOf(facts, "margin");
  require(numberAt(facts, place) >= proven.margin, "the margin may be exceeded");
  confirmWork(facts, exported);
}

}  // namespace checker
