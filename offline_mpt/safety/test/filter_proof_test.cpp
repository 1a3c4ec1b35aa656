// The proof of a safe set and of a map's answers: what holds is proven, what was changed is refuted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "made_filters.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "polyfly_base/error.hpp"
#include "polytope_sets/exact_polytope.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"
#include "safety_filter/prove_filter.hpp"
#include "safety_filter/safe_set.hpp"
#include "safety_filter/uncertain_model.hpp"
#include "scratch_folder.hpp"

namespace polyfly {
namespace {

MadeFilter disturbed() {
  MadeFilter made;
  made.margin = 1e-5;
  made.disturbance = 0.3;
  made.input_error = 1e-6;
  made.error = 1e-3;
  return made;
}

SafetyFilterProblem completed(const MadeFilter& made) {
  const SafetyFilterProblem problem = made.problem();
  return parseSafetyFilter(withSafeSet(problem, computeSafeSet(problem)), "made.yaml");
}

// Every vertex of {(xi, u) : xi in S, u admissible}, with every corner of the uncertainty: convexity does the
// rest. None of it is in the proof.
TEST(FilterProof, AgreesWithAllVerticesAndCorners) {
  for (const double delay : {0.0, 0.02}) {
    MadeFilter made = disturbed();
    made.delay = delay;
    const SafetyFilterProblem problem = completed(made);
    ASSERT_TRUE(proveFilter(problem).holds()) << proveFilter(problem).failure;
    const SafeSet& set = *problem.safe_set;
    const UncertainModel model = uncertainModel(problem);
    const int n = model.stateCount();
    ExactPolytope pairs = ExactPolytope::box(model.lower, model.upper);
    pairs.dimension = n + 1;
    for (ExactHalfSpace& row : pairs.rows) row.a.emplace_back(0);
    for (ExactHalfSpace row : exactSet(set).rows) {
      row.a.emplace_back(0);
      pairs.rows.push_back(row);
    }
    for (Eigen::Index i = 0; i < set.G.rows(); ++i) {
      ExactHalfSpace row{{}, Rational(set.b[i])};
      for (int j = 0; j < n; ++j) row.a.emplace_back(-set.M(i, j));
      row.a.emplace_back(set.G(i, 0));
      pairs.rows.push_back(row);
    }
    for (const int sign : {1, -1}) {
      ExactHalfSpace row{RationalVector(static_cast<std::size_t>(n) + 1), 2};
      row.a.back() = sign;
      pairs.rows.push_back(row);
    }
    const ExactPolytope target = exactSet(set);
    const std::vector<RationalVector> corners = vertices(pairs);
    EXPECT_GT(corners.size(), 20u);
    for (const RationalVector& corner : corners) {
      for (int signs = 0; signs < 1 << n; ++signs) {
        RationalVector next;
        for (int i = 0; i < n; ++i) {
          const auto at = static_cast<std::size_t>(i);
          Rational value = model.c[at] + (((signs >> i) & 1) != 0 ? model.W[at] : Rational(-model.W[at]));
          for (int j = 0; j < n; ++j) value += model.A(i, j) * corner[static_cast<std::size_t>(j)];
          next.push_back(value + model.B(i, 0) * corner.back());
        }
        EXPECT_TRUE(contains(target, next));
      }
    }
  }
}

TEST(FilterProof, RefutesEveryChangeOfASet) {
  const SafetyFilterProblem right = completed(disturbed());
  const Eigen::Index rows = right.safe_set->H.rows();
  const auto refuted = [&](const char* what, auto change) {
    for (Eigen::Index row = 0; row < rows; ++row) {
      SafetyFilterProblem wrong = right;
      change(*wrong.safe_set, row);
      const FilterProof proof = proveFilter(wrong);
      EXPECT_FALSE(proof.holds()) << what << ", row " << row;
      EXPECT_FALSE(proof.failure.empty());
    }
  };
  refuted("a weaker bound", [](SafeSet& set, Eigen::Index row) { set.b[row] += 1e-6; });
  refuted("an input that counts less", [](SafeSet& set, Eigen::Index row) { set.G(row, 0) *= 0.999; });
  refuted("a state that counts more", [](SafeSet& set, Eigen::Index row) { set.M(row, 1) += 1e-3; });
  refuted("a set that is tighter", [](SafeSet& set, Eigen::Index row) { set.k[row] -= 1e-4; });
  refuted("a facet that is gone", [](SafeSet& set, Eigen::Index row) {
    set.H.row(row).setZero();
    set.G.row(row).setZero();
    set.M.row(row).setZero();
    set.b[row] = -1.0;
  });
  SafetyFilterProblem wide = right;
  wide.safe_set->k *= 1.01;
  EXPECT_FALSE(proveFilter(wide).holds());
  SafetyFilterProblem windy = right;
  windy.disturbances[0].upper += 0.01;
  EXPECT_FALSE(proveFilter(windy).holds());
  SafetyFilterProblem weak = right;
  weak.inputs[0].upper -= 0.01;
  EXPECT_FALSE(proveFilter(weak).holds());
  SafetyFilterProblem open = right;
  open.safe_set->H.setZero();
  open.safe_set->k.setOnes();
  EXPECT_EQ(proveFilter(open).failure, "the set is unbounded");
}

class FilterMap : public ::testing::Test {
 protected:
  MapContent solved(const SafetyFilterProblem& problem) {
    const ParametricProgram program = filterProgram(problem);
    return encode(program, explore(program));
  }
  RegionMap written(const MapContent& content) {
    writeMap(content, scratch_.file("made.map"));
    return RegionMap::open(scratch_.file("made.map"));
  }
  ScratchFolder scratch_;
};

// One input: the nearest admissible one is the wish, clipped.
TEST_F(FilterMap, ClipsTheWishToTheAdmissibleInputs) {
  const SafetyFilterProblem problem = completed(disturbed());
  const SafeSet& set = *problem.safe_set;
  const RegionMap map = written(solved(problem));
  EXPECT_LE(map.regionCount(), 200u);
  ASSERT_EQ(map.parameters()[2].name, "a_wish");
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int answered = 0, unchanged = 0;
  for (int i = 0; i < 20000; ++i) {
    const double theta[] = {1.5 * unit(random), 1.5 * unit(random), 5.0 * unit(random)};
    if ((set.k - set.H * Eigen::Vector2d(theta[0], theta[1])).minCoeff() < 0.0) continue;
    double lower = -2.0, upper = 2.0;
    for (Eigen::Index row = 0; row < set.G.rows(); ++row) {
      const double bound = set.b[row] + set.M(row, 0) * theta[0] + set.M(row, 1) * theta[1];
      double& end = set.G(row, 0) > 0.0 ? upper : lower;
      end = set.G(row, 0) > 0.0 ? std::min(end, bound / set.G(row, 0)) : std::max(end, bound / set.G(row, 0));
    }
    double u = 0.0;
    ASSERT_EQ(map.evaluate(theta, &u).status, LookupStatus::kInside);
    ++answered;
    EXPECT_NEAR(u, std::clamp(theta[2], lower, upper), 1e-7);
    if (theta[2] > lower + 1e-4 && theta[2] < upper - 1e-4) {
      EXPECT_EQ(u, theta[2]);
      ++unchanged;
    }
  }
  EXPECT_GT(answered, 5000);
  EXPECT_GT(unchanged, 2000);
  const FilterAnswers answers = proveAnswers(map, problem);
  EXPECT_TRUE(answers.hold()) << answers.used;
  EXPECT_GT(answers.used, 0.0);
}

TEST_F(FilterMap, ChangedLawsAreRefuted) {
  MadeFilter made = disturbed();
  made.period = 0.3;
  const SafetyFilterProblem problem = completed(made);
  const MapContent right = solved(problem);
  ASSERT_TRUE(proveAnswers(written(right), problem).hold());
  const std::size_t columns = 4, laws = right.laws.size() / columns;
  EXPECT_GT(laws, 8u);
  for (std::size_t law = 0; law < laws; ++law) {
    const auto refuted = [&](double change) {
      MapContent wrong = right;
      wrong.laws[law * columns + 3] += change;
      return !proveAnswers(written(wrong), problem).hold();
    };
    // One sign leads outwards. At the range of the input the actuator ends too, so neither may.
    const double* row = &right.laws[law * columns];
    const bool constant = row[0] == 0.0 && row[1] == 0.0 && row[2] == 0.0;
    EXPECT_TRUE(constant || refuted(1e-3) || refuted(-1e-3)) << "law " << law;
  }
}

TEST_F(FilterMap, WishesThatComeBackChangedAreRefuted) {
  const SafetyFilterProblem problem = completed(disturbed());
  MapContent wrong = solved(problem);
  int changed = 0;
  for (std::size_t law = 0; law < wrong.laws.size() / 4; ++law) {
    double& slope = wrong.laws[law * 4 + 2];
    if (slope != 1.0) continue;
    slope = std::nextafter(1.0, 0.0);
    ++changed;
  }
  EXPECT_EQ(changed, 1);
  EXPECT_FALSE(proveAnswers(written(wrong), problem).passes_wishes);
}

}  // namespace
}  // namespace polyfly
