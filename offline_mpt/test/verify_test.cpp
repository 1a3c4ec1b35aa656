// The verification must pass a right map and catch every way in which a map can be wrong.
#include "offline_mpt/verify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "error_of.hpp"
#include "holds.hpp"
#include "made_program.hpp"
#include "map_in_memory.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "random.hpp"
#include "random_program.hpp"
#include "reference_problems.hpp"
#include "verify/exact_sample.hpp"
#include "verify/strict_qp.hpp"

namespace polyfly {
namespace {

const ProgramSize kSize = {3, 10, 2};
constexpr std::uint64_t kSeed = 3;
constexpr double kPrecision = 1e-12;

VerifyOptions manySamples() {
  VerifyOptions options;
  options.samples = 4000;
  options.seed = 7;
  return options;
}

class Verify : public testing::Test {
 protected:
  const ParametricProgram program = madeProgram(kSeed, kSize);
  const Partition partition = explore(program);
  MapContent content = encode(program, partition);

  VerifyReport report(const VerifyOptions& options = manySamples()) const { return report(program, options); }

  VerifyReport report(const ParametricProgram& of, const VerifyOptions& options = manySamples()) const {
    const MapInMemory memory(content);
    return verify(memory.map(), of, options);
  }

  // Every look-up tests all regions in file order.
  /// Adds a region between the plane of a row and another one, so far inside of it; below zero it is empty.
  void addSlab(double width) {
    MapContent::Region slab = content.regions.front();
    const std::int32_t row = content.rows[slab.first_row];
    const std::size_t count = content.parameters.size() + 1;
    for (std::size_t j = 0; j < count; ++j)
      content.planes.push_back(content.planes[(static_cast<std::size_t>(std::abs(row)) - 1) * count + j]);
    content.planes.back() += row > 0 ? -width : width;
    const auto beyond = static_cast<std::int32_t>(content.planes.size() / count);
    slab.first_row = static_cast<std::uint32_t>(content.rows.size());
    slab.row_count = 2;
    content.rows.push_back(row);
    content.rows.push_back(row > 0 ? -beyond : beyond);
    content.regions.push_back(slab);
  }

  void searchAllRegions() {
    content.nodes.clear();
    content.root = MapContent::kLeaf;
    content.candidates.clear();
    for (std::uint32_t i = 0; i < content.regions.size(); ++i) content.candidates.push_back(i);
    content.leaves = {{0, static_cast<std::uint32_t>(content.regions.size())}};
    content.tests.clear();
  }

  // Moves a row of the largest region, one that is no face of the box, outward by `distance` [scaled].
  void moveRow(double distance) {
    const std::size_t width = content.parameters.size() + 1;
    std::size_t next = content.regions[largestRegion()].first_row, plane = 0;
    do {
      plane = static_cast<std::size_t>(std::abs(content.rows[next++])) - 1;
    } while (content.planes[plane * width] * content.planes[plane * width + 1] == 0.0);
    std::int32_t& row = content.rows[next - 1];
    for (std::size_t j = 0; j < width; ++j) content.planes.push_back(content.planes[plane * width + j]);
    content.planes.back() += row > 0 ? distance : -distance;
    const auto moved = static_cast<std::int32_t>(content.planes.size() / width);
    row = row > 0 ? moved : -moved;
  }

  std::size_t largestRegion() const {
    const auto largest = std::max_element(
        partition.regions.begin(), partition.regions.end(),
        [](const CriticalRegion& a, const CriticalRegion& b) { return a.radius < b.radius; });
    return static_cast<std::size_t>(largest - partition.regions.begin());
  }
};

TEST_F(Verify, PassesARightMap) {
  ASSERT_EQ(partition.status, ExploreStatus::kComplete);
  ASSERT_GT(partition.regions.size(), 5u);
  const VerifyReport result = report();
  EXPECT_TRUE(result.passed()) << verifyText(result);
  EXPECT_EQ(result.samples, 4000u);
  EXPECT_EQ(result.uniform, 2000u);
  EXPECT_EQ(result.regions_hit, partition.regions.size());
  EXPECT_GT(result.compared, 3000u);
  EXPECT_LT(result.max_scaled_error, manySamples().tolerance);
}

TEST_F(Verify, CatchesACorruptedLaw) {
  const double range = program.inputs[0].upper - program.inputs[0].lower;
  content.laws[content.regions[largestRegion()].law * 3 * 3 + 2] += 1e-5 * range;
  const VerifyReport result = report();
  EXPECT_FALSE(result.passed());
  EXPECT_GT(result.errors.count, 0u);
  EXPECT_NEAR(result.max_error, 1e-5 * range, 1e-7 * range);
  EXPECT_EQ(result.errors.example.size(), 2);
  EXPECT_EQ(result.missed.count, 0u);
}

TEST_F(Verify, CatchesARemovedRegion) {
  Partition holed = partition;
  holed.regions.erase(holed.regions.begin() + static_cast<std::ptrdiff_t>(largestRegion()));
  content = encode(program, holed);
  const VerifyReport result = report();
  EXPECT_FALSE(result.passed());
  EXPECT_GT(result.missed.count, 100u);
  EXPECT_EQ(result.errors.count, 0u);
}

// Small holes are found because half of the samples aim at faces and vertices of the regions around them.
TEST_F(Verify, CatchesTheSmallestRegionRemoved) {
  const auto smallest =
      std::min_element(partition.regions.begin(), partition.regions.end(),
                       [](const CriticalRegion& a, const CriticalRegion& b) { return a.radius < b.radius; });
  Partition holed = partition;
  holed.regions.erase(holed.regions.begin() + (smallest - partition.regions.begin()));
  content = encode(program, holed);
  const VerifyReport result = report();
  EXPECT_FALSE(result.passed());
  EXPECT_GT(result.missed.count, 0u);
}

TEST_F(Verify, CatchesAHalfSpaceShiftedOutward) {
  moveRow(0.05);
  searchAllRegions();
  const VerifyReport result = report();
  EXPECT_FALSE(result.passed());
  EXPECT_GT(result.overlaps.count, 0u);
  EXPECT_GT(result.overlaps.worst, manySamples().tolerance);
}

TEST_F(Verify, CatchesAHalfSpaceShiftedInward) {
  moveRow(-1e-4);
  searchAllRegions();
  const VerifyReport result = report();
  EXPECT_FALSE(result.passed());
  EXPECT_GT(result.missed.count, 0u);
}

TEST_F(Verify, CatchesABrokenTree) {
  ASSERT_FALSE(content.nodes.empty());
  std::swap(content.nodes[0].below, content.nodes[0].above);
  const VerifyReport result = report();
  EXPECT_FALSE(result.passed());
  EXPECT_GT(result.errors.count + result.missed.count, 1000u);
}

// The tree has no part in the test of all regions: a region that only the tree loses is a difference.
TEST_F(Verify, CatchesARegionThatTheTreeCannotReach) {
  const auto lost = static_cast<std::uint32_t>(largestRegion());
  searchAllRegions();
  content.candidates.erase(content.candidates.begin() + lost);
  content.leaves[0].count -= 1;
  const VerifyReport result = report();
  EXPECT_FALSE(result.passed());
  EXPECT_GT(result.missed.count, 100u);
}

TEST_F(Verify, CatchesAnswersWhereThereIsNoSolution) {
  const ParametricProgram strict = [this] {
    ParametricProgram changed = program;
    // t0 + t1 <= z0 <= t0: none for t1 > 0
    appendRow(changed, Eigen::Vector3d(1.0, 0.0, 0.0), 0.0, Eigen::Vector2d(1.0, 0.0));
    appendRow(changed, Eigen::Vector3d(-1.0, 0.0, 0.0), 0.0, Eigen::Vector2d(-1.0, -1.0));
    return changed;
  }();
  const MapInMemory memory(content);
  const VerifyReport result = verify(memory.map(), strict, manySamples());
  EXPECT_FALSE(result.passed());
  EXPECT_GT(result.false_inside.count, 100u);
  EXPECT_GT(result.false_inside.worst, 0.1);
  EXPECT_GT(result.infeasible, 1000u);
}

// u = 1000 t where that is between 0 and 5e-6. Without so thin a region, look-ups answer with the laws beside it.
TEST_F(Verify, AnswersJustBeyondARegionCountInside) {
  ParametricProgram steep = madeProgram(kSeed, {1, 2, 1});
  steep.H << 1.0;
  steep.f << 0.0;
  steep.F << -1000.0;
  steep.A << 1.0, -1.0;
  steep.b << 5e-6, 0.0;
  steep.S.setZero();
  steep.inputs[0].lower = -1.0;
  steep.inputs[0].upper = 1.0;
  Partition thick = explore(steep);
  ASSERT_EQ(thick.regions.size(), 3u);
  thick.regions.erase(thick.regions.begin());  // of the active set that is empty
  content = encode(steep, thick);
  const VerifyReport result = report(steep);
  EXPECT_TRUE(result.passed()) << verifyText(result);
  EXPECT_GT(result.beyond.count, 10u);
  EXPECT_GT(result.beyond.worst, manySamples().tolerance);
  EXPECT_LT(result.beyond.worst, 2.5e-6);
  content.laws[1] += 1e-6;
  EXPECT_GT(report(steep).errors.count, 1000u);
}

TEST_F(Verify, CatchesAnEmptyRegion) {
  searchAllRegions();
  addSlab(-0.1);
  const VerifyReport result = report();
  EXPECT_FALSE(result.passed());
  EXPECT_GT(result.empty_regions.count, 0u);
  EXPECT_NEAR(result.empty_regions.worst, 0.05, 1e-6);
}

// Thinner than the error of the oracle.
TEST_F(Verify, TellsAnEmptyRegionFromAThinOne) {
  searchAllRegions();
  const MapContent before = content;
  for (const double width : {1e-9, 1e-10, 2e-11}) {
    content = before;
    addSlab(width);
    EXPECT_EQ(report().empty_regions.count, 0u) << width;
    content = before;
    addSlab(-width);
    const VerifyReport result = report();
    EXPECT_FALSE(result.passed());
    EXPECT_GT(result.empty_regions.count, 0u) << width;
    EXPECT_NEAR(result.empty_regions.worst, 0.5 * width, 1e-15);
  }
}

TEST_F(Verify, RefusesAMapThatSaysItIsIncomplete) {
  content.solver_status = "limited";
  EXPECT_FALSE(report().passed());
}

TEST_F(Verify, GivesTheSameReportForAnyNumberOfThreads) {
  VerifyOptions options = manySamples();
  options.samples = 1500;
  const std::string one = verifyJson(report(options));
  options.threads = 3;
  EXPECT_EQ(verifyJson(report(options)), one);
  options.seed = 8;
  EXPECT_NE(verifyJson(report(options)), one);
}

TEST_F(Verify, StopsWhenToldTo) {
  const std::atomic<bool> stop{true};
  VerifyOptions options = manySamples();
  options.stop = &stop;
  const VerifyReport result = report(options);
  EXPECT_TRUE(result.interrupted);
  EXPECT_EQ(result.samples, 0u);
  EXPECT_FALSE(result.passed());
}

TEST_F(Verify, ReportsProgressUpToTheEnd) {
  VerifyOptions options = manySamples();
  std::uint64_t last = 0;
  options.progress = [&](std::uint64_t done, std::uint64_t total) {
    EXPECT_GE(done, last);
    EXPECT_EQ(total, options.samples);
    last = done;
  };
  report(options);
  EXPECT_EQ(last, options.samples);
}

TEST_F(Verify, RefusesAProblemOfOtherSignals) {
  const MapInMemory memory(content);
  ParametricProgram renamed = program;
  renamed.parameters[1].name = "wind";
  ParametricProgram wider = program;
  wider.parameters[0].upper = 2.0;
  ParametricProgram bounded = program;
  bounded.inputs[0].upper = 0.5;
  ParametricProgram fewer = madeProgram(kSeed, {2, 10, 2});
  ParametricProgram rescaled = program;
  rescaled.inputs[0].unit = "degree";
  ParametricProgram slower = program;
  slower.period += 0.25;
  const std::pair<const ParametricProgram*, const char*> cases[] = {
      {&renamed, "the problem has 'wind'"},           {&wider, "ranges of map and problem differ"},
      {&bounded, "ranges of map and problem differ"}, {&fewer, "the problem has 2"},
      {&rescaled, "the problem has 'degree'"},        {&slower, "period: must be that of the problem"}};
  for (const auto& [other, message] : cases) {
    const ParametricProgram& problem = *other;
    EXPECT_TRUE(holds(errorOf([&] { verify(memory.map(), problem); }), message));
  }
}

// A linear program whose minimiser is not unique: u may be any of them.
TEST(VerifyLinear, AcceptsEachOptimumWhereItIsNotUnique) {
  ParametricProgram program = madeProgram(kSeed, {2, 4, 2});
  program.H.setZero();
  program.F.setZero();
  program.f << 1.0, 0.0;
  program.A << 1.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, -1.0;
  program.b.setOnes();
  program.S << 0.0, 0.0, 0.5, 0.0, 0.0, 0.2, 0.0, 0.0;
  MapContent content;
  content.name = "box";
  content.problem_text = "none";
  content.problem_kind = "json";
  content.solver_status = "complete";
  content.tolerance = 1e-9;
  content.parameters = program.parameters;
  content.inputs = program.inputs;
  content.planes = {1.0, 0.0, 1.0};
  content.rows = {1};
  content.laws = {-0.5, 0.0, -1.0, /**/ 0.1, 0.0, 0.3};  // z0 at its bound, z1 anywhere between its bounds
  content.regions = {{0, 1, 0, 0, 0}};
  content.leaves = {{0, 1}};
  content.candidates = {0};
  content.root = MapContent::kLeaf;
  const VerifyReport right = verify(MapInMemory(content).map(), program, manySamples());
  EXPECT_TRUE(right.passed()) << verifyText(right);
  EXPECT_EQ(right.compared, 4000u);

  content.laws[2] += 1e-3;  // dearer
  EXPECT_EQ(verify(MapInMemory(content).map(), program, manySamples()).errors.count, 4000u);
  content.laws[2] -= 2e-3;  // beyond the bound
  EXPECT_EQ(verify(MapInMemory(content).map(), program, manySamples()).errors.count, 4000u);
}

TEST(ExactSample, MeasuresTheDistanceToTheFeasibleSet) {
  ParametricProgram program = madeProgram(kSeed, {1, 2, 2});
  program.A << 1.0, -1.0;
  program.b << 0.0, 0.0;
  program.S << 1.0, 0.0, 0.0, -1.0;  // t1 <= z <= t0
  program.parameters[0].lower = -4.0;
  program.parameters[0].upper = 4.0;
  const auto distance = [&](double t0, double t1) {
    const Eigen::VectorXd theta = Eigen::Vector2d(t0, t1);
    const auto nearest = ExactSample(program, theta).nearestFeasible();
    return nearest ? nearest->distance : std::numeric_limits<double>::infinity();
  };
  EXPECT_EQ(distance(0.5, 0.0), 0.0);
  // Half ranges are 4 and 1: both move by r, 1 = 4 r + r.
  EXPECT_NEAR(distance(-0.5, 0.5), 0.2, 1e-15);
  program.b << -6.0, 0.0;  // t1 <= z <= t0 - 6
  EXPECT_EQ(distance(0.5, 0.0), std::numeric_limits<double>::infinity());
  program.b << 0.0, 0.0;
  program.A_theta = Eigen::RowVector2d(1.0, 0.0);  // t0 <= -0.7
  program.b_theta = Eigen::VectorXd::Constant(1, -0.7);
  EXPECT_NEAR(distance(0.5, -1.0), 0.3, 1e-15);
}

class VerifyReference : public testing::TestWithParam<const char*> {};

TEST_P(VerifyReference, OptimaAreThoseOfOtherPrograms) {
  const std::filesystem::path folder = referenceProblems();
  if (folder.empty())
    GTEST_SKIP() << "The reference problems are not here: set POLYFLY_DATA to their folder.";
  const std::filesystem::path path = folder / (std::string(GetParam()) + ".json");
  ParametricProgram program = loadProgramJson(path.string());
  const Eigen::MatrixXd E = program.E, C = program.C;
  const Eigen::VectorXd c = program.c;
  outputAllVariables(program);
  const bool is_linear = program.H.isZero(0.0);
  StrictQp oracle(program, is_linear ? Convexity::kShortest : Convexity::kAsGiven);
  ASSERT_TRUE(oracle.definite());
  // The loop below reads from this object.
  const nlohmann::json problem = readJson(path);
  for (const auto& sample : problem["samples"]) {
    const auto entries = sample["theta"].get<std::vector<double>>();
    const Eigen::VectorXd theta =
        Eigen::Map<const Eigen::VectorXd>(entries.data(), static_cast<Eigen::Index>(entries.size()));
    const StrictAnswer answer = oracle.solve(theta, kPrecision);
    if (!sample["feasible"].get<bool>()) {
      EXPECT_EQ(answer.verdict, StrictAnswer::Verdict::kInfeasible) << sample["theta"];
      continue;
    }
    ASSERT_EQ(answer.verdict, StrictAnswer::Verdict::kOptimal) << sample["theta"];
    const Eigen::VectorXd& z = answer.u;
    const double objective = sample["obj"].get<double>();
    EXPECT_NEAR(z.dot(0.5 * program.H * z + program.f + program.F * theta), objective,
                1e-7 * (1.0 + std::abs(objective)));
    if (is_linear) continue;
    const Eigen::VectorXd output = E * z + C * theta + c;
    const auto u = sample["u"].get<std::vector<double>>();
    for (std::size_t i = 0; i < u.size(); ++i) {
      EXPECT_NEAR(output[static_cast<Eigen::Index>(i)], u[i], 1e-7 * (1.0 + std::abs(u[i])));
    }
  }
}

std::string testName(const testing::TestParamInfo<const char*>& info) { return info.param; }

INSTANTIATE_TEST_SUITE_P(All, VerifyReference,
                         testing::Values("bemporad2002", "deg_di_N5_dup", "deg_di_N5_xf0_ineq",
                                         "deg_facet_to_facet", "deg_licq_ahmadi", "deg_scs_lowdim", "di_N15",
                                         "di_N5_xf0_eq", "invpend_N5_x", "invpend_track_Np50_Nc5",
                                         "mass_spring4_N10", "mass_spring6_N5", "mplp_di_inf_N3",
                                         "mplp_di_inf_N5", "mplp_dual_deg", "mplp_multirotor_inf_N3",
                                         "mplp_primal_deg", "multirotor_N10_soft", "multirotor_N20",
                                         "rnd_n10_m20_t4", "rnd_n5_m40_t3", "rnd_n6_m20_t3"),
                         testName);

TEST_F(Verify, FindsThatEachLawIsOff) {
  const std::size_t width = content.parameters.size() + 1;
  for (std::size_t i = width - 1; i < content.laws.size(); i += width)
    content.laws[i] += 1e-5 * (program.inputs[0].upper - program.inputs[0].lower);
  const VerifyReport wrong = report();
  EXPECT_FALSE(wrong.passed());
  EXPECT_GT(wrong.errors.count, wrong.compared * 9 / 10);
}

// Rows that nearly repeat others make regions that are thinner than what an oracle in doubles can tell apart.
// A sample on such a region's face belongs to the region beside it as far as fractions are concerned: right
// maps were called wrong there.
TEST(VerifyThin, RegionsBesideAFaceHaveAWordToo) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    ParametricProgram program = randomProgram(3, 4, 2, seed);
    Random random(seed);
    const double near = std::pow(10.0, -4.0 - random.below(5));
    for (const int row : {0, 1}) {
      appendRow(program, program.A.row(row).transpose() + near * random.matrix(3, 1),
                program.b(row) + near * random.matrix(1, 1)(0, 0),
                program.S.row(row).transpose() + near * random.matrix(2, 1));
    }
    const MapInMemory map(encode(program, explore(program)));
    VerifyOptions options;
    options.samples = 300;
    const VerifyReport report = verify(map.map(), program, options);
    EXPECT_TRUE(report.passed()) << "seed " << seed << "\n" << verifyText(report);
  }
}

}  // namespace
}  // namespace polyfly
