#include "export_proven/online_code.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "compiled_code.hpp"
#include "map_export/online_solver.hpp"
#include "map_in_memory.hpp"
#include "mpc_core/dense_qp.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "polyfly_base/error.hpp"
#include "project_root.hpp"
#include "random_program.hpp"

// The generated solver, compiled and run, against maps and against DenseQp.
namespace polyfly {
namespace {

using Parameters = std::vector<std::vector<double>>;

Parameters uniformIn(const ParametricProgram& program, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Parameters result(count);
  for (std::vector<double>& theta : result) {
    for (const Signal& signal : program.parameters) {
      const double share = static_cast<double>(random() >> 11) * 0x1p-53;
      theta.push_back(signal.lower + share * (signal.upper - signal.lower));
    }
  }
  return result;
}

OnlineOptions named(ExportType type) {
  OnlineOptions options;
  options.name = "code";
  options.type = type;
  return options;
}

void save(const ScratchFolder& folder, const OnlineCode& code) { writeOnline(code, folder.file(".")); }

/// NAME_solve of a compiled solver, and its workspace's memory.
template <class Real>
class CompiledSolver {
 public:
  CompiledSolver(const ScratchFolder& folder, const std::string& compiler, std::size_t workspace_bytes)
      : workspace_(workspace_bytes / sizeof(double) + 1, std::nan("")) {
    EXPECT_EQ(runCommand(folder, compiler + kStrict + "-shared -fPIC code.c -o code.so"), 0) << logOf(folder);
    handle_ = ::dlopen(folder.file("code.so").c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle_ == nullptr) throw std::runtime_error(::dlerror());
    solve_ = reinterpret_cast<Solve>(::dlsym(handle_, "code_solve"));
  }
  CompiledSolver(const CompiledSolver&) = delete;
  CompiledSolver& operator=(const CompiledSolver&) = delete;
  ~CompiledSolver() { ::dlclose(handle_); }

  OnlineStatus solve(const Real* theta, Real* u) {
    return static_cast<OnlineStatus>(solve_(workspace_.data(), theta, u));
  }

 private:
  using Solve = int (*)(void* workspace, const Real* theta, Real* u);
  std::vector<double> workspace_;
  void* handle_ = nullptr;
  Solve solve_ = nullptr;
};

std::size_t workspaceBytes(const OnlineCode& code) {
  return nlohmann::json::parse(onlineFacts(code.tables, code.options, code.record))
      .at("workspace_bytes")
      .get<std::size_t>();
}

/// The compiled code answers as the solver in C++ does, bit for bit.
template <class Real>
void expectSameBits(const OnlineCode& code, const ScratchFolder& folder, const Parameters& parameters) {
  save(folder, code);
  CompiledSolver<Real> compiled(folder, "gcc -std=c99", workspaceBytes(code));
  OnlineSolver<Real> solver(code.tables, onlineTolerances(code.tables, code.options.type),
                            code.options.iteration_limit);
  const std::size_t m = code.tables.inputs.size();
  for (const std::vector<double>& exact : parameters) {
    const std::vector<Real> theta(exact.begin(), exact.end());
    std::vector<Real> expected(m, 0.5), found(m, 0.5);
    ASSERT_EQ(compiled.solve(theta.data(), found.data()), solver.solve(theta.data(), expected.data()));
    ASSERT_EQ(found, expected);
  }
}

ParametricProgram vehicle(const std::string& name) {
  return loadProgram(projectRoot() + "/region_maps/problems/" + name + ".yaml");
}

/// z = (z_0, z_1), |z_i| <= 1, z_0 + z_1 = theta_0 as an equality, and 0 <= 1 - theta_1 without variables.
ParametricProgram withEquality() {
  ParametricProgram program;
  program.name = "equality";
  program.text_kind = "json";
  program.H = Eigen::Matrix2d::Identity();
  program.f = Eigen::Vector2d::Zero();
  program.F = -Eigen::Matrix2d::Identity();
  program.A.resize(6, 2);
  program.A << 1, 0, -1, 0, 0, 1, 0, -1, 1, 1, 0, 0;
  program.b.resize(6);
  program.b << 1, 1, 1, 1, 0, 1;
  program.S = Eigen::MatrixXd::Zero(6, 2);
  program.S(4, 0) = 1.0;
  program.S(5, 1) = -1.0;
  program.equalities = {4};
  program.parameters = {{"a", "1", -3, 3}, {"b", "1", -3, 3}};
  program.A_theta.resize(0, 2);
  program.b_theta.resize(0);
  program.inputs = {{"z_0", "1", -1, 1}, {"z_1", "1", -1, 1}};
  program.E = Eigen::Matrix2d::Identity();
  program.C = Eigen::Matrix2d::Zero();
  program.c = Eigen::Vector2d::Zero();
  return program;
}

TEST(OnlineCode, VehicleProgramsAnswerAsDenseQpAtAHundredThousandParameters) {
  for (const char* const name : {"multirotor_lateral", "multirotor_vertical", "reference/lateral_asl"}) {
    const ParametricProgram program = vehicle(name);
    const OnlineCode code = tryOnline(program, named(ExportType::kDouble), uniformIn(program, 100000, 3));
    EXPECT_GT(code.record.confirmed, 90000u) << name;
    EXPECT_EQ(code.record.stopped, 0u) << name;
    EXPECT_LT(code.record.error[0], 1e-9) << name;
  }
}

TEST(OnlineCode, AnswersAsTheMapDoes) {
  const ParametricProgram program = vehicle("multirotor_vertical");
  const Partition partition = explore(program, ExploreOptions{});
  const MapInMemory memory(encode(program, partition));
  OnlineSolver<double> solver(onlineTables(program),
                              onlineTolerances(onlineTables(program), ExportType::kDouble), 300);
  std::size_t compared = 0;
  for (const std::vector<double>& theta : uniformIn(program, 100000, 4)) {
    double expected = 0.0, found = 0.0;
    if (memory.map().evaluate(theta.data(), &expected).status != LookupStatus::kInside) continue;
    ASSERT_EQ(solver.solve(theta.data(), &found), OnlineStatus::kOk);
    ASSERT_NEAR(found, expected, 1e-7);
    ++compared;
  }
  EXPECT_GT(compared, 50000u);
}

TEST(OnlineCode, CompiledCodeHasTheBitsOfTheSolverThatIsCounted) {
  const ScratchFolder folder;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    ParametricProgram program = randomProgram(6, 20, 3, seed);
    outputAllVariables(program);
    Parameters parameters = uniformIn(program, 5000, seed);
    // Far outside of the box too, where many have no solution.
    for (std::size_t i = 0; i < parameters.size(); i += 2) {
      for (double& value : parameters[i]) value *= 10.0;
    }
    expectSameBits<double>(tryOnline(program, named(ExportType::kDouble), parameters), folder, parameters);
    expectSameBits<float>(tryOnline(program, named(ExportType::kFloat), parameters), folder, parameters);
  }
}

TEST(OnlineCode, EqualitiesAndRowsWithoutVariablesHold) {
  const ParametricProgram program = withEquality();
  const OnlineCode code = tryOnline(program, named(ExportType::kDouble), uniformIn(program, 20000, 5));
  EXPECT_EQ(code.tables.conditionCount(), 1u);
  EXPECT_GT(code.record.solved, 5000u);
  EXPECT_GT(code.record.infeasible, 5000u);
  EXPECT_LT(code.record.error[0], 1e-9);
  OnlineSolver<double> solver(code.tables, onlineTolerances(code.tables, ExportType::kDouble), 100);
  double u[2] = {0, 0};
  const double theta[2] = {1.5, 0.25};
  ASSERT_EQ(solver.solve(theta, u), OnlineStatus::kOk);
  // The closest point to theta on the segment of z_0 + z_1 = 1.5 within the square.
  EXPECT_NEAR(u[0], 1.0, 1e-12);
  EXPECT_NEAR(u[1], 0.5, 1e-12);
  const double beyond[2] = {0.0, 1.5};
  EXPECT_EQ(solver.solve(beyond, u), OnlineStatus::kInfeasible);
}

TEST(OnlineCode, DegenerateRowsEndInOneAnswer) {
  // Each row of the square three times, once scaled: many active sets describe one solution.
  ParametricProgram program = withEquality();
  program.equalities.clear();
  for (int copy = 0; copy < 2; ++copy) {
    for (int i = 0; i < 5; ++i) {
      const double scale = copy == 0 ? 1.0 : 3.0;
      appendRow(program, scale * program.A.row(i).transpose(), scale * program.b(i),
                scale * program.S.row(i).transpose());
    }
  }
  const OnlineCode code = tryOnline(program, named(ExportType::kDouble), uniformIn(program, 20000, 6));
  EXPECT_EQ(code.record.stopped, 0u);
  EXPECT_LT(code.record.error[1], 1e-9);
}

TEST(OnlineCode, NumbersThatAreNotFiniteAndLimitsLeaveTheInputsAlone) {
  const ScratchFolder folder;
  const ParametricProgram program = vehicle("multirotor_vertical");
  OnlineOptions options = named(ExportType::kFloat);
  const OnlineCode code = tryOnline(program, options, uniformIn(program, 100, 1));
  save(folder, code);
  const std::string compiler = hasProgram("clang") ? "clang" : "gcc";
  CompiledSolver<float> compiled(folder, compiler + " -std=c99", workspaceBytes(code));
  const std::size_t p = program.parameters.size();
  float u = 0.5f;
  for (const float special : {std::nanf(""), INFINITY, -INFINITY, 3e38f}) {
    for (std::size_t k = 0; k < p; ++k) {
      std::vector<float> theta(p, 0.0f);
      theta[k] = special;
      const OnlineStatus status = compiled.solve(theta.data(), &u);
      EXPECT_TRUE(status == OnlineStatus::kNotFinite || special == 3e38f);
      EXPECT_TRUE(status == OnlineStatus::kOk || u == 0.5f);
      EXPECT_TRUE(std::isfinite(u));
      u = 0.5f;
    }
  }
  // A limit of one iteration is reached, and told.
  const OnlineTables tables = onlineTables(program);
  OnlineSolver<float> stopped(tables, onlineTolerances(tables, ExportType::kFloat), 1);
  std::size_t reached = 0;
  for (const std::vector<double>& exact : uniformIn(program, 2000, 7)) {
    const std::vector<float> theta(exact.begin(), exact.end());
    reached += stopped.solve(theta.data(), &u) == OnlineStatus::kIterations;
    ASSERT_LE(stopped.iterations(), 1u);
  }
  EXPECT_GT(reached, 0u);
}

TEST(OnlineCode, TheWorkspaceHasTheStatedSize) {
  const ScratchFolder folder;
  const ParametricProgram program = vehicle("multirotor_lateral");
  for (const ExportType type : {ExportType::kDouble, ExportType::kFloat}) {
    const OnlineCode code = tryOnline(program, named(type), uniformIn(program, 10, 1));
    save(folder, code);
    // An array of a negative size does not compile.
    saveText(folder.file("size.c"), "#include \"code.h\"\nextern char size[sizeof(code_workspace) == " +
                                        std::to_string(workspaceBytes(code)) + "u ? 1 : -1];\n");
    EXPECT_EQ(runCommand(folder, "gcc -std=c99 -c size.c"), 0) << logOf(folder);
  }
}

TEST(OnlineCode, RefusesWhatItCannotSolve) {
  ParametricProgram singular = withEquality();
  singular.H(1, 1) = 0.0;
  EXPECT_THROW(onlineTables(singular), Error);
  ParametricProgram unbounded = withEquality();
  unbounded.equalities.clear();
  unbounded.A.setZero();
  EXPECT_THROW(onlineTables(unbounded), Error);
  const ParametricProgram program = withEquality();
  OnlineOptions options = named(ExportType::kDouble);
  options.iteration_limit = 70000;
  EXPECT_THROW(tryOnline(program, options, {}), Error);
  options = named(ExportType::kDouble);
  options.name = "1";
  EXPECT_THROW(tryOnline(program, options, {}), Error);
  ParametricProgram infeasible = withEquality();
  infeasible.b(5) = -10.0;
  EXPECT_THROW(tryOnline(infeasible, named(ExportType::kDouble), {}), Error);
}

TEST(OnlineCode, TheSameProgramGivesTheSameBytes) {
  const ParametricProgram program = vehicle("multirotor_vertical");
  const Parameters parameters = uniformIn(program, 500, 1);
  const OnlineCode a = tryOnline(program, named(ExportType::kFloat), parameters);
  const OnlineCode b = tryOnline(program, named(ExportType::kFloat), parameters);
  EXPECT_EQ(onlineSource(a.tables, a.options), onlineSource(b.tables, b.options));
  EXPECT_EQ(onlineTest(a.tables, a.options, a.vectors), onlineTest(b.tables, b.options, b.vectors));
  EXPECT_EQ(onlineFacts(a.tables, a.options, a.record), onlineFacts(b.tables, b.options, b.record));
}

}  // namespace
}  // namespace polyfly
