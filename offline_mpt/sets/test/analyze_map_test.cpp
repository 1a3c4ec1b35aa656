// Closed loops of maps whose behaviour is known, simulation at random, and maps that were tampered with.
#include "polytope_sets/analyze_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "../../test/map_in_memory.hpp"
#include "../../test/random.hpp"
#include "../src/vertex_tests.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "polyfly_base/error.hpp"
#include "polytope_sets/invariant_set.hpp"
#include "project_root.hpp"

namespace polyfly {
namespace {

MapContent solved(const std::string& json) {
  const ParametricProgram program = parseProgramJson(json, "test.json");
  const Partition partition = explore(program);
  EXPECT_EQ(partition.status, ExploreStatus::kComplete);
  return encode(program, partition);
}

/// x+ = x + u + d, u = clip(-x / 2, -1, 1) for |x| <= 5: three regions.
MapContent scalarMap() {
  return solved(R"({"name": "scalar", "H": [[2]], "f": [0], "F": [[1]], "A": [[1], [-1]], "b": [1, 1],
    "B": [[0], [0]], "lb": [-5], "ub": [5]})");
}

SetModel scalarModel(const std::string& d) {
  return parseModel(
      "polyfly_model: 1\nname: scalar\nstates: [{name: theta_0, unit: 1}]\n"
      "inputs: [{name: u_0, unit: 1}]\ndisturbances: [{name: d, unit: 1, range: [-" +
          d + ", " + d + "]}]\nA: [[1]]\nB: [[1]]\nE: [[1]]\n",
      "scalar.yaml");
}

AnalyzeReport analyzed(const MapContent& content, const SetModel& model, const AnalyzeOptions& options = {}) {
  const MapInMemory map(content);
  return analyze(map.map(), bindModel(model, map.map()), options);
}

// Whole numbers without a common factor whose squares are beyond doubles.
TEST(ScaledRows, AreOfUnitLengthForNumbersOfAnySize) {
  const MapInMemory map(scalarMap());
  Integer large, larger;
  mpz_ui_pow_ui(large.get_mpz_t(), 3, 400);
  mpz_ui_pow_ui(larger.get_mpz_t(), 2, 640);
  ExactPolytope set;
  set.dimension = 1;
  set.rows.push_back({{Rational(large)}, Rational(larger)});
  const std::vector<ExactHalfSpace> rows = scaledRows(set, map.map());
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_NEAR(rows[0].a[0].get_d(), 0.2, 1e-15) << "half the range is 5";
  EXPECT_EQ(rows[0].b * large, rows[0].a[0] * larger);
}

SetModel doubleIntegrator(const std::string& d) {
  return parseModel(
      "polyfly_model: 1\nname: double_integrator\n"
      "states: [{name: theta_0, unit: 1, range: [-5, 5]}, {name: theta_1, unit: 1, range: [-5, 5]}]\n"
      "inputs: [{name: u_0, unit: 1, range: [-1, 1]}]\n"
      "disturbances: [{name: d, unit: 1, range: [-" +
          d + ", " + d + "]}]\nA: [[1, 1], [0, 1]]\nB: [[0.5], [1]]\nE: [[0], [1]]\n",
      "double_integrator.yaml");
}

/// min u^2 + ... with the first successor kept in the maximal robust invariant set: recursively feasible by
/// construction, but for the rounding of the rows.
MapContent doubleIntegratorMap(const std::string& d) {
  const SetModel model = doubleIntegrator(d);
  const InvariantSet invariant = maximalInvariantSet(model);
  EXPECT_EQ(invariant.status, InvariantSet::Status::kMaximal);
  std::string A = "[1], [-1]", b = "1, 1", B = "[0, 0], [0, 0]";
  Rational push;
  EXPECT_TRUE(parseRational(d, push));
  const auto number = [](const Rational& value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", nearestDouble(value));
    return std::string(text);
  };
  for (const ExactHalfSpace& row : invariant.set.rows) {
    const Rational scale(1, 1 + static_cast<unsigned long>(std::abs(row.b.get_d())));
    const Rational rest = (row.b - abs(row.a[1]) * push) * scale;
    A += ", [" + number(Rational((row.a[0] / 2 + row.a[1]) * scale)) + "]";
    b += ", " + number(rest);
    B += ", [" + number(Rational(-row.a[0] * scale)) + ", " +
         number(Rational(-(row.a[0] + row.a[1]) * scale)) + "]";
  }
  return solved(R"({"name": "di", "H": [[2]], "f": [0], "F": [[0.2, 0.5]], "A": [)" + A + R"(], "b": [)" + b +
                R"(], "B": [)" + B + R"(], "lb": [-5, -5], "ub": [5, 5]})");
}

TEST(AnalyzeMap, ScalarLoopHoldsUpToItsLimit) {
  // |x + u| <= 4 wherever |x| <= 5, and 4 is reached: what is left for d is 1.
  for (const char* d : {"0.5", "1"}) {
    const AnalyzeReport report = analyzed(scalarMap(), scalarModel(d));
    EXPECT_TRUE(report.holds()) << d;
    EXPECT_TRUE(report.covered);
    EXPECT_EQ(report.domain.size(), 2u);
    EXPECT_EQ(report.offending_regions, 0u);
    EXPECT_LT(report.region_excess, 1e-9);
  }
  const AnalyzeReport report = analyzed(scalarMap(), scalarModel("1.01"));
  EXPECT_FALSE(report.holds());
  EXPECT_TRUE(report.covered);
  EXPECT_EQ(report.offending_regions, 2u);
  EXPECT_NEAR(report.greatest_excess, 0.01 / 5.0, 1e-9);
  ASSERT_TRUE(report.witness.has_value());
  EXPECT_TRUE(report.witness->verified);
  EXPECT_TRUE(report.witness->successor_outside);
  const double x = report.witness->theta[0], u = report.witness->u[0];
  EXPECT_DOUBLE_EQ(u, std::clamp(-x / 2, -1.0, 1.0));
  EXPECT_GT(std::abs(x + u + report.witness->d[0].get_d()), 5.0);
}

// Steps from random parameters of the map with extreme disturbances; returns how many have no answer.
int lost(const RegionMap& map, double d, int count) {
  Random random(17);
  int result = 0, tried = 0;
  while (tried < count) {
    std::vector<double> x = {random.uniform(-5, 5), random.uniform(-5, 5)};
    double u = 0.0;
    if (map.evaluate(x.data(), &u).status != LookupStatus::kInside) continue;
    ++tried;
    for (int step = 0; step < 20; ++step) {
      const double w = random.below(2) == 0 ? d : -d;
      x = {x[0] + x[1] + 0.5 * u, x[1] + u + w};
      if (map.evaluate(x.data(), &u).status == LookupStatus::kInside) continue;
      ++result;
      break;
    }
  }
  return result;
}

TEST(AnalyzeMap, InvariantByConstruction) {
  const MapContent content = doubleIntegratorMap("0.1");
  const MapInMemory map(content);
  const AnalyzeReport report = analyzed(content, doubleIntegrator("0.1"));
  EXPECT_TRUE(report.holds());
  EXPECT_LE(report.greatest_excess, report.tolerance);
  EXPECT_GE(report.regions, 5u);
  EXPECT_EQ(lost(map.map(), 0.1, 300), 0);
}

TEST(AnalyzeMap, MoreDisturbanceThanTheMapWasMadeFor) {
  const MapContent content = doubleIntegratorMap("0.1");
  const MapInMemory map(content);
  const AnalyzeReport report = analyzed(content, doubleIntegrator("0.3"));
  EXPECT_TRUE(report.covered);
  EXPECT_FALSE(report.holds());
  EXPECT_GT(lost(map.map(), 0.3, 300), 0);
  ASSERT_TRUE(report.witness.has_value());
  EXPECT_TRUE(report.witness->verified);
  EXPECT_TRUE(report.witness->successor_outside);
  const std::vector<double>& x = report.witness->theta;
  std::vector<double> u(1);
  ASSERT_EQ(map.map().evaluate(x.data(), u.data()).status, LookupStatus::kInside);
  const double w = report.witness->d[0].get_d();
  const double successor[] = {x[0] + x[1] + 0.5 * u[0], x[1] + u[0] + w};
  EXPECT_NE(map.map().locateExhaustively(successor).status, LookupStatus::kInside);
}

// Every region that is missing is found: the union is no longer the convex polytope that its outer
// half-spaces describe, or the box.
TEST(AnalyzeMap, AMissingRegionIsFound) {
  const MapContent content = doubleIntegratorMap("0.1");
  for (std::size_t r = 0; r < content.regions.size(); ++r) {
    MapContent broken = content;
    broken.regions.erase(broken.regions.begin() + static_cast<std::ptrdiff_t>(r));
    broken.nodes.clear();  // one leaf with all that is left
    broken.root = MapContent::kLeaf;
    broken.leaves = {{0, static_cast<std::uint32_t>(broken.regions.size())}};
    broken.candidates.clear();
    broken.tests.clear();
    for (std::uint32_t k = 0; k < broken.regions.size(); ++k) broken.candidates.push_back(k);
    const MapInMemory map(broken);
    const AnalyzeReport report = analyzed(broken, doubleIntegrator("0.1"));
    EXPECT_FALSE(report.holds()) << r;
    // The remaining union is convex, but no longer invariant.
    if (report.covered) continue;
    ASSERT_TRUE(report.gap.has_value());
    const double gap[] = {(*report.gap)[0].get_d(), (*report.gap)[1].get_d()};
    EXPECT_NE(map.map().locateExhaustively(gap).status, LookupStatus::kInside) << r;
    EXPECT_FALSE(report.successors_inside) << r;
  }
}

TEST(AnalyzeMap, AWrongLawIsFound) {
  const MapContent content = doubleIntegratorMap("0.1");
  int found = 0;
  for (std::size_t k = 0; k < content.laws.size(); k += 3) {
    MapContent broken = content;
    broken.laws[k + 2] += 0.2;
    found += analyzed(broken, doubleIntegrator("0.1")).holds() ? 0 : 1;
  }
  EXPECT_GE(found, static_cast<int>(content.laws.size() / 3) / 2);  // inner regions may bear it
}

TEST(AnalyzeMap, ToleranceForgivesRoundingOnly) {
  const MapContent content = doubleIntegratorMap("0.1");
  AnalyzeOptions options;
  options.tolerance = 0.0;
  const AnalyzeReport strict = analyzed(content, doubleIntegrator("0.1"), options);
  const AnalyzeReport report = analyzed(content, doubleIntegrator("0.1"));
  EXPECT_TRUE(report.holds());
  EXPECT_EQ(strict.holds(), strict.covered && strict.greatest_excess == 0.0);
  EXPECT_LT(strict.greatest_excess, 1e-9);
}

// So wide a tolerance makes every half-space an outer one, and together they hold nothing.
TEST(AnalyzeMap, AToleranceAsWideAsTheDomainIsRefused) {
  AnalyzeOptions options;
  for (const double tolerance : {2.0, 3.0, 100.0, 1e300}) {
    options.tolerance = tolerance;
    EXPECT_THROW(analyzed(scalarMap(), scalarModel("1"), options), Error) << tolerance;
    EXPECT_THROW(analyzed(doubleIntegratorMap("0.1"), doubleIntegrator("0.1"), options), Error) << tolerance;
  }
}

TEST(AnalyzeMap, WithinASet) {
  AnalyzeOptions options;
  options.within = ExactPolytope::box({Rational(-3)}, {Rational(3)});
  EXPECT_TRUE(analyzed(scalarMap(), scalarModel("1"), options).holds());  // |x + u| <= 2 there
  const AnalyzeReport report = analyzed(scalarMap(), scalarModel("1.2"), options);
  EXPECT_FALSE(report.holds());
  ASSERT_TRUE(report.witness.has_value());
  EXPECT_TRUE(report.witness->verified);
  options.within = ExactPolytope::box({Rational(-6)}, {Rational(3)});  // not all in the map
  const AnalyzeReport outside = analyzed(scalarMap(), scalarModel("1"), options);
  EXPECT_FALSE(outside.covered);
  EXPECT_FALSE(outside.holds());
  options.within = ExactPolytope::box({Rational(1), Rational(1)}, {Rational(2), Rational(2)});
  EXPECT_THROW(analyzed(scalarMap(), scalarModel("1"), options), Error);
}

// u_prev and a reference among the parameters: u = clip(r - x / 2), u_prev has no effect.
TEST(AnalyzeMap, ParametersThatAreNoStates) {
  const MapContent content = solved(R"({"name": "three", "H": [[2]], "f": [0], "F": [[1, 0, -2]],
    "A": [[1], [-1]], "b": [1, 1], "B": [[0, 0, 0], [0, 0, 0]], "lb": [-5, -1, -0.5], "ub": [5, 1, 0.5]})");
  const std::string text =
      "polyfly_model: 1\nname: three\nstates: [{name: theta_0, unit: 1}]\ninputs: [{name: u_0, unit: 1}]\n"
      "parameters: [{name: theta_2, unit: 1, next: constant}, {name: theta_1, unit: 1, next: u_0}]\n"
      "A: [[1]]\nB: [[1]]\n";
  EXPECT_TRUE(analyzed(content, parseModel(text, "three")).holds());
  // The reference pushes the state by itself: out at the upper end.
  const AnalyzeReport pushed = analyzed(content, parseModel(text + "A_p: [[3, 0]]\n", "three"));
  EXPECT_FALSE(pushed.holds());
  ASSERT_TRUE(pushed.witness.has_value());
  EXPECT_TRUE(pushed.witness->verified);
}

// The map of the multirotor's vertical axis is a box of errors, which a large error leaves. Within the
// maximal robust invariant set of the law around 0 it is never left.
TEST(AnalyzeMap, AnAxisHoldsInItsInvariantSet) {
  const ParametricProgram program = loadProgram(problemFile("multirotor_vertical.yaml"));
  const MapInMemory memory(encode(program, explore(program)));
  const RegionMap& map = memory.map();
  const ClosedLoopModel loop = bindModel(loadModel(problemFile("models/multirotor_vertical.yaml")), map);
  const AnalyzeReport whole = analyze(map, loop);
  EXPECT_TRUE(whole.covered);
  EXPECT_EQ(whole.domain.size(), 8u);
  EXPECT_FALSE(whole.successors_inside);
  ASSERT_TRUE(whole.witness.has_value());
  EXPECT_TRUE(whole.witness->verified && whole.witness->successor_outside);

  const std::vector<double> zero(4, 0.0);
  const Lookup lookup = map.locate(zero.data());
  ASSERT_EQ(lookup.status, LookupStatus::kInside);
  SetModel inner;  // theta+ = (F + G K) theta + E d + G k + c
  inner.A = loop.F;
  inner.B = RationalMatrix(4, 0);
  inner.E = loop.E;
  inner.c = loop.c;
  inner.D = loop.D;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) inner.A(i, j) += loop.G(i, 0) * Rational(map.law(lookup.law)[j]);
    inner.c[static_cast<std::size_t>(i)] += loop.G(i, 0) * Rational(map.law(lookup.law)[4]);
  }
  inner.X.dimension = 4;
  const RegionView view = map.region(lookup.region);
  for (std::uint32_t k = 0; k < view.row_count; ++k) {
    const double* plane = map.plane(static_cast<std::size_t>(std::abs(view.rows[k])) - 1);
    const double sign = view.rows[k] > 0 ? 1.0 : -1.0;
    ExactHalfSpace row;
    for (int j = 0; j < 4; ++j) row.a.emplace_back(sign * plane[j]);
    row.b = Rational(sign * plane[4]);
    inner.X.rows.push_back(row);
  }
  InvariantOptions options;
  options.exact = false;
  const InvariantSet invariant = maximalInvariantSet(inner, options);
  ASSERT_EQ(invariant.status, InvariantSet::Status::kMaximal);
  EXPECT_TRUE(contains(invariant.set, RationalVector(4)));
  AnalyzeOptions within;
  within.within = invariant.set;
  const AnalyzeReport report = analyze(map, loop, within);
  EXPECT_TRUE(report.holds()) << analyzeJson(report, map, SetModel());
  for (ExactHalfSpace& row : within.within->rows)
    row.b *= Rational(11, 10);  // but no larger one of its shape
  EXPECT_FALSE(analyze(map, loop, within).holds());
}

TEST(AnalyzeMap, BindsByNameAndUnit) {
  const MapInMemory map(scalarMap());
  const std::string states = "polyfly_model: 1\nname: a\nA: [[1]]\nB: [[1]]\n";
  for (const char* rest : {"states: [{name: x, unit: 1}]\ninputs: [{name: u_0, unit: 1}]\n",
                           "states: [{name: theta_0, unit: m}]\ninputs: [{name: u_0, unit: 1}]\n",
                           "states: [{name: theta_0, unit: 1}]\ninputs: [{name: u_1, unit: 1}]\n"}) {
    EXPECT_THROW(bindModel(parseModel(states + rest, "a"), map.map()), Error) << rest;
  }
}

TEST(AnalyzeMap, ThreadsDoNotMatter) {
  const MapContent content = doubleIntegratorMap("0.1");
  const MapInMemory map(content);
  const SetModel model = doubleIntegrator("0.3");
  const ClosedLoopModel loop = bindModel(model, map.map());
  AnalyzeOptions options;
  const std::string one = analyzeJson(analyze(map.map(), loop, options), map.map(), model);
  options.threads = 4;
  EXPECT_EQ(analyzeJson(analyze(map.map(), loop, options), map.map(), model), one);
}

}  // namespace
}  // namespace polyfly
