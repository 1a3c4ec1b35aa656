#include "map_explorer/explorer_page.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "error_of.hpp"
#include "synthetic_map.hpp"

namespace polyfly {
namespace {

// What a page may take beside the map, which base64 makes a third longer.
constexpr std::size_t kLargestPage = 200'000;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(Base64, AgreesWithTheExamplesOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\xff\x00\xfe", 3)), "/wD+");
}

TEST(ExplorerPage, HoldsTheMapAndLittleElse) {
  const MadeMap made(makeTreeMap({}));
  const std::string page = explorerPage(made.map, {});
  const std::string map_text = base64(made.map.file());
  EXPECT_EQ(count(page, map_text), 1u);
  EXPECT_LT(page.size() - map_text.size(), kLargestPage);
  EXPECT_EQ(page, explorerPage(made.map, {}));
}

TEST(ExplorerPage, AllowsNoNetworkAndNoOtherScript) {
  const MadeMap made(makeTreeMap({}));
  const std::string page = explorerPage(made.map, {});
  EXPECT_NE(page.find("default-src 'none'; script-src 'sha256-"), std::string::npos);
  EXPECT_EQ(page.find("unsafe-"), std::string::npos);
  EXPECT_EQ(count(page, "@FACTS@") + count(page, "@MAP@") + count(page, "@SCRIPT"), 0u);
}

TEST(ExplorerPage, TextsCannotEndTheElementThatHoldsThem) {
  const std::string hostile = "</script><script>alert(1)</script><!-- @MAP@ \xff \"'&";
  const MadeMap made(makeTreeMap({}));
  ExplorerContent content;
  content.no_model = hostile;
  content.constraints = {hostile};
  content.flight = ExplorerFlight{hostile, {0.0}, {0.0, 0.0, 0.0}};
  const std::string plain = explorerPage(made.map, {});
  const std::string page = explorerPage(made.map, content);
  EXPECT_EQ(count(page, "<script"), count(plain, "<script"));
  EXPECT_EQ(count(page, "</script"), count(plain, "</script"));
  EXPECT_EQ(count(page, "<!--"), 0u);
  EXPECT_EQ(count(page, base64(made.map.file())), 1u);
}

TEST(ExplorerPage, RefusesContentOfAnotherMap) {
  const MadeMap made(makeTreeMap({}));
  ExplorerContent content;
  content.flight = ExplorerFlight{"samples", {0.0, 1.0}, {0.0, 0.0, 0.0}};
  EXPECT_NE(
      errorOf([&] { explorerPage(made.map, content); }).find("flight.thetas: must have 6 numbers, got 3"),
      std::string::npos);
  content.flight = ExplorerFlight{"samples", {std::numeric_limits<double>::quiet_NaN()}, {0.0, 0.0, 0.0}};
  EXPECT_NE(errorOf([&] { explorerPage(made.map, content); }).find("flight.times: must be finite"),
            std::string::npos);
  content = {};
  content.program.emplace();
  EXPECT_NE(errorOf([&] { explorerPage(made.map, content); }).find("lacks rows that are active in region"),
            std::string::npos);
}

}  // namespace
}  // namespace polyfly
