#include <gtest/gtest.h>

#include <set>

#include "compiled_code.hpp"
#include "export_proven/online_code.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "project_root.hpp"

// The generated solver on a Cortex-M4 in an emulator, and under a checker of coding rules.
namespace polyfly {
namespace {

std::string harness(const std::string& name) {
  return projectRoot() + "/region_maps/region_maps/export/test/" + name;
}

OnlineCode solverCode(ExportType type) {
  const ParametricProgram program =
      loadProgram(projectRoot() + "/region_maps/problems/multirotor_vertical.yaml");
  OnlineOptions options;
  options.name = "code";
  options.type = type;
  std::vector<std::vector<double>> parameters;
  for (int i = 0; i < 200; ++i) {
    std::vector<double> theta;
    for (std::size_t k = 0; k < program.parameters.size(); ++k) {
      const Signal& signal = program.parameters[k];
      const double share = static_cast<double>((i * (3 + 4 * k) + 7 * k) % 101) / 100.0;
      theta.push_back(signal.lower + share * (signal.upper - signal.lower));
    }
    parameters.push_back(theta);
  }
  return tryOnline(program, options, parameters);
}

class OnlineOnCortexM4 : public testing::TestWithParam<ExportType> {};

TEST_P(OnlineOnCortexM4, ItsOwnTestPassesAndSeesChangedLimits) {
  if (!hasProgram("arm-none-eabi-gcc") || !hasProgram("qemu-system-arm"))
    GTEST_SKIP() << "no arm-none-eabi-gcc or qemu-system-arm";
  const ScratchFolder folder;
  OnlineCode code = solverCode(GetParam());
  writeOnline(code, folder.file("."));
  const auto run = [&] {
    const std::string build = std::string(kCortexM4f) + " -std=c99 -DCODE_TEST_NO_MAIN -nostartfiles -T " +
                              harness("cortex_m4.ld") + kStrict + harness("cortex_m4_start.c") +
                              " code.c code_test.c -o code.elf";
    EXPECT_EQ(runCommand(folder, build), 0) << logOf(folder);
    return runCommand(folder,
                      "timeout 60 qemu-system-arm -M mps2-an386 -nographic -semihosting-config "
                      "enable=on,target=native -kernel code.elf");
  };
  EXPECT_EQ(run(), 0) << logOf(folder);
  for (double& limit : code.tables.limits) limit *= 1.01;
  saveText(folder.file("code.c"), onlineSource(code.tables, code.options));
  EXPECT_GT(run(), 0) << logOf(folder);
}

TEST_P(OnlineOnCortexM4, InstructionsAreWithinTheStatedBound) {
  if (!hasProgram("arm-none-eabi-gcc")) GTEST_SKIP() << "no arm-none-eabi-gcc";
  const ScratchFolder folder;
  writeOnline(solverCode(GetParam()), folder.file("."));
  const std::size_t stated = onlineCodeBytes(GetParam());
  EXPECT_LE(codeBytes(folder, kCortexM4f, "-Os", "-Wl,-e,code_solve"), stated);
  const std::size_t fast = codeBytes(folder, kCortexM4f, "-O2", "-Wl,-e,code_solve");
  EXPECT_LE(fast, stated);
  EXPECT_LE(2 * stated, 3 * fast);
}

INSTANTIATE_TEST_SUITE_P(Types, OnlineOnCortexM4, testing::Values(ExportType::kDouble, ExportType::kFloat));

// region_maps/region_maps/export/README.md lists the deviations.
TEST(OnlineTargets, MisraDeviationsAreTheListedOnes) {
  if (!hasProgram("cppcheck")) GTEST_SKIP() << "no cppcheck";
  const ScratchFolder folder;
  writeOnline(solverCode(ExportType::kFloat), folder.file("."));
  expectListedDeviations(misraDeviations(folder), folder);
}

}  // namespace
}  // namespace polyfly
