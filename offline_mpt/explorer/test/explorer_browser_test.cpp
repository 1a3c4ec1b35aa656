#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <numeric>
#include <random>
#include <sstream>

#include "browser_page.hpp"
#include "explorer_content/explorer_content.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/program_oracle.hpp"
#include "project_root.hpp"
#include "random_program.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"
#include "scratch_folder.hpp"
#include "synthetic_map.hpp"

namespace polyfly {
namespace {

using Json = nlohmann::json;

constexpr int kPoints = 1000;
// Of a command that the page writes with four digits.
constexpr double kShownDigits = 1e-3;
// Of numbers that browser and library sum in the same order.
constexpr double kSameSum = 1e-12;
// Of a model that is integrated in steps instead of discretised.
constexpr double kIntegration = 1e-8;
// Of costs: a KKT system in the browser, an interior-point method here.
constexpr double kCostError = 1e-6;

void run(const std::string& arguments) {
  ASSERT_EQ(std::system((std::string(OFFLINE_MPT_PROGRAM) + " " + arguments + " > /dev/null").c_str()), 0)
      << arguments;
}

/// Moves theta onto the nearest facet of its region: there, the last bit of a sum decides which region answers.
void moveToFacet(const RegionMap& map, std::vector<double>* theta) {
  const Lookup found = map.locate(theta->data());
  if (found.status != LookupStatus::kInside) return;
  const std::size_t p = theta->size();
  const RegionView region = map.region(found.region);
  const double* nearest = nullptr;
  double least = 0.0;
  for (std::uint32_t i = 0; i < region.row_count; ++i) {
    const double* plane = map.plane(static_cast<std::size_t>(std::abs(region.rows[i])) - 1);
    const double distance = std::inner_product(plane, plane + p, theta->data(), -plane[p]);
    if (nearest != nullptr && std::abs(distance) >= std::abs(least)) continue;
    nearest = plane;
    least = distance;
  }
  if (nearest == nullptr) return;
  const double square = std::inner_product(nearest, nearest + p, nearest, 0.0);
  for (std::size_t i = 0; i < p; ++i) (*theta)[i] -= least / square * nearest[i];
}

/// Half of the points anywhere in the box and a little around it, half on facets.
std::vector<std::vector<double>> pointsOf(const RegionMap& map, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> part(-1.02, 1.02);
  std::vector<std::vector<double>> points;
  for (int k = 0; k < kPoints; ++k) {
    std::vector<double> theta;
    for (const Signal& signal : map.parameters())
      theta.push_back(0.5 * (signal.lower + signal.upper) +
                      0.5 * part(random) * (signal.upper - signal.lower));
    if (k % 2 == 1) moveToFacet(map, &theta);
    points.push_back(theta);
  }
  return points;
}

ExplorerFlight asFlight(const std::vector<std::vector<double>>& points) {
  ExplorerFlight flight{"points", {}, {}};
  for (const std::vector<double>& theta : points) {
    flight.times.push_back(static_cast<double>(flight.times.size()));
    flight.thetas.insert(flight.thetas.end(), theta.begin(), theta.end());
  }
  return flight;
}

std::string savePage(const ScratchFolder& folder, const RegionMap& map, const ExplorerContent& content) {
  const std::string path = folder.file("page.html");
  std::ofstream(path, std::ios::binary) << explorerPage(map, content);
  return path;
}

/// The number that leads a text; U+2212 is its minus.
double shownNumber(std::string text) {
  if (text.rfind("\xe2\x88\x92", 0) == 0) text = "-" + text.substr(3);
  const std::size_t exponent = text.find("e\xe2\x88\x92");
  if (exponent != std::string::npos) text.replace(exponent, 4, "e-");
  return std::strtod(text.c_str(), nullptr);
}

void expectSameAnswers(const RegionMap& map, const std::vector<std::vector<double>>& points,
                       const Json& answers) {
  ASSERT_EQ(answers.size(), points.size());
  std::vector<double> u(map.inputs().size());
  std::size_t inside = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Json& answer = answers[k];
    const Lookup found = map.evaluate(points[k].data(), u.data());
    if (found.status != LookupStatus::kInside) {
      EXPECT_EQ(answer["title"], "Outside the map") << "point " << k;
      EXPECT_EQ(answer["status"],
                found.status == LookupStatus::kOutsideBox ? "outside the box" : "outside the partition");
      continue;
    }
    ++inside;
    const std::string kind = found.region >= map.firstFallback() ? "Fallback region " : "Region ";
    EXPECT_EQ(answer["title"], kind + std::to_string(found.region)) << "point " << k;
    for (std::size_t j = 0; j < u.size(); ++j)
      EXPECT_NEAR(answer["u"][j].get<double>(), u[j], kSameSum * (1.0 + std::abs(u[j]))) << "point " << k;
    EXPECT_NEAR(shownNumber(answer["shown"]), u[0], kShownDigits * std::abs(u[0]) + kSameSum)
        << "point " << k;
  }
  EXPECT_GT(inside, points.size() / 10);
}

class Explorer : public ::testing::Test {
 protected:
  void SetUp() override {
    if (chromiumProgram().empty())
      GTEST_SKIP() << "no chromium in PATH: the page is not tested (apt-get install chromium)";
  }

  std::string solve(const std::string& file) {
    run("solve " + file + " --quiet -o " + folder_.file("solved.map"));
    return folder_.file("solved.map");
  }

  void expectSameAnswers(const std::string& map_path) {
    const RegionMap map = RegionMap::open(map_path);
    const std::vector<std::vector<double>> points = pointsOf(map, 5);
    std::ofstream samples(folder_.file("samples.csv"));
    samples << std::setprecision(17);
    for (std::size_t k = 0; k < points.size(); ++k) {
      samples << k;
      for (const double value : points[k]) samples << "," << value;
      samples << "\n";
    }
    samples.close();
    run("explore " + map_path + " --samples " + folder_.file("samples.csv") + " -o " +
        folder_.file("page.html"));
    const Json report = reportOf(folder_.file("page.html"));
    polyfly::expectSameAnswers(map, points, report["answers"]);
    expectVisits(map, points, report);
  }

  void expectVisits(const RegionMap& map, const std::vector<std::vector<double>>& points,
                    const Json& report) {
    std::vector<int> visits(map.regionCount());
    std::size_t outside = 0;
    for (const std::vector<double>& theta : points) {
      const Lookup found = map.locate(theta.data());
      if (found.status == LookupStatus::kInside) {
        ++visits[found.region];
      } else {
        ++outside;
      }
    }
    EXPECT_EQ(report["visited"].get<std::vector<int>>(), visits);
    std::size_t told = 0;
    for (const Json& excursion : report["excursions"])
      told += excursion["last"].get<std::size_t>() - excursion["first"].get<std::size_t>() + 1;
    EXPECT_EQ(told, outside);
  }

  ScratchFolder folder_;
};

TEST_F(Explorer, AnswersAsEvalOfATrackingMapWithFiveParameters) {
  expectSameAnswers(solve(problemFile("multirotor_lateral.yaml")));
}

TEST_F(Explorer, AnswersAsEvalOfATrackingMapWithFourParameters) {
  expectSameAnswers(solve(problemFile("multirotor_vertical.yaml")));
}

TEST_F(Explorer, AnswersAsEvalOfTheReferenceMap) {
  expectSameAnswers(solve(problemFile("reference/lateral_asl.yaml")));
}

TEST_F(Explorer, AnswersAsEvalOfARobustMap) {
  expectSameAnswers(solve(problemFile("robust/aslquad_vertical.yaml")));
}

TEST_F(Explorer, AnswersAsEvalOfAReducedMapWithFallbackRegions) {
  const std::string reduced = folder_.file("reduced.map");
  run("reduce " + solve(problemFile("multirotor_lateral.yaml")) + " --separate --quiet -o " + reduced);
  ASSERT_LT(RegionMap::open(reduced).firstFallback(), RegionMap::open(reduced).regionCount());
  expectSameAnswers(reduced);
}

TEST_F(Explorer, SlicesHoldTheRegionsThatLookUpsFind) {
  const RegionMap map = RegionMap::open(solve(problemFile("multirotor_lateral.yaml")));
  const std::string page = savePage(folder_, map, explorerContent(map));
  const Json report = reportOf(page, "x=e_v_y&y=phi_cmd_ref&at=0.9,0,-0.13,0.21,0");
  EXPECT_EQ(report["x"], 1);
  EXPECT_EQ(report["y"], 4);
  std::vector<double> theta = report["theta"];
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> weight(0.1, 1.0);
  double area = 0.0;
  ASSERT_GT(report["slice"].size(), 20u);
  for (const Json& item : report["slice"]) {
    const std::vector<double> corners = item["polygon"];
    double sum = 0.0, x = 0.0, y = 0.0, twice = 0.0;
    for (std::size_t i = 0; i < corners.size(); i += 2) {
      const double share = weight(random);
      sum += share;
      x += share * corners[i];
      y += share * corners[i + 1];
      const std::size_t next = (i + 2) % corners.size();
      twice += corners[i] * corners[next + 1] - corners[next] * corners[i + 1];
    }
    area += 0.5 * std::abs(twice);
    theta[1] = x / sum;
    theta[4] = y / sum;
    EXPECT_EQ(map.locate(theta.data()).region, item["region"].get<std::uint32_t>());
  }
  // No state constraints: the regions fill the box.
  EXPECT_NEAR(area, 6.0 * 0.5, 1e-9);
}

TEST_F(Explorer, CostIsThatOfTheOptimalInputs) {
  const std::string file = problemFile("multirotor_vertical.yaml");
  const RegionMap map = RegionMap::open(solve(file));
  const MpcProblem mpc = loadProblem(file);
  const DiscreteModel model = discretise(mpc, mpc.sampling_time);
  const Eigen::MatrixXd P = solveRiccati(model.A, model.B, mpc.Q, mpc.R);
  ParametricProgram program = condense(mpc);
  outputAllVariables(program);
  ProgramOracle oracle(program);
  ExplorerContent content = explorerContent(map);
  const std::vector<std::vector<double>> points = pointsOf(map, 8);
  content.flight = asFlight(points);
  const Json answers = reportOf(savePage(folder_, map, content))["answers"];
  int compared = 0;
  for (std::size_t k = 0; k < points.size(); k += 10) {
    if (answers[k]["status"] != "inside") continue;
    const Eigen::VectorXd theta = Eigen::Map<const Eigen::VectorXd>(points[k].data(), 4);
    const OracleAnswer& answer = oracle.solve(theta);
    if (answer.verdict != OracleAnswer::Verdict::kFeasible) continue;
    // Eq. 4, step by step, in the order of the parameters: errors of two states, previous input, reference.
    Eigen::VectorXd e = theta.head(2);
    double previous = theta(2) - theta(3);
    double cost = 0.0;
    for (int step = 0; step < mpc.horizon; ++step) {
      const double input = answer.u(step);
      cost += e.dot(mpc.Q * e) + mpc.R(0, 0) * input * input +
              mpc.R_delta(0, 0) * (input - previous) * (input - previous);
      e = (model.A * e + model.B * input).eval();
      previous = input;
    }
    cost += e.dot(P * e);
    EXPECT_NEAR(answers[k]["cost"].get<double>(), cost, kCostError * (1.0 + cost));
    ++compared;
  }
  EXPECT_GT(compared, 50);
}

/// One period of x' = A e + B u + G w by the classical Runge-Kutta method.
Eigen::VectorXd integrate(const MpcProblem& problem, Eigen::VectorXd e, const Eigen::VectorXd& drive) {
  constexpr int kSteps = 200;
  const double h = problem.sampling_time / kSteps;
  const auto slope = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return problem.A_c * x + drive; };
  for (int k = 0; k < kSteps; ++k) {
    const Eigen::VectorXd k1 = slope(e);
    const Eigen::VectorXd k2 = slope(e + 0.5 * h * k1);
    const Eigen::VectorXd k3 = slope(e + 0.5 * h * k2);
    const Eigen::VectorXd k4 = slope(e + h * k3);
    e += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return e;
}

void expectFlight(const RegionMap& map, const MpcProblem& problem, const Json& flight,
                  std::size_t reference) {
  const auto nx = static_cast<Eigen::Index>(problem.states.size());
  std::vector<double> u(map.inputs().size());
  ASSERT_GE(flight["inputs"].size(), 40u);
  for (std::size_t k = 0; k < flight["inputs"].size(); ++k) {
    const std::vector<double> theta = flight["thetas"][k];
    const std::vector<double> next = flight["thetas"][k + 1];
    ASSERT_EQ(map.evaluate(theta.data(), u.data()).status, LookupStatus::kInside);
    EXPECT_NEAR(flight["inputs"][k][0].get<double>(), u[0], kSameSum);
    const Eigen::VectorXd e = Eigen::Map<const Eigen::VectorXd>(theta.data(), nx);
    const Eigen::VectorXd expected = integrate(problem, e, problem.B_c * (u[0] - theta[reference]));
    for (Eigen::Index i = 0; i < nx; ++i)
      EXPECT_NEAR(next[static_cast<std::size_t>(i)], expected(i), kIntegration);
    EXPECT_EQ(next[reference], theta[reference]);
  }
}

TEST_F(Explorer, FliesTheContinuousModelOfATrackingProblem) {
  const RegionMap map = RegionMap::open(solve(problemFile("multirotor_lateral.yaml")));
  const Json report = reportOf(savePage(folder_, map, explorerContent(map)), "at=1.1,0.4,-0.2,0.1,0.12");
  expectFlight(map, parseFlightModel(std::string(map.problemText()), "map"), report["flight"], 4);
  EXPECT_EQ(report["flight"]["thetas"][1][3], report["flight"]["inputs"][0][0]);
  EXPECT_NE(report["text"].get<std::string>().find("phi_cmd at its"), std::string::npos) << report["text"];
}

TEST_F(Explorer, ADragAndAnArrowKeyMoveTheStateAndItsFlight) {
  const RegionMap map = RegionMap::open(solve(problemFile("multirotor_lateral.yaml")));
  const Json report =
      reportOf(savePage(folder_, map, explorerContent(map)), "x=e_p_y&y=e_v_y&at=1,1,0.1,0,0.05");
  const Json& dragged = report["moved"]["dragged"];
  const std::vector<double> theta = dragged["theta"];
  EXPECT_NEAR(theta[0], -1.5, kSameSum);
  EXPECT_NEAR(theta[1], -1.5, kSameSum);
  EXPECT_EQ((std::vector<double>{theta[2], theta[3], theta[4]}), (std::vector<double>{0.1, 0.0, 0.05}));
  EXPECT_EQ(dragged["flight"]["thetas"][0], dragged["theta"]);
  EXPECT_NEAR(report["moved"]["pressed"]["theta"][0].get<double>(), -1.5 + 0.01 * 6.0, kSameSum);
}

TEST_F(Explorer, FliesTheContinuousModelOfARobustProblem) {
  const RegionMap map = RegionMap::open(solve(problemFile("robust/aslquad_lateral.yaml")));
  ASSERT_EQ(map.parameters()[4].name, "phi_cmd_ref");
  const Json report = reportOf(savePage(folder_, map, explorerContent(map)), "at=0.4,0.1,0,0,0.05");
  expectFlight(map, parseFlightModel(std::string(map.problemText()), "map"), report["flight"], 4);
}

TEST_F(Explorer, GenericProgramHasCostAndNoFlight) {
  ParametricProgram program = randomProgram(4, 12, 3, 7);
  std::ofstream file(folder_.file("generic.json"));
  const auto rows = [](const Eigen::MatrixXd& matrix) {
    Json list = Json::array();
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      const Eigen::RowVectorXd row = matrix.row(i);
      list.push_back(std::vector<double>(row.data(), row.data() + row.size()));
    }
    return list;
  };
  const auto numbers = [](const Eigen::VectorXd& vector) {
    return std::vector<double>(vector.data(), vector.data() + vector.size());
  };
  file << Json{{"H", rows(program.H)}, {"f", numbers(program.f)}, {"F", rows(program.F)},
               {"A", rows(program.A)}, {"b", numbers(program.b)}, {"B", rows(program.S)},
               {"lb", {-1, -1, -1}},   {"ub", {1, 1, 1}}};
  file.close();
  const RegionMap map = RegionMap::open(solve(folder_.file("generic.json")));
  ExplorerContent content = explorerContent(map);
  EXPECT_FALSE(content.model);
  EXPECT_NE(content.no_model.find("generic program"), std::string::npos);
  const std::vector<std::vector<double>> points = pointsOf(map, 2);
  content.flight = asFlight(points);
  const Json report = reportOf(savePage(folder_, map, content));
  polyfly::expectSameAnswers(map, points, report["answers"]);
  EXPECT_TRUE(report["flight"].is_null());
  ProgramOracle oracle(program);
  for (std::size_t k = 0; k < points.size(); k += 20) {
    if (report["answers"][k]["status"] != "inside") continue;
    const OracleAnswer& answer = oracle.solve(Eigen::Map<const Eigen::VectorXd>(points[k].data(), 3));
    if (answer.verdict != OracleAnswer::Verdict::kFeasible) continue;
    EXPECT_NEAR(report["answers"][k]["cost"].get<double>(), answer.objective,
                kCostError * (1.0 + std::abs(answer.objective)));
  }
}

TEST_F(Explorer, HostileNamesStayText) {
  MapContent content = makeTreeMap({});
  const MadeMap plain(content);
  content.name = "</script><script>document.title='x'</script>";
  content.parameters[0].name = "<img src=x onerror=document.title='y'>";
  content.parameters[1].name = "\"><h1 id=title>&lt;b&gt; x=1&y=2 %41#";
  content.parameters[2].name = "__proto__";
  content.inputs[0].name = "constructor";
  content.inputs[0].unit = "</option><b>";
  const MadeMap hostile(content);
  const Json expected = reportOf(savePage(folder_, plain.map, explorerContent(plain.map)));
  const Json report = reportOf(savePage(folder_, hostile.map, explorerContent(hostile.map)));
  EXPECT_EQ(report["title"], content.name + ": region map");
  EXPECT_EQ(report["elements"], expected["elements"]);
  EXPECT_EQ(report["slice"], expected["slice"]);
}

TEST_F(Explorer, OpensMapsOfOneParameterOfEightAndOfTenThousandRegions) {
  struct Case {
    std::uint32_t parameters, regions;
  };
  for (const auto& [parameters, regions] :
       {Case{1, 12}, Case{2, 1}, Case{8, 200}, Case{9, 60}, Case{3, 10000}}) {
    TreeRecipe recipe;
    recipe.parameters = parameters;
    recipe.regions = regions;
    recipe.holes_one_in = regions > 1 ? 9 : 0;
    recipe.names_tests = parameters % 2 == 1;
    recipe.leaf_regions = 3;
    const MadeMap made(makeTreeMap(recipe));
    ExplorerContent content = explorerContent(made.map);
    const std::vector<std::vector<double>> points = pointsOf(made.map, parameters);
    content.flight = asFlight(points);
    const Json report = reportOf(savePage(folder_, made.map, content));
    polyfly::expectSameAnswers(made.map, points, report["answers"]);
    EXPECT_FALSE(report["slice"].empty()) << parameters << " parameters";
  }
}

TEST_F(Explorer, OpensAMapOfTheFirstVersion) {
  const MapContent content = makeTreeMap({});
  AlignedBytes bytes(layOutVersion1(content));
  const RegionMap map = RegionMap::view(bytes.data(), bytes.size(), "version 1");
  ExplorerContent shown = explorerContent(map);
  const std::vector<std::vector<double>> points = pointsOf(map, 1);
  shown.flight = asFlight(points);
  polyfly::expectSameAnswers(map, points, reportOf(savePage(folder_, map, shown))["answers"]);
}

TEST_F(Explorer, ABrokenAddressOpensTheStartView) {
  const MadeMap made(makeTreeMap({}));
  const std::string page = savePage(folder_, made.map, explorerContent(made.map));
  const Json expected = reportOf(page);
  const Json report = reportOf(page, "x=%E0%A4%A&y=nothing&colour=__proto__&at=1,,2&input=-1&theme=none");
  for (const char* field : {"x", "y", "theta", "slice"}) EXPECT_EQ(report[field], expected[field]) << field;
}

}  // namespace
}  // namespace polyfly
