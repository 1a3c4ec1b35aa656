// Rows that are sums of others up to rounding: maps are proven with their regions moved outwards, and wrong
// ones are refuted as ever.
#include <gtest/gtest.h>

#include "checksum.hpp"
#include "extensions/read_certificate.hpp"
#include "map_in_memory.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "random_program.hpp"

namespace polyfly {
namespace {

/// Three more rows, each the weighted sum of two others, bounds included.
ParametricProgram withSums(unsigned seed) {
  ParametricProgram program = randomProgram(4, 6, 3, seed);
  program.A.conservativeResize(9, 4);
  program.b.conservativeResize(9);
  program.S.conservativeResize(9, 3);
  for (int i = 6; i < 9; ++i) {
    const double first = 0.3 + 0.1 * i, second = 0.7;
    program.A.row(i) = first * program.A.row(i - 6) + second * program.A.row(i - 5);
    program.b(i) = first * program.b(i - 6) + second * program.b(i - 5);
    program.S.row(i) = first * program.S.row(i - 6) + second * program.S.row(i - 5);
  }
  return program;
}

/// A map of `withSums` that only moved regions prove, with its seed.
MapContent widenedMap(unsigned& seed, CertifyReport& report) {
  for (seed = 1; seed < 200; ++seed) {
    const ParametricProgram program = withSums(seed);
    MapContent content = encode(program, explore(program));
    report = certify(MapInMemory(content).map(), program);
    EXPECT_TRUE(report.passed()) << seed << "\n" << certifyText(report);
    if (report.widened) return content;
  }
  return {};
}

TEST(WidenedCoverage, ProvesWhatRoundingHides) {
  unsigned seed = 0;
  CertifyReport report;
  const MapContent content = widenedMap(seed, report);
  ASSERT_TRUE(report.widened) << "no program needed it";
  const MapInMemory map(content);
  const checker::Map read(map.bytes());
  const auto certificate = checker::readCertificate(report.certificate, read);
  EXPECT_NO_THROW(certificate->check());
  EXPECT_NE(certificate->conditions().find("moved outwards"), std::string::npos);
  EXPECT_NE(certifyText(report).find("moved outwards"), std::string::npos);
}

TEST(WidenedCoverage, WrongMapsAreRefuted) {
  unsigned seed = 0;
  CertifyReport report;
  const MapContent content = widenedMap(seed, report);
  ASSERT_TRUE(report.widened);
  const ParametricProgram program = withSums(seed);
  for (std::size_t r = 0; r < content.laws.size(); ++r) {
    MapContent wrong = content;
    wrong.laws[r] += 1e-6;
    EXPECT_FALSE(certify(MapInMemory(wrong).map(), program).passed()) << "law entry " << r;
  }
  for (std::size_t r = 0; r < content.planes.size(); r += 3) {
    MapContent wrong = content;
    changePlane(wrong, r, 1e-6);
    EXPECT_FALSE(certify(MapInMemory(wrong).map(), program).passed()) << "plane entry " << r;
  }
  const Partition whole = explore(program);
  std::size_t refuted = 0;
  for (std::size_t r = 0; r < whole.regions.size(); ++r) {
    Partition fewer = whole;
    fewer.regions.erase(fewer.regions.begin() + static_cast<std::ptrdiff_t>(r));
    const MapInMemory map(encode(program, fewer));
    if (!certify(map.map(), program).passed()) {
      ++refuted;
      continue;
    }
    // Active sets that differ in rows which imply each other describe the same region: one of them is enough.
    Eigen::VectorXd u(program.inputCount());
    EXPECT_EQ(map.map().evaluate(whole.regions[r].centre.data(), u.data()).status, LookupStatus::kInside)
        << "without region " << r;
    EXPECT_LT((whole.regions[r].K * whole.regions[r].centre + whole.regions[r].k - u).norm(), 1e-9);
  }
  EXPECT_GE(refuted, whole.regions.size() / 2);
}

TEST(WidenedCoverage, ACertificateThatClaimsLessIsRefused) {
  unsigned seed = 0;
  CertifyReport report;
  const MapContent content = widenedMap(seed, report);
  ASSERT_TRUE(report.widened);
  const MapInMemory map(content);
  const checker::Map read(map.bytes());
  EXPECT_THROW(checker::readCertificate(report.certificate.substr(0, report.certificate.size() / 2), read),
               checker::Refused);
  std::string exact = report.certificate;
  exact.replace(exact.find("coverage widened"), 16, "coverage exact");
  exact.resize(exact.rfind("end "));
  char seal[32];
  std::snprintf(seal, sizeof seal, "end %s\n", checker::hexText(checker::xxh64(exact)).c_str());
  EXPECT_THROW(checker::readCertificate(exact + seal, read)->check(), checker::Refused);
}

}  // namespace
}  // namespace polyfly
