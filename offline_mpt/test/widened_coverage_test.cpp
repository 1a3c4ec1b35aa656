// Rows that are sums of others up to rounding: maps are proven with their regions moved outwards, and wrong
// ones are refuted as ever.
#include <gtest/gtest.h>

#include "extensions/read_certificate.hpp"
#include "mutation.hpp"
#include "random_program.hpp"

namespace polyfly {
namespace {

/// Three more rows, each the weighted sum of two others, bounds included.
ParametricProgram withSums(unsigned seed) {
  ParametricProgram program = randomProgram(4, 6, 3, seed);
  for (int i = 6; i < 9; ++i) {
    const double first = 0.3 + 0.1 * i, second = 0.7;
    appendRow(program, first * program.A.row(i - 6) + second * program.A.row(i - 5),
              first * program.b(i - 6) + second * program.b(i - 5),
              first * program.S.row(i - 6) + second * program.S.row(i - 5));
  }
  return program;
}

/// Of `withSums`, with a map that only moved regions prove.
ParametricProgram widenedProgram() {
  for (unsigned seed = 1; seed < 200; ++seed) {
    const ParametricProgram program = withSums(seed);
    const CertifyReport report = certified(program);
    EXPECT_TRUE(report.passed()) << seed << "\n" << certifyText(report);
    if (report.widened) return program;
  }
  ADD_FAILURE() << "no program needed it";
  return withSums(1);
}

class WidenedCoverage : public Mutation {
 protected:
  WidenedCoverage() : Mutation(once([] { return widenedProgram(); })) {}
};

TEST_F(WidenedCoverage, ProvesWhatRoundingHides) {
  const checker::Map read(map_);
  const auto certificate = checker::readCertificate(certificate_, read);
  EXPECT_NO_THROW(certificate->check());
  EXPECT_TRUE(holds(certificate->conditions(), "moved outwards"));
  EXPECT_TRUE(holds(certifyText(certified(content_, program_)), "moved outwards"));
}

TEST_F(WidenedCoverage, WrongMapsAreRefuted) {
  for (std::size_t r = 0; r < content_.laws.size(); ++r) {
    MapContent wrong = content_;
    wrong.laws[r] += 1e-6;
    EXPECT_FALSE(certified(wrong, program_).passed()) << "law entry " << r;
  }
  for (std::size_t r = 0; r < content_.planes.size(); r += 3) {
    MapContent wrong = content_;
    changePlane(wrong, r, 1e-6);
    EXPECT_FALSE(certified(wrong, program_).passed()) << "plane entry " << r;
  }
  const Partition whole = explore(program_);
  std::size_t refuted = 0;
  for (std::size_t r = 0; r < whole.regions.size(); ++r) {
    Partition fewer = whole;
    fewer.regions.erase(fewer.regions.begin() + static_cast<std::ptrdiff_t>(r));
    const MapInMemory map(encode(program_, fewer));
    if (!certify(map.map(), program_).passed()) {
      ++refuted;
      continue;
    }
    // Active sets that differ in rows which imply each other describe the same region: one of them is enough.
    Eigen::VectorXd u(program_.inputCount());
    EXPECT_EQ(map.map().evaluate(whole.regions[r].centre.data(), u.data()).status, LookupStatus::kInside)
        << "without region " << r;
    EXPECT_LT((whole.regions[r].K * whole.regions[r].centre + whole.regions[r].k - u).norm(), 1e-9);
  }
  EXPECT_GE(refuted, whole.regions.size() / 2);
}

TEST_F(WidenedCoverage, ACertificateThatClaimsLessIsRefused) {
  EXPECT_NE(refusal(certificate_.substr(0, certificate_.size() / 2), map_), "");
  expectRefused("coverage", replacing({"coverage", "exact"}));
}

}  // namespace
}  // namespace polyfly
