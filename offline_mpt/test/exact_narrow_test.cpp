// Rows that leave about 1e-9 of z between them: the solver takes them as equalities, and so does the proof.
#include "map_in_memory.hpp"
#include "mutation.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "random_program.hpp"

namespace polyfly {
namespace {

/// A random program whose last two rows keep a'z within `width` of a function of theta.
ParametricProgram narrowProgram(double width, unsigned seed) {
  ParametricProgram program = randomProgram(4, 6, 2, seed);
  const Eigen::VectorXd a = program.A.row(0).normalized(), s = program.S.row(0);
  appendRow(program, 2.0 * a, 2.0 * width, 2.0 * s);
  appendRow(program, -a, width, -s);
  return program;
}

TEST(NarrowRows, CountAsEqualitiesWhereTheSolverTakesThemAsSuch) {
  std::size_t narrow = 0;
  for (const double width : {1e-6, 1e-8, 9e-10, 2e-10, 1e-12}) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
      const ParametricProgram program = narrowProgram(width, seed);
      const MapContent content = encode(program, explore(program));
      const CertifyReport report = certify(MapInMemory(content).map(), program);
      ASSERT_TRUE(report.passed()) << width << " " << seed << "\n" << certifyText(report);
      EXPECT_EQ(refusal(report.certificate, bytesOf(content)), "") << width << " " << seed;
      EXPECT_LE(report.greatest_narrowing, width);
      EXPECT_TRUE(report.narrow_rows.empty() || width < 1e-9);
      narrow += report.narrow_rows.empty() ? 0 : 1;
    }
  }
  EXPECT_GE(narrow, 8u);
}

class NarrowMutation : public Mutation {
 protected:
  NarrowMutation() : Mutation(narrowProgram(2e-10, 2)) {}
};

TEST_F(NarrowMutation, BoundsCountAsOthersWithinTheirLimitOnly) {
  EXPECT_NE(certificate_.find("counts b 6 0 0\n"), std::string::npos);
  int tried = 0;
  EXPECT_NE(refusalOfLines("counts b", setting(4, "1/10000000"), tried), "");
  EXPECT_EQ(tried, 2);
}

TEST_F(NarrowMutation, OnlyBoundsOfEqualitiesCountAsOthers) {
  int tried = 0;
  EXPECT_NE(refusalOfLines("counts b", setting(2, "0"), tried), "");
  EXPECT_NE(refusalOfLines("counts b", setting(1, "S"), tried), "");
  EXPECT_NE(refusalOfLines("implied ", replacing({"implied", "0"}), tried), "");
}

// With a slab that is wider than what rounding is, the law is another one.
TEST_F(NarrowMutation, WiderBoundsAreRefuted) {
  ParametricProgram wider = program_;
  wider.b(6) += 1e-6;
  EXPECT_FALSE(certify(MapInMemory(content_).map(), wider).passed());
  EXPECT_NE(certificate_.find("\nimplied 2 "), std::string::npos);
}

}  // namespace
}  // namespace polyfly
