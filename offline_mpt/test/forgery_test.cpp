// Maps and certificates that were forged together: what they state is false, and all checksums are right.
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "core/map.hpp"
#include "map_in_memory.hpp"
#include "mutation.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/write_file.hpp"

namespace polyfly {
namespace {

/// min |z|^2 / 2 with |z| <= 2, and what `ending` adds.
std::string smallProblem(const std::string& ending) {
  return R"({"H": [[1, 0], [0, 1]], "f": [0, 0], "F": [[1, 0], [0, 1]],
    "A": [[1, 0], [-1, 0], [0, 1], [0, -1]], "b": [2, 2, 2, 2], "B": [[0, 0], [0, 0], [0, 0], [0, 0]],
    "lb": [-3, -3], "ub": [3, 3])" +
         ending + "}";
}

/// Why a map and a certificate are refused that are right for `program`, but carry another text.
std::string refusalOfLiar(ParametricProgram program, const std::string& text) {
  program.text = text;
  program.text_kind = "json";
  const MapContent content = encode(program, explore(program));
  const CertifyReport report = certify(MapInMemory(content).map(), program);
  EXPECT_TRUE(report.passed()) << certifyText(report);
  return refusal(report.certificate, bytesOf(content), text);
}

/// Of the project's reader and the checker's own, how many refuse the map for the length of a plane.
int lengthRefusals(const std::string& bytes) {
  int refusals = 0;
  try {
    checker::Map map(bytes);
  } catch (const checker::Refused& refused) {
    refusals += std::string(refused.what()).find("another length than 1") != std::string::npos ? 1 : 0;
  }
  const std::string path = testing::TempDir() + "forged_length.map";
  writeFileAtomically(
      path, std::vector<std::byte>(reinterpret_cast<const std::byte*>(bytes.data()),
                                   reinterpret_cast<const std::byte*>(bytes.data()) + bytes.size()));
  try {
    RegionMap::open(path);
  } catch (const Error& error) {
    refusals += std::string(error.what()).find("must have the length 1") != std::string::npos ? 1 : 0;
  }
  std::remove(path.c_str());
  return refusals;
}

// Such a problem has u = z, or some entries of z. A certificate with another C or c is of another problem.
TEST(Forgery, AnOutputByPlaceAddsNothing) {
  for (const char* const ending : {R"(, "out": [0])", ""}) {
    const std::string text = smallProblem(ending);
    const ParametricProgram program = parseProgramJson(text, "test.json");
    EXPECT_EQ(refusalOfLiar(program, text), "");
    ParametricProgram shifted = program;
    shifted.C(0, 1) = 0.25;
    EXPECT_NE(refusalOfLiar(shifted, text), "");
    shifted = program;
    shifted.c(0) = 0.25;
    EXPECT_NE(refusalOfLiar(shifted, text), "");
  }
}

// A reader of JSON sees other numbers than those behind the first such key.
TEST(Forgery, KeysThatReadTwoWaysAreRefused) {
  const ParametricProgram program = parseProgramJson(smallProblem(""), "test.json");
  EXPECT_NE(refusalOfLiar(program, smallProblem(R"(, "\u0048": [[2, 0], [0, 2]])")), "");
  EXPECT_NE(refusalOfLiar(program, smallProblem(R"(, "H": [])")), "");
}

/// The text with one line in the place of that which starts with `key`.
std::string withLine(const std::string& text, const std::string& key, const std::string& line) {
  std::vector<std::string> lines = linesOf(text);
  bool found = false;
  for (std::string& old : lines) {
    if (old.compare(0, key.size() + 1, key + " ") != 0) continue;
    old = line;
    found = true;
  }
  EXPECT_TRUE(found) << key;
  return joined(lines, "\n") + "\n";
}

// Planes of length 1e-11 make half the box lie within the tolerance of every one of them.
TEST(Forgery, PlanesOfAnotherLengthAreRefused) {
  const ParametricProgram program = parseProgramJson(smallProblem(""), "test.json");
  const std::string map = bytesOf(encode(program, explore(program)));
  const auto confirmed = [&](double factor) { return lengthRefusals(withScaledPlanes(map, factor)) == 0; };
  EXPECT_TRUE(confirmed(1.0));
  EXPECT_TRUE(confirmed(1.0 + 0x1p-41));
  for (const double factor : {1e-11, 0.5, 1.0 - 0x1p-39, 1.0 + 0x1p-39, -2.0, 1e300})
    EXPECT_EQ(lengthRefusals(withScaledPlanes(map, factor)), 2) << factor;
}

// z_1 of min z_0^2 / 2 may be anything up to theta; the system of the bound is regular all the same.
TEST(Forgery, AMinimiserThatIsNotUniqueIsRefused) {
  ParametricProgram program = parseProgramJson(
      R"({"H": [[1, 0], [0, 1]], "f": [0, -3], "F": [[0], [0]], "A": [[0, 1], [0, -1]], "b": [0, 5],
          "B": [[1], [0]], "lb": [-1], "ub": [1], "out": [1]})",
      "test.json");
  const MapContent content = encode(program, explore(program));
  const CertifyReport report = certify(MapInMemory(content).map(), program);
  const std::string map = bytesOf(content);
  ASSERT_EQ(refusal(report.certificate, map), "");
  std::string forged = withLine(report.certificate, "H", "H 2 2 0x1p+0 0x0p+0 0x0p+0 0x0p+0");
  forged = withLine(forged, "f", "f 2 1 0x0p+0 0x0p+0");
  EXPECT_NE(refusal(sealed(forged, map), map), "");
}

// u = 1e6 theta - 1e12 is right in exact numbers. In doubles it is off by 1e-4, which is 1e-9 of the greatest u.
TEST(Forgery, TheRoundingOfALawCounts) {
  const ParametricProgram program = parseProgramJson(
      R"({"H": [[1]], "f": [1e12], "F": [[-1e6]], "A": [], "b": [], "B": [], "lb": [999999], "ub": [1000001]})",
      "test.json");
  const MapContent content = encode(program, explore(program));
  const CertifyReport report = certify(MapInMemory(content).map(), program);
  ASSERT_TRUE(report.passed()) << certifyText(report);
  const std::string map = bytesOf(content);
  EXPECT_EQ(refusal(report.certificate, map), "");
  const std::string tight = withLine(report.certificate, "tolerances", "tolerances 0x1p-34 0x1p-30");
  EXPECT_NE(refusal(sealed(tight, map), map).find("law"), std::string::npos);
}

// Read before the basis is judged.
TEST_F(Mutation, ABasisOfRowsThatAreNotThereIsRefused) {
  const std::string forged = withLine(certificate_, "basis", "basis 1 99999999");
  EXPECT_NE(refusal(sealed(forged, map_), map_), "");
}

// A positive definite H would count as singular, and its numbers as others.
TEST_F(Mutation, LinesThatMakeHSingularAreRefused) {
  EXPECT_NE(refusal(sealed(withLine(certificate_, "convexity", "convexity singular 0x0p+0"), map_), map_),
            "");
  const std::string counts = withLine(certificate_, "coverage", "coverage exact\ncounts H 0 0 1");
  EXPECT_NE(refusal(sealed(counts, map_), map_), "");
  const std::string bound = withLine(certificate_, "coverage", "coverage exact\ncounts b 0 0 1");
  EXPECT_NE(refusal(sealed(bound, map_), map_), "");
}

}  // namespace
}  // namespace polyfly
