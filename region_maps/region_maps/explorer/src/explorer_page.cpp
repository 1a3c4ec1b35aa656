#include "map_explorer/explorer_page.hpp"

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "page_template.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

using Json = nlohmann::ordered_json;

/// The numbers' own bytes: the page reads them as they are.
std::string numbersText(const std::vector<double>& numbers) {
  return base64({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)});
}

/// A map may name rows that the program in its text lacks.
void checkActiveRows(const RegionMap& map, const ExplorerProgram& program) {
  for (std::size_t i = 0; i < map.regionCount(); ++i) {
    const RegionView region = map.region(i);
    for (std::uint32_t k = 0; k < region.active_count; ++k) {
      if (static_cast<std::size_t>(region.active[k]) >= program.b.size())
        throw Error(map.path() + ": program: lacks rows that are active in region " + std::to_string(i));
    }
  }
}

Json modelJson(const ExplorerModel& model) {
  Json json = {{"period", model.period}, {"input_count", model.input_count},
               {"A", model.A},           {"B", model.B},
               {"U", model.U},           {"G", model.G}};
  json["states"] = Json::array();
  for (const std::size_t parameter : model.errors) json["states"].push_back({{"parameter", parameter}});
  json["previous"] = Json::array();
  for (const ExplorerModel::PreviousInput& previous : model.previous_inputs)
    json["previous"].push_back({{"parameter", previous.parameter}, {"input", previous.input}});
  json["disturbances"] = Json::array();
  for (const Signal& signal : model.disturbances) {
    json["disturbances"].push_back(
        {{"name", signal.name}, {"unit", signal.unit}, {"lower", signal.lower}, {"upper", signal.upper}});
  }
  return json;
}

Json programJson(const ExplorerProgram& program) {
  return {{"variables", program.variables},   {"equalities", program.equalities},
          {"H", numbersText(program.H)},      {"f", numbersText(program.f)},
          {"F", numbersText(program.F)},      {"A", numbersText(program.A)},
          {"b", numbersText(program.b)},      {"S", numbersText(program.S)},
          {"rest", numbersText(program.rest)}};
}

Json factsJson(const RegionMap& map, const ExplorerContent& content) {
  Json json = {
      {"no_model", content.no_model}, {"no_cost", content.no_cost}, {"constraints", content.constraints}};
  if (content.model) json["model"] = modelJson(*content.model);
  if (content.program) {
    checkActiveRows(map, *content.program);
    json["program"] = programJson(*content.program);
  }
  if (content.flight) {
    const ExplorerFlight& flight = *content.flight;
    const std::size_t expected = flight.times.size() * map.parameters().size();
    if (flight.thetas.size() != expected) {
      throw Error(map.path() + ": flight.thetas: must have " + std::to_string(expected) + " numbers, got " +
                  std::to_string(flight.thetas.size()));
    }
    for (const double time : flight.times)
      if (!std::isfinite(time)) throw Error(map.path() + ": flight.times: must be finite");
    json["flight"] = {{"source", flight.source},
                      {"time", numbersText(flight.times)},
                      {"theta", numbersText(flight.thetas)}};
  }
  return json;
}

/// JSON inside of a script element: a '<' could end the element. In JSON it occurs in strings only.
std::string scriptText(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char letter : text) {
    if (letter == '<') {
      safe += "\\u003c";
    } else {
      safe += letter;
    }
  }
  return safe;
}

}  // namespace

std::string base64(std::string_view bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return k < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[k])) : 0u;
    };
    const std::uint32_t group = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    text += kDigits[group >> 18];
    text += kDigits[group >> 12 & 63];
    text += i + 1 < bytes.size() ? kDigits[group >> 6 & 63] : '=';
    text += i + 2 < bytes.size() ? kDigits[group & 63] : '=';
  }
  return text;
}

std::string explorerPage(const RegionMap& map, const ExplorerContent& content) {
  const std::string facts = scriptText(factsJson(map, content));
  std::string page;
  for (const std::string_view piece : kPageTemplate) {
    page += piece;
  }
  constexpr std::string_view kFacts = "@FACTS@";
  constexpr std::string_view kMap = "@MAP@";
  // Both marks are placed before anything is put in: a name may contain one.
  const std::size_t facts_at = page.find(kFacts);
  const std::size_t map_at = page.find(kMap);
  std::string result = page.substr(0, facts_at);
  result += facts;
  result.append(page, facts_at + kFacts.size(), map_at - facts_at - kFacts.size());
  result += base64(map.file());
  result.append(page, map_at + kMap.size());
  return result;
}

}  // namespace polyfly
