// Maps and certificates that were forged together: what they state is false, and all checksums are right.
#include <cstring>

#include "core/map.hpp"
#include "error_of.hpp"
#include "mutation.hpp"
#include "region_maps/aligned_bytes.hpp"

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
  const Subject subject(program);
  return refusal(subject.certificate, bytesOf(subject.content), text);
}

/// Of the project's reader and the checker's own, how many refuse the map for the length of a plane.
int lengthRefusals(const std::string& bytes) {
  const bool by_checker = bool(holds(refusalOf([&] { checker::Map map(bytes); }), "another length than 1"));
  AlignedBytes aligned(bytes.size());
  std::memcpy(aligned.data(), bytes.data(), bytes.size());
  const bool by_reader = bool(holds(errorOf([&] { RegionMap::view(aligned.data(), bytes.size(), "forged"); }),
                                    "must have the length 1"));
  return by_checker + by_reader;
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
  const std::size_t at = text.find("\n" + key + " ") + 1;
  EXPECT_NE(at, 0u) << key;
  return text.substr(0, at) + line + text.substr(text.find('\n', at));
}

// Planes of length 1e-11 make half the box lie within the tolerance of every one of them.
TEST(Forgery, PlanesOfAnotherLengthAreRefused) {
  const ParametricProgram program = parseProgramJson(smallProblem(""), "test.json");
  const std::string map = bytesOf(solved(program));
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
  const Subject subject(program);
  const std::string map = bytesOf(subject.content);
  ASSERT_EQ(refusal(subject.certificate, map), "");
  std::string forged = withLine(subject.certificate, "H", "H 2 2 0x1p+0 0x0p+0 0x0p+0 0x0p+0");
  forged = withLine(forged, "f", "f 2 1 0x0p+0 0x0p+0");
  EXPECT_NE(refusal(sealed(forged, map), map), "");
}

// u = 1e6 theta - 1e12 is right in exact numbers. In doubles it is off by 1e-4, which is 1e-9 of the greatest u.
TEST(Forgery, TheRoundingOfALawCounts) {
  const ParametricProgram program = parseProgramJson(
      R"({"H": [[1]], "f": [1e12], "F": [[-1e6]], "A": [], "b": [], "B": [], "lb": [999999], "ub": [1000001]})",
      "test.json");
  const Subject subject(program);
  const std::string map = bytesOf(subject.content);
  EXPECT_EQ(refusal(subject.certificate, map), "");
  const std::string tight = withLine(subject.certificate, "tolerances", "tolerances 0x1p-34 0x1p-30");
  EXPECT_TRUE(holds(refusal(sealed(tight, map), map), "law"));
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
