// Rows that repeat others but for noise: from rounding, by which they count as one, to what is a row of its own.
#include <algorithm>
#include <cmath>

#include "error_of.hpp"
#include "made_program.hpp"
#include "mutation.hpp"
#include "random_program.hpp"

namespace polyfly {
namespace {

constexpr ProgramSize kSizes[] = {{2, 8, 1}, {3, 8, 2}, {4, 10, 2}, {3, 9, 3}};

/// Repeats `row` with noise in all its numbers.
void repeat(ParametricProgram& program, int row, double noise, Random& random) {
  const Eigen::VectorXd a =
      program.A.row(row).transpose() + noise * random.matrix(program.variableCount(), 1);
  const Eigen::VectorXd s =
      program.S.row(row).transpose() + noise * random.matrix(program.parameterCount(), 1);
  appendRow(program, a, program.b(row) + noise * random.uniform(-1.0, 1.0), s);
}

ParametricProgram repeatedInequalities(std::uint64_t seed, const ProgramSize& size, double noise) {
  ParametricProgram program = madeProgram(seed, size);
  Random random(seed + 1000);
  for (int copy = 0; copy < 3; ++copy) repeat(program, random.below(size.rows), noise, random);
  return program;
}

ParametricProgram repeatedEquality(std::uint64_t seed, const ProgramSize& size, double noise) {
  ParametricProgram program = madeProgram(seed, size);
  Random random(seed + 2000);
  program.b(0) *= 0.1;
  program.equalities = {0};
  for (int copy = 0; copy < 3; ++copy) {
    program.equalities.push_back(program.rowCount());
    repeat(program, 0, noise, random);
  }
  return program;
}

TEST(RepeatedRows, MapsAreProvenWhateverTheNoise) {
  std::size_t dropped = 0, kept = 0;
  for (const double noise : {1e-13, 1e-12, 1e-11, 5e-11, 1e-10, 2e-10, 5e-10, 1e-9}) {
    for (const ProgramSize& size : kSizes) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        SCOPED_TRACE(testing::Message()
                     << noise << " " << size.variables << " " << size.parameters << " " << seed);
        const CertifyReport report = proven(repeatedInequalities(seed, size, noise));
        dropped += report.dropped_rows.size();
        kept += report.dropped_rows.empty() ? 1 : 0;
      }
    }
  }
  EXPECT_GT(dropped, 100u);
  EXPECT_GT(kept, 20u);
}

/// `count` random rows, each repeated three times; each number changes by so much of itself.
ParametricProgram repeatedThrice(std::uint64_t seed, int count, double noise,
                                 const ProgramSize& size = {4, 10, 3}) {
  ParametricProgram program = madeProgram(seed, size);
  Random random(seed + 1000);
  const auto changed = [&](double number) {
    return number + noise * random.uniform(-1.0, 1.0) * std::abs(number);
  };
  for (int k = 0; k < count; ++k) {
    const int row = random.below(size.rows);
    for (int copy = 0; copy < 3; ++copy) {
      const Eigen::VectorXd a = program.A.row(row).transpose().unaryExpr(changed);
      const Eigen::VectorXd s = program.S.row(row).transpose().unaryExpr(changed);
      appendRow(program, a, changed(program.b(row)), s);
    }
  }
  return program;
}

struct Repeated {
  std::uint64_t seed;
  int rows;
  double noise;
};

// Planes of regions that are all but parallel cross within the box.
TEST(RepeatedRows, NoLookUpIsLostBetweenPlanesThatAreAllButParallel) {
  for (const Repeated& made : {Repeated{18, 1, 1e-6}, Repeated{22, 1, 1e-6}, Repeated{36, 1, 1e-7}}) {
    SCOPED_TRACE(made.seed);
    proven(repeatedThrice(made.seed, made.rows, made.noise));
  }
}

// Pivots on such half-spaces lose all digits: a leaf once left out a row that it must test.
TEST(RepeatedRows, PivotsThatLoseDigitsLeaveOutNoRow) { proven(repeatedThrice(106, 2, 1e-8, {4, 9, 4})); }

// Of four such half-spaces a dictionary drops one that is needed.
TEST(RepeatedRows, HalfSpacesThatAreAllButParallelAreToldApart) {
  for (const Repeated& made :
       {Repeated{13, 2, 1e-8}, Repeated{24, 2, 1e-8}, Repeated{39, 2, 1e-8}, Repeated{43, 2, 1e-8}}) {
    SCOPED_TRACE(made.seed);
    proven(repeatedThrice(made.seed, made.rows, made.noise));
  }
}

// A slack that is all but constant is negative in a corner of the region.
TEST(RepeatedRows, SlacksThatAreAllButConstantAreHalfSpaces) {
  for (const Repeated& made : {Repeated{41, 2, 1e-10}, Repeated{65, 1, 1e-10}, Repeated{96, 1, 1e-10}}) {
    SCOPED_TRACE(made.seed);
    proven(repeatedThrice(made.seed, made.rows, made.noise));
  }
}

// The planes of the search tree enclose regions that are thousands of times as long as they are wide. Half of the cases
// have regions of a radius below 1e-9, the others cells that parameters reach by rounding alone.
TEST(RepeatedRows, NoCellIsSoThinThatItsRegionsAreLost) {
  for (const Repeated& made : {Repeated{17, 2, 1e-8}, Repeated{41, 1, 1e-8}, Repeated{44, 2, 1e-7},
                               Repeated{30, 1, 1e-6}, Repeated{32, 2, 1e-6}}) {
    SCOPED_TRACE(made.seed);
    proven(repeatedThrice(made.seed, made.rows, made.noise));
  }
  for (const Repeated& made : {Repeated{21, 1, 1e-7}, Repeated{22, 2, 1e-7}, Repeated{2, 3, 1e-6}}) {
    SCOPED_TRACE(testing::Message() << made.seed);
    proven(repeatedThrice(made.seed, made.rows, made.noise, {4, 9, 4}));
  }
}

// A dictionary that drifted away from its rows once lost that a region reaches 5e-12 across a plane.
TEST(RepeatedRows, WhatReachesIntoACellIsDecidedToTheLastDigits) {
  proven(repeatedThrice(122, 3, 1e-10, {4, 9, 4}));
}

TEST(RepeatedRows, AreNamedWhereTheyCountAsTwo) {
  const ProgramSize size{3, 8, 2};
  EXPECT_TRUE(explore(madeProgram(3, size)).near_rows.empty());
  for (const double noise : {1e-12, 1e-8, 1e-6}) {
    const ParametricProgram program = repeatedThrice(3, 1, noise, size);
    const Partition partition = explore(program);
    Random random(3 + 1000);
    const int repeated = random.below(size.rows);
    // Nearer ones count as one.
    const std::vector<int> rows = noise < 1e-10 ? std::vector<int>() : std::vector<int>{repeated, 8, 9, 10};
    EXPECT_EQ(partition.near_rows, rows) << noise;
    const std::string notes = encode(program, partition).solver_notes;
    EXPECT_EQ(notes.find("near_rows: " + std::to_string(repeated) + " 8 9 10\n") != std::string::npos,
              !rows.empty())
        << notes;
  }
}

// Beside a great output, laws of the others that differ by more than a proof allows are not written as one.
TEST(RepeatedRows, LawsThatDifferAreNotSharedBesideAGreatOutput) {
  ParametricProgram program = repeatedThrice(13, 2, 1e-8);
  constexpr double kGreat = 100.0;
  const int n = program.variableCount(), p = program.parameterCount();
  program.E.conservativeResize(n + 1, n);
  program.C.conservativeResize(n + 1, p);
  program.c.conservativeResize(n + 1);
  program.E.row(n).setZero();
  program.C.row(n).setZero();
  program.c(n) = kGreat;
  program.inputs.push_back({"great", "1", -1e3, 1e3});
  proven(program);
}

TEST(RepeatedRows, WrongMapsAreRefuted) {
  for (const double noise : {1e-12, 1e-10, 1e-9}) {
    const ParametricProgram program = repeatedInequalities(2, kSizes[1], noise);
    const Partition whole = explore(program);
    for (std::size_t r = 0; r < whole.regions.size(); ++r) {
      Partition wrong = whole;
      wrong.regions[r].k(0) += 1e-6;
      EXPECT_FALSE(certified(wrong, program).passed()) << noise << ", law of region " << r;
      if (whole.regions[r].radius < 1e-6) continue;
      wrong = whole;
      wrong.regions.erase(wrong.regions.begin() + static_cast<std::ptrdiff_t>(r));
      EXPECT_FALSE(certified(wrong, program).passed()) << noise << ", without region " << r;
    }
  }
}

TEST(RepeatedRows, ARowThatSaysMoreThanAnotherIsNotDropped) {
  for (const double distance : {1e-9, 1e-8, 1e-6}) {
    ParametricProgram program = madeProgram(3, kSizes[1]);
    const Partition partition = explore(program);
    appendRow(program, program.A.row(0), program.b(0) - distance, program.S.row(0));
    EXPECT_FALSE(certified(partition, program).passed()) << distance;
    EXPECT_TRUE(proven(program).dropped_rows.empty()) << distance;
  }
}

TEST(RepeatedRows, ADefectTellsTheSlackThatIsViolated) {
  ParametricProgram program = madeProgram(3, kSizes[1]);
  const Partition partition = explore(program);
  appendRow(program, program.A.row(0), program.b(0) - 1e-6, program.S.row(0));
  const CertifyReport report = certified(partition, program);
  EXPECT_TRUE(std::any_of(report.defects.begin(), report.defects.end(), [](const Defect& defect) {
    return defect.text.find("the slack of row 8 is negative, down to -1e-06") != std::string::npos;
  })) << certifyText(report);
}

std::string errorOfExploring(const ParametricProgram& program) {
  return errorOf([&] { explore(program); });
}

TEST(RepeatedEqualities, OfWhichRoundingIsAllThatDiffersCountAsOne) {
  for (const ProgramSize& size : kSizes) {
    for (const double noise : {1e-16, 1e-15, 1e-14}) {
      SCOPED_TRACE(noise);
      proven(repeatedEquality(1, size, noise));
    }
  }
}

TEST(RepeatedEqualities, AreProvenOrRefusedNextToRounding) {
  for (const ProgramSize& size : kSizes) {
    for (const double noise : {1e-13, 2e-13, 4e-13, 1e-12}) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const ParametricProgram program = repeatedEquality(seed, size, noise);
        if (errorOfExploring(program) != "no error") continue;
        SCOPED_TRACE(noise);
        proven(program);
      }
    }
  }
}

TEST(RepeatedEqualities, ThatNearlyDependAreRefusedByRow) {
  for (const ProgramSize& size : kSizes) {
    for (const double noise : {1e-11, 1e-10, 1e-9, 1e-8, 1e-7}) {
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        EXPECT_TRUE(holds(errorOfExploring(repeatedEquality(seed, size, noise)), "eq_ids: row "))
            << noise << " " << seed;
      }
    }
  }
}

TEST(RepeatedEqualities, ThatContradictEachOtherAreRefusedByRow) {
  for (const double distance : {1e-11, 1e-9, 1e-3}) {
    ParametricProgram program = madeProgram(1, kSizes[1]);
    appendRow(program, program.A.row(0), program.b(0) + distance, program.S.row(0));
    program.equalities = {0, program.rowCount() - 1};
    EXPECT_TRUE(holds(errorOfExploring(program), "its right-hand side does not")) << distance;
  }
}

TEST(ImpliedEqualities, ThatTieTheParametersAreNotBlamedOnTheEqualities) {
  ParametricProgram program = madeProgram(1, kSizes[1]);
  appendRow(program, program.A.row(0), 0.0, Eigen::Vector2d(1.0, 0.0));
  appendRow(program, -program.A.row(0), 0.0, Eigen::Vector2d(-1.0, 0.0));
  appendRow(program, program.A.row(0), 0.0, Eigen::Vector2d(0.0, 1.0));
  appendRow(program, -program.A.row(0), 0.0, Eigen::Vector2d(0.0, -1.0));
  const std::string message = errorOfExploring(program);
  EXPECT_FALSE(holds(message, "eq_ids"));
  EXPECT_TRUE(holds(message, ": row 8: can only hold with equality, on a lower-dimensional set"));
}

TEST(RepeatedEqualities, ThatAreClearlyIndependentAreSolved) {
  for (const double distance : {1e-5, 1e-3}) {
    ParametricProgram program = madeProgram(4, kSizes[2]);
    Random random(4);
    program.S.row(0).setZero();
    program.b(0) = 0.0;
    const Eigen::VectorXd direction = random.matrix(program.variableCount(), 1);
    appendRow(program, program.A.row(0).transpose() + distance * direction, 0.0,
              Eigen::VectorXd::Zero(program.parameterCount()));
    program.equalities = {0, program.rowCount() - 1};
    proven(program);
  }
}

}  // namespace
}  // namespace polyfly
