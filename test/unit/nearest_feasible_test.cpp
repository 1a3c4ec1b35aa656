// The nearest feasible parameters of robust maps, against the exact vertices of the feasible set and GLPK.
#include "online_controller/laws/nearest_feasible.hpp"

#include <glpk.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <string>

#include "allocations.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/reduce.hpp"
#include "project_root.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"
#include "robust_mpc/online_lp.hpp"
#include "robust_mpc/robust_law.hpp"

namespace polyfly {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Parameters with ranges mapped to [-1, 1]: rounding of QP and facets, and the way inside that a look-up tolerates.
constexpr double kScaled = 1e-7;
// Distance by which a point is moved to be clearly inside or outside of the set.
constexpr double kClear = 1e-6;

/// A robust problem with its map and the vertices of its feasible set.
struct Solved {
  explicit Solved(const std::string& file) : problem(loadRobustProblem(problemFile(file))) {
    const FeasibleSet set = projectFeasibleSet(buildRobustProgram(problem));
    const int p = problem.parameterCount();
    vertices.resize(static_cast<Eigen::Index>(set.vertices.size()), p);
    for (Eigen::Index i = 0; i < vertices.rows(); ++i)
      for (int j = 0; j < p; ++j)
        vertices(i, j) =
            nearestDouble(set.vertices[static_cast<std::size_t>(i)].y[static_cast<std::size_t>(j)]) / half(j);
    const RoundedLaw law = roundLaw(problem, explicitLaw(problem, set), ExploreStatus::kComplete);
    const std::string path = testing::TempDir() + "nearest_feasible_" + problem.name + ".map";
    writeMap(encode(law.program, law.partition), path);
    map = std::make_unique<RegionMap>(RegionMap::open(path));
    for (const RobustProblem::Parameter& parameter : problem.parameters)
      errors.push_back(parameter.state >= 0);
  }

  /// Half width of a parameter's range, which is symmetric in the problems of this test.
  double half(int j) const { return problem.parameters[static_cast<std::size_t>(j)].signal.upper; }
  VectorXd halves() const {
    VectorXd result(problem.parameterCount());
    for (int j = 0; j < problem.parameterCount(); ++j) result(j) = half(j);
    return result;
  }

  RobustProblem problem;
  std::unique_ptr<RegionMap> map;
  std::vector<bool> errors;
  MatrixXd vertices;  ///< a row each, scaled
};

const std::vector<const char*>& files() {
  static const std::vector<const char*> kFiles{
      "robust/aslquad_lateral.yaml", "robust/aslquad_longitudinal.yaml", "robust/aslquad_vertical.yaml",
      "reference/robust_lateral.yaml", "reference/robust_lateral_4.yaml"};
  return kFiles;
}

const Solved& solvedOnce(const std::string& file) {
  static std::map<std::string, std::unique_ptr<Solved>> known;
  std::unique_ptr<Solved>& solved = known[file];
  if (solved == nullptr) solved = std::make_unique<Solved>(file);
  return *solved;
}

/// Greatest direction . q over the points q of the set with the fixed parameters of `at`, by duality: the least
/// t + y . at with t >= (direction - y) . v for each vertex v, y zero but for fixed parameters. Negative infinity
/// where the set has no such point.
double greatest(const Solved& solved, const std::vector<bool>& movable, const VectorXd& direction,
                const VectorXd& at) {
  const std::unique_ptr<glp_prob, decltype(&glp_delete_prob)> lp(glp_create_prob(), &glp_delete_prob);
  glp_term_out(GLP_OFF);
  const auto p = static_cast<int>(at.size());
  const auto m = static_cast<int>(solved.vertices.rows());
  glp_add_cols(lp.get(), p + 1);
  for (int j = 0; j <= p; ++j) {
    const bool unused = j < p && movable[static_cast<std::size_t>(j)];
    glp_set_col_bnds(lp.get(), j + 1, unused ? GLP_FX : GLP_FR, 0.0, 0.0);
    glp_set_obj_coef(lp.get(), j + 1, j < p ? at(j) : 1.0);
  }
  glp_add_rows(lp.get(), m);
  std::vector<int> index;
  for (int j = 0; j <= p + 1; ++j) index.push_back(j);
  std::vector<double> value(static_cast<std::size_t>(p) + 2);
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < p; ++j) value[static_cast<std::size_t>(j) + 1] = solved.vertices(i, j);
    value.back() = 1.0;
    glp_set_mat_row(lp.get(), i + 1, p + 1, index.data(), value.data());
    glp_set_row_bnds(lp.get(), i + 1, GLP_LO, solved.vertices.row(i).dot(direction), 0.0);
  }
  glp_smcp options;
  glp_init_smcp(&options);
  options.msg_lev = GLP_MSG_OFF;
  EXPECT_EQ(glp_simplex(lp.get(), &options), 0);
  if (glp_get_status(lp.get()) == GLP_UNBND) return -std::numeric_limits<double>::infinity();
  EXPECT_EQ(glp_get_status(lp.get()), GLP_OPT);
  return glp_get_obj_val(lp.get());
}

class Points {
 public:
  explicit Points(unsigned seed) : random_(seed) {}
  /// Entries of up to `size` for errors, and of 1 for references [scaled].
  VectorXd next(const Solved& solved, double size) {
    std::uniform_real_distribution<double> within(-1.0, 1.0);
    VectorXd point(solved.problem.parameterCount());
    for (Eigen::Index j = 0; j < point.size(); ++j)
      point(j) = within(random_) * (solved.errors[static_cast<std::size_t>(j)] ? size : 1.0);
    return point;
  }

 private:
  std::mt19937 random_;
};

// A point of a convex set is the nearest one to s exactly when no point of the set lies further along the way to s.
void expectNearest(const Solved& solved, const std::vector<bool>& movable, const VectorXd& scaled,
                   const VectorXd& nearest) {
  const VectorXd way = scaled - nearest;
  const double room = greatest(solved, movable, way, nearest) - way.dot(nearest);
  EXPECT_LT(room, kScaled * (1.0 + way.norm())) << scaled.transpose() << "\n" << nearest.transpose();
  // It is a point of the set: none of the set's supports along random directions lies before it.
  EXPECT_GT(room, -kScaled * (1.0 + way.norm()));
}

TEST(NearestFeasible, IsNearestAndHasAPlanAtRandomPoints) {
  for (const char* file : files()) {
    const Solved& solved = solvedOnce(file);
    NearestFeasible set(*solved.map, solved.errors);
    OnlineLp plans(solved.problem);
    Points points(11);
    int moved = 0, most = 0;
    for (int trial = 0; trial < 60; ++trial) {
      const VectorXd scaled = points.next(solved, trial % 3 == 0 ? 3.0 : 1.2);
      const VectorXd theta = scaled.cwiseProduct(solved.halves());
      VectorXd nearest(theta.size());
      ASSERT_TRUE(set.find(theta.data(), nearest.data())) << file;
      most = std::max(most, set.iterations());
      const VectorXd at = nearest.cwiseQuotient(solved.halves());
      const bool references_kept = [&] {
        for (Eigen::Index j = 0; j < theta.size(); ++j)
          if (!solved.errors[static_cast<std::size_t>(j)] && nearest(j) != theta(j)) return false;
        return true;
      }();
      const std::vector<bool> all(solved.errors.size(), true);
      if (!references_kept) {
        EXPECT_LT(greatest(solved, solved.errors, VectorXd::Zero(theta.size()), scaled), kScaled) << file;
      }
      expectNearest(solved, references_kept ? solved.errors : all, scaled, at);
      double input = 0.0;
      EXPECT_EQ(solved.map->evaluate(nearest.data(), &input).status, LookupStatus::kInside) << file;
      EXPECT_TRUE(plans.solve((1.0 - kClear) * nearest).feasible) << file;
      moved += (at - scaled).norm() > kClear ? 1 : 0;
    }
    EXPECT_GT(moved, 30) << file;
    EXPECT_LE(most, set.iterationLimit()) << file;
    RecordProperty(solved.problem.name, std::to_string(set.facetCount()) + " facets, at most " +
                                            std::to_string(most) + " of " +
                                            std::to_string(set.iterationLimit()) + " working sets");
  }
}

TEST(NearestFeasible, LeavesWhatIsFeasible) {
  for (const char* file : files()) {
    const Solved& solved = solvedOnce(file);
    NearestFeasible set(*solved.map, solved.errors);
    Points points(5);
    int inside = 0;
    for (int trial = 0; trial < 400; ++trial) {
      const VectorXd theta = points.next(solved, 0.9).cwiseProduct(solved.halves());
      VectorXd nearest(theta.size());
      if (solved.map->locate(theta.data()).status != LookupStatus::kInside) continue;
      ++inside;
      ASSERT_TRUE(set.find(theta.data(), nearest.data()));
      EXPECT_LT((nearest - theta).cwiseQuotient(solved.halves()).norm(), 2.0 * kScaled) << file;
    }
    EXPECT_GT(inside, 20) << file;
  }
}

// Merged regions cover the same set.
TEST(NearestFeasible, IsTheSameForAReducedMap) {
  for (const char* file : files()) {
    const Solved& solved = solvedOnce(file);
    const std::string path = testing::TempDir() + "nearest_feasible_reduced.map";
    writeMap(reduce(*solved.map).content, path);
    const RegionMap reduced = RegionMap::open(path);
    ASSERT_NE(reduced.reducedFrom(), 0u);
    NearestFeasible set(*solved.map, solved.errors), again(reduced, solved.errors);
    EXPECT_EQ(again.facetCount(), set.facetCount()) << file;
    Points points(17);
    for (int trial = 0; trial < 200; ++trial) {
      const VectorXd theta = points.next(solved, 2.0).cwiseProduct(solved.halves());
      VectorXd nearest(theta.size()), other(theta.size());
      ASSERT_TRUE(set.find(theta.data(), nearest.data()));
      ASSERT_TRUE(again.find(theta.data(), other.data()));
      EXPECT_LT((nearest - other).cwiseQuotient(solved.halves()).norm(), kScaled) << file;
    }
  }
}

TEST(NearestFeasible, NeverAllocatesAndRefusesWhatIsNotFinite) {
  const Solved& solved = solvedOnce("reference/robust_lateral.yaml");
  NearestFeasible set(*solved.map, solved.errors);
  Points points(3);
  const VectorXd theta = points.next(solved, 1e5);
  VectorXd nearest = VectorXd::Constant(theta.size(), 7.0), bad = theta;
  bad(1) = std::nan("");
  const long before = polyfly_test::allocationCount();
  const bool bad_found = set.find(bad.data(), nearest.data());
  const bool left_alone = nearest(0) == 7.0;
  const bool found = set.find(theta.data(), nearest.data());
  EXPECT_EQ(polyfly_test::allocationCount(), before);
  EXPECT_FALSE(bad_found);
  EXPECT_TRUE(left_alone);
  EXPECT_TRUE(found);
}

/// Two regions of one law, without half-spaces.
MapContent twoRegions() {
  MapContent content;
  content.name = "made";
  content.solver_status = "complete";
  content.problem_kind = "yaml";
  content.tolerance = 1e-9;
  content.parameters = {{"x", "m", -1.0, 1.0}};
  content.inputs = {{"u", "m", -1.0, 1.0}};
  content.laws = {1.0, 0.0};
  content.regions.resize(2);
  content.root = MapContent::kLeaf;
  content.leaves.push_back({0, 2});
  content.candidates = {0, 1};
  return content;
}

// x <= 0.3 and -0.2 <= x <= 0.8, joined: the planes at -0.2 and 0.3 bound one region each, and are no facets.
TEST(NearestFeasible, OverlappingRegionsOfAReducedMapAreOneSet) {
  MapContent content = twoRegions();
  content.reduced_from = 1;
  content.planes = {1.0, 0.3, 1.0, -0.2, 1.0, 0.8};
  content.rows = {1, -2, 3};
  content.regions[0].row_count = 1;
  content.regions[1].first_row = 1;
  content.regions[1].row_count = 2;
  const std::string path = testing::TempDir() + "nearest_feasible_joined.map";
  writeMap(content, path);
  const RegionMap map = RegionMap::open(path);
  NearestFeasible set(map, {true});
  EXPECT_EQ(set.facetCount(), 1);
  for (const double x : {-3.0, -0.5, 0.1, 0.5, 0.9}) {
    double nearest = 0.0;
    ASSERT_TRUE(set.find(&x, &nearest));
    EXPECT_NEAR(nearest, std::clamp(x, -1.0, 0.8), kScaled);
  }
}

}  // namespace
}  // namespace polyfly
