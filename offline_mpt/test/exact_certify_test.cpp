// Exact verification: right maps are proven, wrong ones refuted for the right reason.
#include <gtest/gtest.h>

#include <algorithm>

#include "certify/facet_cover.hpp"
#include "error_of.hpp"
#include "exact_programs.hpp"
#include "holds.hpp"
#include "mpc_core/dense_qp.hpp"
#include "process_members.hpp"
#include "random_program.hpp"
#include "solved_map.hpp"

namespace polyfly {
namespace {

bool has(const CertifyReport& report, Defect::Kind kind) {
  return std::any_of(report.defects.begin(), report.defects.end(),
                     [kind](const Defect& defect) { return defect.kind == kind; });
}

CertifyReport expectProven(const ParametricProgram& program) {
  const MapContent content = solved(program);
  CertifyReport report = certified(content, program);
  EXPECT_TRUE(report.passed()) << program.name << "\n" << certifyText(report);
  EXPECT_EQ(report.regions, content.regions.size());
  if (report.slivers + report.left_out_rows == 0) {
    EXPECT_EQ(report.facets, content.rows.size());
  }
  EXPECT_EQ(report.facets,
            report.domain_facets + report.edge_facets + report.matched_facets + report.covered_facets);
  EXPECT_FALSE(report.certificate.empty());
  return report;
}

TEST(Certify, ProvesGeneratedPrograms) {
  for (const auto& [n, m, p] : {std::tuple{2, 8, 1}, {3, 12, 2}, {5, 20, 3}, {4, 14, 4}, {3, 10, 5}}) {
    for (unsigned seed = 1; seed <= 2; ++seed) expectProven(randomProgram(n, m, p, seed));
  }
}

TEST(Certify, ProvesUnstablePlantsOverLongHorizons) {
  for (const int horizon : {6, 8, 12}) expectProven(unstableRotation(horizon));
}

TEST(Certify, ProvesProgramsWhoseRowsAreNearlyDependent) {
  for (const double distance : {1e-3, 1e-4, 1e-5}) {
    for (unsigned seed = 1; seed <= 5; ++seed)
      EXPECT_LT(expectProven(nearlyDependent(distance, seed)).law_error, 1e-9) << distance << " " << seed;
  }
}

TEST(Certify, LeavesSliversToTheRegionsAboutThem) {
  const ParametricProgram program = nearlyDependent(1e-5, 3);
  const CertifyReport report = expectProven(program);
  EXPECT_GT(report.slivers, 0u);
  EXPECT_TRUE(holds(certifyText(report), "slivers that are left"));
  // What is wider than the tolerance is no sliver.
  CertifyOptions strict;
  strict.plane_tolerance = 1e-14;
  const CertifyReport refuted = certified(solved(program), program, strict);
  EXPECT_TRUE(has(refuted, Defect::Kind::kGap) || has(refuted, Defect::Kind::kPlane));
}

TEST(Certify, ProvesRowsThatAreTightUpToRounding) {
  for (unsigned seed = 1; seed <= 4; ++seed) expectProven(touching(seed));
}

TEST(Certify, ProvesStateConstraintsAndFindsTheEdgeOfTheFeasibleSet) {
  const CertifyReport report = expectProven(doubleIntegrator(5));
  EXPECT_GT(report.edge_facets, 0u);
  EXPECT_GT(report.matched_facets, 0u);
}

TEST(Certify, ProvesDomainRowsEqualitiesAndDuplicates) {
  ParametricProgram program = randomProgram(4, 14, 2, 9);
  program.A_theta.resize(2, 2);
  program.A_theta << 1.0, 1.0, 0.5, -1.0;
  program.b_theta.resize(2);
  program.b_theta << 1.1, 0.8;
  expectProven(program);
  ParametricProgram equality = program;
  equality.equalities = {3};
  equality.b(3) = 0.1;
  expectProven(equality);
  ParametricProgram doubled = program;
  for (int row = 0; row < program.rowCount(); ++row) appendMultiple(doubled, row, 1.0);
  expectProven(doubled);
}

TEST(Certify, DropsRowsThatRepeatOthersUpToRounding) {
  ParametricProgram program = randomProgram(3, 10, 2, 9);
  for (int row = 0; row < 10; ++row) appendMultiple(program, row, 0.7);
  EXPECT_FALSE(expectProven(program).dropped_rows.empty());
}

TEST(Certify, RecognisesInequalitiesThatAreEqualities) {
  ParametricProgram program = randomProgram(4, 13, 2, 9);
  appendMultiple(program, 0, -1.0);
  EXPECT_EQ(expectProven(program).implied_equalities, (std::vector<int>{0, 13}));
}

TEST(Certify, FindsTheEdgeThatARowWithoutMultiplierMakes) {
  // z_0 <= 0 is tight everywhere without a multiplier; with -z_0 <= theta_0 it ends the feasible set at theta_0 = 0.
  ParametricProgram program = randomProgram(2, 4, 2, 1);
  program.H.setIdentity();
  program.f.setZero();
  program.F << 0.0, 0.0, 0.5, 1.0;
  program.A << 1.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, -1.0;
  program.b << 0.0, 0.0, 0.5, 0.5;
  program.S << 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  EXPECT_GT(expectProven(program).edge_facets, 0u);
}

TEST(Certify, ProvesALinearProgram) { EXPECT_TRUE(expectProven(smallLinearProgram()).linear); }

TEST(Certify, NeitherThreadsNorRepetitionChangeTheCertificate) {
  const ParametricProgram program = doubleIntegrator(4);
  const MapContent content = solved(program);
  CertifyOptions options;
  const CertifyReport one = certified(content, program, options);
  for (const int threads : {1, 2, 5}) {
    options.threads = threads;
    const CertifyReport other = certified(content, program, options);
    EXPECT_EQ(other.certificate, one.certificate);
    EXPECT_EQ(certifyJson(other), certifyJson(one));
  }
}

TEST(Certify, StopsWhenTold) {
  const std::atomic<bool> stop{true};
  CertifyOptions options;
  options.stop = &stop;
  std::uint64_t total = 0;
  options.progress = [&](std::uint64_t, std::uint64_t all) { total = all; };
  const ParametricProgram program = randomProgram(8, 30, 3, 5);
  const MapContent content = solved(program);
  const CertifyReport report = certified(content, program, options);
  EXPECT_EQ(total, 3 * content.regions.size());
  EXPECT_EQ(report.passed(), !report.interrupted);  // on a fast machine nothing was left to stop
}

/// The report of process 0. Each of `others` proves with it, with options of its own.
CertifyReport certifiedWith(const MapContent& content, const ParametricProgram& program,
                            const std::vector<CertifyOptions>& others) {
  const MapInMemory memory(content);
  std::vector<Part> parts;
  for (const CertifyOptions& options : others) {
    parts.emplace_back([&](Member& member) {
      CertifyOptions own = options;
      own.group = &member;
      runCertifyProcess(memory.map(), program, own);
    });
  }
  return leadWith(parts, [&](Member& leader) {
    CertifyOptions options;
    options.group = &leader;
    return certify(memory.map(), program, options);
  });
}

// Among the programs: slivers, rows that are relaxed, a linear program and a map without a region.
TEST(Certify, ProcessesDoNotChangeTheReport) {
  const ParametricProgram random = randomProgram(4, 12, 2, 3);
  const Partition partition = explore(random);
  Partition gap = partition;
  gap.regions.erase(gap.regions.begin() + 2);
  for (const auto& [program, content] :
       {std::pair{random, encode(random, partition)}, std::pair{random, encode(random, gap)},
        std::pair{doubleIntegrator(4), solved(doubleIntegrator(4))},
        std::pair{nearlyDependent(1e-5, 3), solved(nearlyDependent(1e-5, 3))},
        std::pair{touching(1), solved(touching(1))},
        std::pair{smallLinearProgram(), solved(smallLinearProgram())}}) {
    const CertifyReport alone = certified(content, program);
    std::vector<CertifyOptions> others;
    for (int threads = 1; threads <= 2; ++threads) {
      others.emplace_back().threads = threads;
      const CertifyReport report = certifiedWith(content, program, others);
      EXPECT_EQ(report.certificate, alone.certificate) << program.name;
      EXPECT_EQ(certifyJson(report), certifyJson(alone)) << program.name;
    }
  }
}

TEST(Certify, AnyProcessOfAGroupEndsTheProof) {
  const ParametricProgram program = doubleIntegrator(4);
  const MapContent content = solved(program);
  const std::atomic<bool> stop{true};
  std::vector<CertifyOptions> others(2);
  others.back().stop = &stop;
  EXPECT_TRUE(certifiedWith(content, program, others).interrupted);
}

/// What process 0 throws whose one assistant proves something else.
std::string refusalOf(const MapContent& content, const ParametricProgram& program,
                      const MapContent& other_content, const ParametricProgram& other,
                      CertifyOptions options) {
  const MapInMemory memory(content), other_memory(other_content);
  const Part stranger = [&](Member& member) {
    options.group = &member;
    runCertifyProcess(other_memory.map(), other, options);
  };
  return errorOf([&] {
    leadWith({stranger}, [&](Member& leader) {
      CertifyOptions own;
      own.group = &leader;
      return certify(memory.map(), program, own);
    });
  });
}

TEST(Certify, AProcessWithAnotherProblemIsNamed) {
  const ParametricProgram program = doubleIntegrator(4);
  ParametricProgram other = program;
  other.text += " ";
  const MapContent content = solved(program);
  EXPECT_TRUE(holds(refusalOf(content, program, content, other, {}), "process 1: "));
}

// Of the same program, with as many regions.
TEST(Certify, AProcessWithAnotherMapOrToleranceIsNamed) {
  const ParametricProgram program = doubleIntegrator(4);
  const MapContent content = solved(program);
  EXPECT_EQ(refusalOf(content, program, content, program, {}), "no error");
  MapContent stale = content;
  stale.laws.front() += 1e-9;
  CertifyOptions options;
  options.law_tolerance *= 2.0;
  for (const std::string& text : {refusalOf(content, program, stale, program, {}),
                                  refusalOf(content, program, content, program, options)}) {
    EXPECT_TRUE(holds(text, "not read the same: process 0: map "));
    EXPECT_TRUE(holds(text, "; process 1: map "));
  }
}

/// Many half-spaces of a line hold in all of the box, and so does that of the candidate.
TEST(Certify, NoCoverHasCellsThatTheCheckerRefuses) {
  const auto row = [](int slope, int constant) {
    ExactRow result;
    result.value = {slope, constant};
    finishRow(result);
    return result;
  };
  const std::vector<ExactRow> all = {row(1, 1)};
  const std::vector<CoverCandidate> candidates = {{7, &all}};
  std::string text;
  const std::vector<ExactRow> most(kMostCellRows - 1, row(1, 2)), more(kMostCellRows, row(1, 2));
  EXPECT_TRUE(FacetCover(nullptr, 1, candidates, nullptr).cover(most, text));
  EXPECT_EQ(text.rfind(" N 7 e", 0), 0u) << text;
  EXPECT_THROW(FacetCover(nullptr, 1, candidates, nullptr).cover(more, text), Error);
}

/// A map of one program, to be spoilt.
class CorruptedMap : public ::testing::Test {
 protected:
  CorruptedMap() : program_(randomProgram(4, 12, 2, 3)), content_(solved(program_)) {}

  CertifyReport report() const { return certified(content_, program_); }

  /// A region with a facet that is not at the edge of anything: more than two active rows change around it.
  std::size_t middle() const {
    std::size_t best = 0;
    for (std::size_t r = 0; r < content_.regions.size(); ++r) {
      if (content_.regions[r].row_count > content_.regions[best].row_count) best = r;
    }
    return best;
  }

  void drop(std::size_t region) {
    content_.regions.erase(content_.regions.begin() + static_cast<std::ptrdiff_t>(region));
    content_.nodes.clear();
    content_.leaves = {{0, static_cast<std::uint32_t>(content_.regions.size())}};
    content_.root = MapContent::kLeaf;
    content_.candidates.clear();
    content_.tests.clear();
    for (std::uint32_t r = 0; r < content_.regions.size(); ++r) content_.candidates.push_back(r);
  }

  ParametricProgram program_;
  MapContent content_;
};

TEST_F(CorruptedMap, NotAtAllIsProven) { EXPECT_TRUE(report().passed()); }

TEST_F(CorruptedMap, MissingRegionIsFoundWithAWitnessAndItsActiveSet) {
  ASSERT_GT(content_.regions.size(), 3u);
  for (std::size_t region = 0; region < content_.regions.size(); ++region) {
    const MapContent whole = content_;
    const MapContent::Region gone = whole.regions[region];
    const std::vector<int> active(whole.active.begin() + gone.first_active,
                                  whole.active.begin() + gone.first_active + gone.active_count);
    drop(region);
    const CertifyReport found = report();
    EXPECT_FALSE(found.passed());
    EXPECT_TRUE(found.certificate.empty());
    ASSERT_TRUE(has(found, Defect::Kind::kGap)) << region;
    const Defect& defect = found.defects.front();
    EXPECT_EQ(defect.missing, active);
    ASSERT_EQ(defect.witness.size(), 2);
    const MapInMemory map(content_);
    EXPECT_EQ(map.map().locateExhaustively(defect.witness.data()).status, LookupStatus::kOutsidePartition);
    DenseQp qp(program_.H, program_.A);
    const Eigen::VectorXd g = program_.f + program_.F * defect.witness;
    const Eigen::VectorXd b = program_.b + program_.S * defect.witness;
    EXPECT_EQ(qp.solve(g.data(), b.data()), QpStatus::kOptimal);
    content_ = whole;
  }
}

TEST_F(CorruptedMap, LawIsCaughtAboveTheToleranceOnly) {
  content_.laws[0] += 1e-12;
  EXPECT_TRUE(report().passed());
  content_.laws[0] += 1e-6;
  EXPECT_TRUE(has(report(), Defect::Kind::kLaw));
}

TEST_F(CorruptedMap, PlaneIsCaughtAboveTheToleranceOnly) {
  const std::size_t constant = 2;
  content_.planes[constant] += 1e-12;
  EXPECT_TRUE(report().passed());
  content_.planes[constant] += 1e-6;
  EXPECT_TRUE(has(report(), Defect::Kind::kPlane));
}

TEST_F(CorruptedMap, EveryMissingFacetIsCaught) {
  for (std::size_t r = 0; r < content_.regions.size(); ++r) {
    const MapContent whole = content_;
    content_.regions[r].row_count -= 1;
    const CertifyReport found = report();
    // A side of the box need not be listed: the look-up tests the box.
    const std::size_t row = whole.regions[r].first_row + whole.regions[r].row_count - 1;
    const std::size_t plane = static_cast<std::size_t>(std::abs(whole.rows[row])) - 1;
    const bool side = std::abs(whole.planes[plane * 3] * whole.planes[plane * 3 + 1]) == 0.0;
    EXPECT_EQ(has(found, Defect::Kind::kUnlisted), !side) << r;
    content_ = whole;
  }
}

TEST_F(CorruptedMap, NegatedRowIsCaught) {
  for (std::size_t row = 0; row < content_.rows.size(); ++row) {
    content_.rows[row] = -content_.rows[row];
    EXPECT_FALSE(report().passed()) << row;
    content_.rows[row] = -content_.rows[row];
  }
}

TEST_F(CorruptedMap, ActiveSetIsCaught) {
  for (std::size_t k = 0; k < content_.active.size(); ++k) {
    const std::int32_t right = content_.active[k];
    for (const std::int32_t wrong : {(right + 1) % 12, 12, 1000000}) {
      content_.active[k] = wrong;
      EXPECT_FALSE(report().passed()) << k << " " << wrong;
    }
    content_.active[k] = right;
  }
}

TEST_F(CorruptedMap, RepeatedRegionIsCaught) {
  content_.regions.push_back(content_.regions[middle()]);
  EXPECT_TRUE(has(report(), Defect::Kind::kRepeated));
}

TEST_F(CorruptedMap, FlatRegionIsCaught) {
  // A region of another active set, listed with its own true rows, that has no interior: here a set whose
  // region is empty.
  MapContent::Region& region = content_.regions[middle()];
  const auto first = static_cast<std::uint32_t>(content_.active.size());
  content_.active.insert(content_.active.end(), {0, 1, 2, 3});
  region.first_active = first;
  region.active_count = 4;
  EXPECT_FALSE(report().passed());
}

TEST_F(CorruptedMap, RepairAddsWhatIsMissingAndCorrectsWhatIsWrong) {
  const std::size_t count = content_.regions.size();
  const std::vector<double> laws = content_.laws;
  content_.laws[0] += 1.0;
  content_.planes[2] += 0.01;
  while (content_.regions.size() > 1) drop(content_.regions.size() / 2);
  const RepairResult result = repair(MapInMemory(content_).map(), program_);
  EXPECT_TRUE(result.report.passed()) << certifyText(result.report);
  EXPECT_EQ(result.partition.status, ExploreStatus::kComplete);
  EXPECT_EQ(result.partition.regions.size(), count);
  EXPECT_EQ(result.added, count - 1);
  const MapContent repaired = encode(program_, result.partition);
  EXPECT_TRUE(certified(repaired, program_).passed());
  ASSERT_EQ(repaired.laws.size(), laws.size());
  for (std::size_t k = 0; k < laws.size(); ++k) EXPECT_NEAR(repaired.laws[k], laws[k], 1e-9);
}

TEST(Certify, RepairCrossesDegenerateFacets) {
  const ParametricProgram program = doubleIntegrator(5);
  const Partition partition = explore(program);
  Partition one = partition;
  one.regions.resize(1);
  const RepairResult result = repair(MapInMemory(encode(program, one)).map(), program);
  EXPECT_TRUE(result.report.passed()) << certifyText(result.report);
  EXPECT_EQ(result.partition.regions.size(), partition.regions.size());
}

TEST(Certify, RefusesOtherSignals) {
  const ParametricProgram program = randomProgram(3, 10, 2, 4);
  MapContent content = solved(program);
  content.parameters[1].upper = 2.0;
  EXPECT_THROW(certified(content, program), Error);
}

TEST(Certify, RefusesAnInfeasibleOrIndefiniteProgram) {
  ParametricProgram program = randomProgram(3, 10, 2, 4);
  const MapContent content = solved(program);
  ParametricProgram indefinite = program;
  indefinite.H(0, 0) = -1.0;
  EXPECT_THROW(certified(content, indefinite), Error);
  program.A.row(1) = -program.A.row(0);
  program.b(0) = program.b(1) = -1.0;
  program.S.topRows(2).setZero();
  EXPECT_THROW(certified(content, program), Error);
}

TEST(Certify, AnotherProgramsMapIsRefuted) {
  const ParametricProgram program = randomProgram(3, 10, 2, 4);
  const MapContent content = solved(program);
  ParametricProgram other = program;
  other.b(content.active.front()) *= 1.0 + 1e-6;
  EXPECT_FALSE(certified(content, other).passed());
}

TEST(Certify, ThereIsNoCertificateOfAWrongMap) {
  CertifyReport report;
  EXPECT_THROW(writeCertificate(report, "nowhere.cert"), Error);
}

TEST(Certify, ReportsSayWhatTheyFound) {
  const ParametricProgram program = randomProgram(3, 10, 2, 4);
  MapContent content = solved(program);
  EXPECT_TRUE(holds(certifyText(certified(content, program)), "PROVEN"));
  content.laws[0] += 1.0;
  const CertifyReport report = certified(content, program);
  EXPECT_TRUE(holds(certifyText(report), "REFUTED"));
  EXPECT_TRUE(holds(certifyJson(report), "\"kind\": \"law\""));
}

}  // namespace
}  // namespace polyfly
