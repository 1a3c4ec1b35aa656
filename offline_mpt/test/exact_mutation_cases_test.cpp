// Certificates with slivers and relaxed rows, every bit of a small one, and what the checker reads beside it.
#include <algorithm>
#include <cctype>
#include <cstring>

#include "checksum.hpp"
#include "core/certificate.hpp"
#include "json_problem.hpp"
#include "mutation.hpp"
#include "polyfly_base/error.hpp"
#include "random_program.hpp"
#include "robust/read_map_certificate.hpp"

namespace polyfly {
namespace {

/// A map that leaves slivers to the regions about them.
class SliverMutation : public Mutation {
 protected:
  SliverMutation() : Mutation(once([] { return nearlyDependent(1e-5, 3); })) {}
};

TEST_F(SliverMutation, NothingChangedIsConfirmed) {
  EXPECT_EQ(refusal(certificate_, map_), "");
  for (const char* line : {"\nsliver_region ", "\nsliver_cover N "}) EXPECT_TRUE(holds(certificate_, line));
}

TEST_F(SliverMutation, ASliverIsDescribedByItsActiveSet) {
  const auto shorten = [](Words& words) {
    words[1] = std::to_string(words.size() - 3);
    words.pop_back();
    return true;
  };
  const auto setLast = [](Words& words) {
    words.back() = "12";
    return true;
  };
  expectRefused("sliver_region", shorten);
  expectRefused("sliver_region", setLast);
}

TEST_F(SliverMutation, ASliverMustLieInRegionsOfTheMap) {
  const std::size_t count = content_.regions.size();
  expectRefused("sliver_cover", replacing({"sliver_cover", "e", "1", "0", "1"}));
  expectRefused("sliver_cover", setting(2, std::to_string(count)));
  expectRefused("sliver_cover", stepping(2, count / 2, count));
}

TEST_F(SliverMutation, ATighterToleranceIsRefused) { expectRefused("tolerances", setting(2, "0x1p-60")); }

/// The law tolerance that a certificate states.
double statedLaw(const std::string& certificate) {
  const std::string key = "\ntolerances ";
  return std::stod(certificate.substr(certificate.find(key) + key.size()));
}

// 1e-10 where the laws keep to it, else 1e-8; the checker confirms either.
TEST_F(SliverMutation, TheLawToleranceIsAsTightAsTheLaws) {
  EXPECT_EQ(statedLaw(certificate_), 1e-10);
  MapContent coarse = content_;
  coarse.laws.front() += 1e-9;
  EXPECT_NE(refusalOfMap(coarse), "");
  const std::string certificate = certified(coarse, program_).certificate;
  EXPECT_EQ(statedLaw(certificate), 1e-8);
  EXPECT_EQ(refusal(certificate, bytesOf(coarse)), "");
}

/// What the checker bounds beyond a facet; 0 where it says nothing.
double checkedBeyondFacet(const std::string& certificate, const std::string& map_bytes) {
  const checker::Map map(map_bytes);
  const auto proof = checker::readMapCertificate(certificate, map);
  proof->check();
  const std::string words = "beyond a facet, u differs by at most ", text = proof->conditions();
  const std::size_t at = text.find(words);
  return at == std::string::npos ? 0.0 : std::stod(text.substr(at + words.size()));
}

// The law of a sliver is not in the map, and no bound knows it.
TEST_F(SliverMutation, NothingIsStatedBeyondFacets) {
  const CertifyReport report = certified(content_, program_);
  ASSERT_GT(report.slivers, 0u);
  EXPECT_EQ(report.beyond_facet, 0.0);
  EXPECT_EQ(checkedBeyondFacet(certificate_, map_), 0.0);
}

TEST_F(Mutation, TheCheckerBoundsUBeyondAFacetAsTheProverDoes) {
  const double stated = certified(content_, program_).beyond_facet;
  ASSERT_GT(stated, 0.0);
  EXPECT_GE(checkedBeyondFacet(certificate_, map_), stated);
  EXPECT_LE(checkedBeyondFacet(certificate_, map_), 1.012 * stated);
}

// With tolerances of a forger's choice, any law would be confirmed.
TEST_F(SliverMutation, TolerancesHaveLimits) {
  for (const char* law : {"0x1p0", "0x1p-19", "-0x1p-60"}) expectRefused("tolerances", setting(1, law));
  // The map's tolerance is 1e-8.
  for (const char* plane : {"0x1p0", "0x1p-27", "-0x1p-60"}) expectRefused("tolerances", setting(2, plane));
}

TEST_F(SliverMutation, LinesOfTheHeadAreThereOnce) {
  for (const char* key :
       {"map", "problem", "tolerances", "equalities", "basis", "convexity", "coverage", "regions"}) {
    expectRefused(key, leavingOut());
    expectRefused(key, repeating());
  }
}

TEST_F(SliverMutation, NoSliverMayBeMissing) {
  const std::size_t first = certificate_.find("\nsliver_region ");
  std::string without = certificate_;
  without.erase(first + 1, without.rfind("\nend ") - first);
  EXPECT_NE(refusal(sealed(without, map_), map_), "");
}

/// Confirms without any extension. Empty, or why not.
std::string refusalOfCore(const std::string& certificate, const std::string& map) {
  return refusalOf([&] {
    const checker::Map content(map);
    checker::Certificate core(content);
    core.read(certificate);
    core.check();
  });
}

TEST_F(Mutation, TheCoreAloneConfirmsAStrictlyConvexProgram) {
  EXPECT_EQ(refusalOfCore(certificate_, map_), "");
  EXPECT_NE(refusalOfCore(certificate_.substr(0, certificate_.size() / 2), map_), "");
}

TEST_F(SliverMutation, TheCoreAloneRefusesLinesOfExtensions) {
  EXPECT_NE(refusalOfCore(certificate_, map_), "");
}

/// A map whose program counts with a row that is relaxed.
class RelaxedMutation : public Mutation {
 protected:
  RelaxedMutation() : Mutation(Subject(touching(1))) {}
};

TEST_F(RelaxedMutation, RelaxedRowsAreCountedAsSuch) {
  EXPECT_EQ(refusal(certificate_, map_), "");
  if (certificate_.find("\nrelaxed ") == std::string::npos) GTEST_SKIP() << "rounding left nothing to relax";
  expectRefused("relaxed", replacing({"relaxed", "0"}));
}

/// Certificates small enough to try every bit.
class BitMutation : public Mutation {
 protected:
  BitMutation() : Mutation(once([] { return randomProgram(2, 8, 1, 1); })) {}

  /// A wrong map, with whatever checksum the certificate then needs, is never confirmed.
  void expectNeverConfirmed(const MapContent& wrong) const {
    const std::string map = bytesOf(wrong);
    ASSERT_NE(refusal(sealed(certificate_, map), map), "");
    const std::size_t first = certificate_.find("\ntolerances ");
    for (std::size_t at = certificate_.find("\nregions "); at < certificate_.rfind("\nend "); ++at) {
      if (at <= first || std::isxdigit(static_cast<unsigned char>(certificate_[at])) == 0) continue;
      for (int bit = 0; bit < 8; ++bit) {
        std::string changed = certificate_;
        changed[at] = static_cast<char>(changed[at] ^ (1 << bit));
        EXPECT_NE(refusal(sealed(changed, map), map), "") << at << " " << bit;
      }
    }
  }
};

TEST_F(BitMutation, EveryBitOfTheCertificateIsCaught) {
  for (std::size_t at = 0; at < certificate_.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string changed = certificate_;
      changed[at] = static_cast<char>(changed[at] ^ (1 << bit));
      EXPECT_NE(refusal(changed, map_), "") << at << " " << bit;
    }
  }
}

TEST_F(BitMutation, NoBitOfTheCertificateMakesAWrongLawRight) {
  MapContent wrong = content_;
  wrong.laws[0] += 1e-6;
  expectNeverConfirmed(wrong);
}

TEST_F(BitMutation, NoBitOfTheCertificateMakesAWrongPlaneRight) {
  MapContent wrong = content_;
  changePlane(wrong, 1, 1e-6);
  expectNeverConfirmed(wrong);
}

TEST(CheckerInput, Xxh64KnownValues) {
  EXPECT_EQ(checker::xxh64(""), 0xef46db3751d8e999ull);
  EXPECT_EQ(checker::xxh64("abc"), 0x44bc2cf5ad770999ull);
}

TEST(CheckerInput, JsonNumbersOfAKey) {
  const std::string text =
      R"({"a": [[1, -2.5], [3e2, 4]], "s": "\"b\": [7]", "n": {"b": 8}, "b": [9], "x": 5})";
  EXPECT_EQ(checker::jsonNumbers(text, "a"), (std::vector<double>{1, -2.5, 300, 4}));
  EXPECT_EQ(checker::jsonNumbers(text, "b"), (std::vector<double>{9}));
  EXPECT_EQ(checker::jsonNumbers(text, "none"), (std::vector<double>{}));
}

TEST(CheckerInput, JsonThatHoldsNoNumberIsRefused) {
  for (const char* const text : {R"({"a": [-]})", R"({"a": [1, 1e999]})", R"({"a": [-1e999]})", R"({"a": -)"})
    EXPECT_THROW(checker::jsonNumbers(text, "a"), checker::Refused) << text;
}

TEST(CheckerInput, ARowOfZerosIsNoHalfSpace) {
  const checker::Row row = {1, 2, 3}, zeros = {0, 0, 0};
  EXPECT_FALSE(checker::sameHalfSpace(zeros, row));
  EXPECT_THROW(checker::sameHalfSpace(row, zeros), checker::Refused);
  EXPECT_THROW(checker::proportional(row, zeros), checker::Refused);
}

TEST_F(Mutation, TablesThatDoNotFitAreRefused) {
  constexpr std::size_t kReserved = 92, kTestCount = 96 + 10 * 16 + 8;  // FORMAT.md
  const char count = map_[kTestCount];
  ASSERT_EQ(refusal(certificate_, withBytes(map_, kTestCount, {count})), "");
  const auto why = [](const std::string& map) { return refusalOf([&] { checker::Map content(map); }); };
  EXPECT_TRUE(holds(why(withBytes(map_, kTestCount, {static_cast<char>(count - 1)})), "tests"));
  EXPECT_TRUE(holds(why(withBytes(map_, kReserved, {1})), "reserved"));
}

// What check_certificate would refuse is not called proven.
TEST_F(Mutation, NothingIsProvenThatTheCheckerRefuses) {
  const auto defect = [&](const MapContent& changed) {
    const CertifyReport report = certified(changed, program_);
    EXPECT_EQ(report.passed(), report.defects.empty());
    return report.passed() ? "" : report.defects.front().text;
  };
  ASSERT_EQ(defect(content_), "");
  MapContent changed = content_;
  changed.tolerance = 9e-9;
  EXPECT_TRUE(holds(defect(changed), "less than twice"));
  changed = content_;
  const MapContent::Region& region = changed.regions.front();
  changed.rows[region.first_row + 1] = changed.rows[region.first_row];
  EXPECT_FALSE(certified(changed, program_).passed());
}

/// A third parameter that nothing depends on, in a range so narrow that doubles can hardly tell its ends apart.
TEST(CheckerInput, ARangeTooNarrowForDoublesIsNotProven) {
  ParametricProgram program = doubleIntegrator(2);
  const auto widen = [](Eigen::MatrixXd& matrix) {
    matrix.conservativeResize(Eigen::NoChange, 3);
    matrix.col(2).setZero();
  };
  for (Eigen::MatrixXd* const matrix : {&program.F, &program.S, &program.A_theta, &program.C}) widen(*matrix);
  for (const double half : {1.0, 1e-6}) {
    program.parameters.resize(2);
    program.parameters.push_back({"far", "m", 1e6 - half, 1e6 + half});
    const CertifyReport report = certified(program);
    EXPECT_EQ(report.passed(), half == 1.0);
  }
}

constexpr char kJsonProblem[] = R"({
  "H": [[1.5064, 0.4838], [0.4838, 1.5258]], "f": [0, 0],
  "F": [[9.6652, 5.2115], [7.0732, -7.0879]],
  "A": [[1, 0], [-1, 0], [0, 1], [0, -1]], "b": [2, 2, 2, 2],
  "B": [[0, 0], [0, 0], [0, 0], [0, 0]], "eq_ids": [], "lb": [-1.5, -1.5], "ub": [1.5, 1.5], "out": [0]
})";

/// Why the checker refuses a map and a certificate that carry another text than the program's.
std::string refusalOfText(const ParametricProgram& program, MapContent content, const std::string& text) {
  content.problem_text = text;
  ParametricProgram liar = program;
  liar.text = text;
  const CertifyReport forged = certified(content, liar);
  EXPECT_TRUE(forged.passed());
  return refusal(forged.certificate, bytesOf(content), text);
}

TEST(CheckerInput, AJsonProblemIsComparedNumberByNumber) {
  const ParametricProgram program = parseProgramJson(kJsonProblem, "test.json");
  const MapContent content = solved(program);
  const CertifyReport report = certified(content, program);
  const std::string map = bytesOf(content);
  EXPECT_EQ(refusal(report.certificate, map, kJsonProblem), "");
  const std::string other = replaced(kJsonProblem, "1.5064", "1.5065");
  EXPECT_NE(refusal(report.certificate, map, other), "");
  // The map and the certificate carry the other text, but the numbers of the first.
  MapContent relabelled = content;
  relabelled.problem_text = other;
  EXPECT_THROW(certified(relabelled, program), Error);
  EXPECT_TRUE(holds(refusalOfText(program, content, other), "H is not"));
}

TEST(CheckerInput, EqualitiesOfAJsonProblemAreRows) {
  const ParametricProgram program = parseProgramJson(kJsonProblem, "test.json");
  const MapContent content = solved(program);
  for (const char* const ids : {"-1", "4", "0.5", "1e30"}) {
    const std::string other =
        replaced(kJsonProblem, "\"eq_ids\": []", std::string("\"eq_ids\": [") + ids + "]");
    EXPECT_TRUE(holds(refusalOfText(program, content, other), "eq_ids names what is not there")) << ids;
  }
}

ParametricProgram inTinyUnits() {
  ParametricProgram program = doubleIntegrator(3);
  constexpr double kUnit = 1e-10;
  for (Eigen::MatrixXd* const matrix : {&program.E, &program.C}) *matrix *= kUnit;
  program.c *= kUnit;
  for (Signal& input : program.inputs) {
    input.lower *= kUnit;
    input.upper *= kUnit;
  }
  return program;
}

class TinyUnits : public Mutation {
 protected:
  TinyUnits() : Mutation(Subject(inTinyUnits())) {}
};

// An error as great as the input's range is one, however small that is.
TEST_F(TinyUnits, ALawOfTheOtherSignIsRefused) {
  MapContent wrong = content_;
  for (double& entry : wrong.laws) entry = -entry;
  EXPECT_TRUE(holds(refusalOfMap(wrong), "the map's law is not the exact one"));
  EXPECT_FALSE(certified(wrong, program_).passed());
}

}  // namespace
}  // namespace polyfly
