#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include "browser_page.hpp"
#include "explorer_fixture.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "project_root.hpp"
#include "random_program.hpp"
#include "synthetic_map.hpp"
#include "verify/strict_qp.hpp"

namespace polyfly {
namespace {

using Json = nlohmann::json;

// Of a model that is integrated in steps instead of discretised.
constexpr double kIntegration = 1e-8;
// Of costs: a KKT system in the browser, a dual active-set method here.
constexpr double kCostError = 1e-6;
constexpr double kPrecision = 1e-10;  // of inputs

TEST_F(Explorer, SlicesHoldTheRegionsThatLookUpsFind) {
  const RegionMap map = RegionMap::open(solve(problemFile("multirotor_lateral.yaml")));
  const std::string page = savePage(map, explorerContent(map));
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
  StrictQp oracle(program, Convexity::kAsGiven);
  ExplorerContent content = explorerContent(map);
  const std::vector<std::vector<double>> points = pointsOf(map, 8);
  content.flight = asFlight(points);
  const Json answers = reportOf(savePage(map, content))["answers"];
  int compared = 0;
  for (std::size_t k = 0; k < points.size(); k += 10) {
    if (answers[k]["status"] != "inside") continue;
    const Eigen::VectorXd theta = Eigen::Map<const Eigen::VectorXd>(points[k].data(), 4);
    const StrictAnswer answer = oracle.solve(theta, kPrecision);
    if (answer.verdict != StrictAnswer::Verdict::kOptimal) continue;
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
  const Json report = reportOf(savePage(map, explorerContent(map)), "at=1.1,0.4,-0.2,0.1,0.12");
  expectFlight(map, parseFlightModel(std::string(map.problemText()), "map"), report["flight"], 4);
  EXPECT_EQ(report["flight"]["thetas"][1][3], report["flight"]["inputs"][0][0]);
  EXPECT_NE(report["text"].get<std::string>().find("phi_cmd at its"), std::string::npos) << report["text"];
}

TEST_F(Explorer, ADragAndAnArrowKeyMoveTheStateAndItsFlight) {
  const RegionMap map = RegionMap::open(solve(problemFile("multirotor_lateral.yaml")));
  const Json report = reportOf(savePage(map, explorerContent(map)), "x=e_p_y&y=e_v_y&at=1,1,0.1,0,0.05");
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
  const Json report = reportOf(savePage(map, explorerContent(map)), "at=0.4,0.1,0,0,0.05");
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
  const Json report = reportOf(savePage(map, content));
  expectSameAnswers(map, points, report["answers"]);
  EXPECT_TRUE(report["flight"].is_null());
  outputAllVariables(program);
  StrictQp oracle(program, Convexity::kAsGiven);
  for (std::size_t k = 0; k < points.size(); k += 20) {
    if (report["answers"][k]["status"] != "inside") continue;
    const Eigen::VectorXd theta = Eigen::Map<const Eigen::VectorXd>(points[k].data(), 3);
    const StrictAnswer answer = oracle.solve(theta, kPrecision);
    if (answer.verdict != StrictAnswer::Verdict::kOptimal) continue;
    const double cost = answer.u.dot(0.5 * program.H * answer.u + program.f + program.F * theta);
    EXPECT_NEAR(report["answers"][k]["cost"].get<double>(), cost, kCostError * (1.0 + std::abs(cost)));
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
  const Json expected = reportOf(savePage(plain.map, explorerContent(plain.map)));
  const Json report = reportOf(savePage(hostile.map, explorerContent(hostile.map)));
  EXPECT_EQ(report["title"], content.name + ": region map");
  EXPECT_EQ(report["elements"], expected["elements"]);
  EXPECT_EQ(report["slice"], expected["slice"]);
}

TEST_F(Explorer, ABrokenAddressOpensTheStartView) {
  const MadeMap made(makeTreeMap({}));
  const std::string page = savePage(made.map, explorerContent(made.map));
  const Json expected = reportOf(page);
  const Json report = reportOf(page, "x=%E0%A4%A&y=nothing&colour=__proto__&at=1,,2&input=-1&theme=none");
  for (const char* field : {"x", "y", "theta", "slice"}) EXPECT_EQ(report[field], expected[field]) << field;
}

}  // namespace
}  // namespace polyfly
