// check_certificate --export: the text of the functions is the same for all maps, and no other text is confirmed.
#include <gtest/gtest.h>

#include <cctype>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "export_bound.hpp"
#include "exported_map.hpp"
#include "holds.hpp"
#include "map_export/export_map.hpp"
#include "refusal_of.hpp"
#include "synthetic_map.hpp"

namespace polyfly {
namespace {

/// A map of one law and no nodes, with so many parameters and inputs.
MapContent plainMap(std::uint32_t parameters, std::uint32_t inputs) {
  TreeRecipe recipe;
  recipe.parameters = parameters;
  recipe.inputs = inputs;
  recipe.regions = 2;
  recipe.leaf_regions = 2;
  recipe.seed = parameters;
  return makeTreeMap(recipe);
}

/// Exported files of a map, and what the checker says of them.
struct Exported {
  Exported(MapContent content, ExportType type) : made(std::move(content)), map(checkedMap(made)) {
    const ExportOptions options = optionsOf(type);
    source = exportSource(made.map, options);
    const checker::ExportedCode code = checker::readCode(source);
    const ExportBound bound = provenBound(checker::exportedAnswers(map, code), code);
    header = exportHeader(made.map, options, bound);
    facts = exportFacts(made.map, options, bound);
  }

  std::string verdict(const std::string& code, const std::string& declarations) const {
    return refusalOf([&] { checker::confirmExport(facts, code, declarations, map); });
  }
  std::string ofSource(const std::string& code) const { return verdict(code, header); }
  std::string ofHeader(const std::string& declarations) const { return verdict(source, declarations); }

  MadeMap made;
  checker::Map map;
  std::string source, header, facts;
};

TEST(ExportedText, OfEveryShapeIsConfirmed) {
  for (const ExportType type : {ExportType::kDouble, ExportType::kFloat}) {
    std::vector<MapContent> contents = {kinkedMap(), clippedMap(), plainMap(1, 1), plainMap(8, 2),
                                        plainMap(9, 3)};
    for (const MapContent& content : contents) {
      const Exported exported(content, type);
      EXPECT_EQ(exported.ofSource(exported.source), "") << content.parameters.size() << toString(type);
    }
  }
}

TEST(ExportedText, CommentsAndSpacesDoNotCount) {
  const Exported exported(kinkedMap(), ExportType::kDouble);
  EXPECT_EQ(exported.ofSource(replaced(exported.source, "u[j] = sum;", "u[j] /* the answer */\n  =   sum;")),
            "");
}

TEST(ExportedText, ChangedFunctionsAreRefused) {
  using Change = std::pair<const char*, const char*>;
  for (const ExportType type : {ExportType::kDouble, ExportType::kFloat}) {
    const Exported exported(kinkedMap(), type);
    std::vector<Change> changes = {{"u[j] = sum;", "u[j] = -sum;"},
                                   {"u[j] = sum;", ""},
                                   {"sum +=", "sum -="},
                                   {"status = CODE_OUTSIDE;\n        end", "end"},
                                   {"child -= NODE_COUNT;", "child = 0u;"},
                                   {"side = 0u;", "side = 1u;"},
                                   {"row & 1u", "row & 0u"},
                                   {"-distance : distance", "distance : -distance"},
                                   {"return status;\n}", "return CODE_OK;\n}"},
                                   {"static const", "static"},
                                   {"#include \"code.h\"", "#include \"other.h\""},
                                   {"law * INPUT_COUNT", "0u * INPUT_COUNT"}};
    for (const auto& [part, other] : changes)
      EXPECT_NE(exported.ofSource(replaced(exported.source, part, other)), "") << part << " -> " << other;
  }
}

TEST(ExportedText, WhatStandsAroundTheTablesIsRefused) {
  const Exported exported(kinkedMap(), ExportType::kDouble);
  const std::string law = "static const double code_law[";
  const std::string ending = "\n#endif\nstatic const double code_law[4][3] = {{1.0}};\n";
  const std::size_t first = exported.source.find(law);
  const std::size_t end = exported.source.find(';', first) + 1;
  const std::string table = exported.source.substr(first, end - first);
  EXPECT_NE(exported.ofSource(replaced(exported.source, table, "#if 0\n" + table + ending)), "");
  EXPECT_NE(exported.ofSource(replaced(exported.source, table, table + table)), "");
  EXPECT_NE(exported.ofSource(replaced(exported.source, table, "/* " + table + " */")), "");
  EXPECT_NE(exported.ofSource(replaced(exported.source, table, "// *\\\n" + table)), "");
  for (const char* const line :
       {"#define sum (-sum)", "#define double float", "#define CODE_REAL(e) (-(e))", "#undef ROOT", "#line 1",
        "#pragma STDC FP_CONTRACT ON", "_Pragma(\"STDC FP_CONTRACT ON\")", "%:define sum (-sum)",
        "?\?=define sum (-sum)", "int code_more;", ";", "/* *\\\n/ #define sum (-sum)\n/* */",
        "/* *?\?/\n/ #define sum (-sum)\n/* */", "#define sum /*\n*/ (-sum)", "#include <stdlib.h>", "\f",
        "\r", "$law", "@n@"}) {
    const std::string own = "\n" + std::string(line) + "\n";
    EXPECT_NE(exported.ofSource(replaced(exported.source, "\n" + law, own + law)), "") << line;
    EXPECT_NE(exported.ofSource(own + exported.source), "") << line;
    EXPECT_NE(exported.ofSource(exported.source + own), "") << line;
    EXPECT_NE(
        exported.ofHeader(replaced(exported.header, "#include <stdint.h>", "#include <stdint.h>" + own)), "")
        << line;
  }
}

TEST(ExportedText, NumbersThatACompilerReadsOtherwiseAreRefused) {
  const Exported exported(kinkedMap(), ExportType::kDouble);
  for (const auto& [part, other] :
       std::vector<std::pair<const char*, const char*>>{{"{0.5,", "{5e-1f,"},
                                                        {"{0.5,", "{(0.5),"},
                                                        {"{0.5,", "{0.5 + 1.0,"},
                                                        {"{0.5,", "{0.5L,"},
                                                        {"{0.5,", "{sum,"},
                                                        {"{0.5,", "{+0.5,"},
                                                        {"{0.5,", "{0.5 0.5,"},
                                                        {"REGION_COUNT 4u", "REGION_COUNT 04u"},
                                                        {"REGION_COUNT 4u", "REGION_COUNT 4"},
                                                        {"REGION_COUNT 4u", "REGION_COUNT 5u"},
                                                        {"REGION_COUNT 4u", "REGION_COUNT 4u + 0u"},
                                                        {"NODE_COUNT 1u", "NODE_COUNT 01u"},
                                                        {"code_law[4]", "code_law[5]"},
                                                        {"uint8_t code_row[", "uint16_t code_row["},
                                                        {"uint8_t code_row[", "int8_t code_row["}})
    EXPECT_NE(exported.ofSource(replaced(exported.source, part, other)), "") << part << " -> " << other;
}

TEST(ExportedText, ChangedHeadersAreRefused) {
  const Exported exported(kinkedMap(), ExportType::kFloat);
  EXPECT_EQ(exported.ofHeader(exported.header), "");
  for (const auto& [part, other] : std::vector<std::pair<const char*, const char*>>{
           {"CODE_OK = 0", "CODE_OK = 1"},
           {"_MAP \"xxh64:", "_MAP \"xxh64:0"},
           {"CODE_REGIONS 4", "CODE_REGIONS 5"},
           {"const float theta[2]", "const double theta[2]"},
           {"_VERSION \"", "_VERSION \"\" CODE_VERSION \""},
           {"#include <stdint.h>", "#include <stdint.h>\n#define float double"}})
    EXPECT_NE(exported.ofHeader(replaced(exported.header, part, other)), "") << part;
}

/// The text without comments, spaces and line feeds. Numbers are in one form, unless a zero leads them.
std::string bare(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool in_word = !result.empty() && (std::isalnum(static_cast<unsigned char>(result.back())) != 0 ||
                                             result.back() == '_');
    const bool is_digit = std::isdigit(static_cast<unsigned char>(text[i])) != 0;
    const bool is_octal =
        text[i] == '0' && i + 1 < text.size() && std::isdigit(static_cast<unsigned char>(text[i + 1])) != 0;
    if (text.compare(i, 2, "/*") == 0) {
      const std::size_t end = text.find("*/", i + 2);
      if (end == std::string::npos) return result;
      i = end + 1;
    } else if (is_digit && !in_word && !is_octal) {
      char* rest = nullptr;
      char number[40];
      std::snprintf(number, sizeof number, "%.17g", std::strtod(text.c_str() + i, &rest));
      result += number;
      i = static_cast<std::size_t>(rest - text.c_str()) - 1;
    } else if (text[i] != ' ' && text[i] != '\n') {
      result += text[i];
    }
  }
  return result;
}

// Code of doubles has the map's numbers, so no change outside of comments and spaces may be confirmed.
TEST(ExportedText, BytesOutsideOfCommentsCount) {
  const std::string letters = std::string("09aeuLX_+-*/%=<>!&|^~()[]{};:,.#?\"'\\ \n\t\r$@\x80", 44);
  std::mt19937 random(3);
  const Exported exported(clippedMap(), ExportType::kDouble);
  const std::string& source = exported.source;
  const std::string& header = exported.header;
  std::size_t refused = 0;
  for (std::size_t i = 0; i < source.size() + header.size(); i += 1 + random() % 6) {
    const bool in_source = i < source.size();
    const std::string& text = in_source ? source : header;
    const std::size_t place = in_source ? i : i - source.size();
    std::string changed = text;
    switch (random() % 3) {
      case 0:
        changed.erase(place, 1);
        break;
      case 1:
        changed.insert(place, 1, letters[random() % letters.size()]);
        break;
      default:
        changed[place] = letters[random() % letters.size()];
    }
    const bool is_confirmed = (in_source ? exported.ofSource(changed) : exported.ofHeader(changed)) == "";
    refused += is_confirmed ? 0 : 1;
    // Of the header's version string only letters count.
    if (is_confirmed && bare(changed) != bare(text)) {
      const std::size_t line = text.rfind('\n', place) + 1;
      EXPECT_EQ(text.compare(line, 21, "#define CODE_VERSION "), 0)
          << place << ": " << text.substr(line, text.find('\n', line) - line) << " -> "
          << changed.substr(line, 90);
    }
  }
  EXPECT_GT(refused, source.size() / 10);
}

}  // namespace
}  // namespace polyfly
