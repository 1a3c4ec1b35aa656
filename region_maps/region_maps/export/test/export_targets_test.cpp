#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "compiled_code.hpp"
#include "map_export/export_map.hpp"
#include "project_root.hpp"
#include "synthetic_map.hpp"

// Exported code on the processors that it is for, in emulators, and under a checker of coding rules.
namespace polyfly {
namespace {

std::string file(const std::string& name) {
  return projectRoot() + "/region_maps/region_maps/export/test/" + name;
}

MapContent content(std::uint32_t parameters = 3) {
  TreeRecipe recipe;
  recipe.parameters = parameters;
  recipe.inputs = 2;
  recipe.regions = 40;
  recipe.leaf_regions = 3;
  recipe.holes_one_in = 4;
  MapContent result = makeTreeMap(recipe);
  // The laws' answers lie within, so that integers need not limit them.
  for (Signal& input : result.inputs) input = {input.name, input.unit, -10.0, 10.0};
  return result;
}

/// One law for all regions: near a facet, floats may take either side.
MapContent contentOfOneLaw() {
  MapContent map = content();
  for (std::size_t i = 0; i < map.laws.size(); ++i) map.laws[i] = map.laws[i % (2 * 4)];
  return map;
}

/// As for a proof: far more than rounding, far less than a law's change below.
double boundOf(ExportType type) { return type == ExportType::kDouble ? 0.0 : 1e-4; }

/// Bytes of stack by function, as `-fstack-usage` writes them: "code.c:45:13:code_evaluate 64 static".
std::map<std::string, int> stackOf(const std::string& usage) {
  std::map<std::string, int> bytes;
  std::istringstream lines(usage);
  for (std::string place, kind; lines >> place;) {
    int count = 0;
    if (!(lines >> count >> kind)) break;
    const std::string name = place.substr(place.rfind(':') + 1);
    const std::string prefix = "code_";
    if (kind == "static" && name.compare(0, prefix.size(), prefix) == 0)
      bytes[name.substr(prefix.size())] = count;
  }
  return bytes;
}

/// Bytes of evaluate, of locate, which it calls, and of what that calls in turn; functions that were inlined have none.
int stackOfLookup(const std::string& usage) {
  std::map<std::string, int> bytes = stackOf(usage);
  EXPECT_GT(bytes["evaluate"], 0) << usage;
  const int test = bytes["violation"] + bytes["holds"] + bytes["distance"];
  return bytes["evaluate"] + bytes["locate"] + std::max(test, bytes["test_box"]);
}

/// The capital before the first point that follows one, as the program on the ATmega sends its result.
std::optional<char> letterSent(const std::string& log) {
  for (std::size_t at = log.find('.'); at != std::string::npos; at = log.find('.', at + 1)) {
    if (at > 0 && log[at - 1] >= 'A' && log[at - 1] <= 'Z') return log[at - 1];
  }
  return std::nullopt;
}

class ExportTargets : public testing::Test {
 protected:
  void save(ExportType type, const MapContent& map) const {
    const MadeMap made(map);
    ExportOptions options;
    options.name = "code";
    options.type = type;
    const double error = boundOf(type);
    const ExportBound bound = {std::vector<double>(map.inputs.size(), error), error, {}, {}};
    saveText(folder.file("code.c"), exportSource(made.map, options));
    if (test_is_saved) return;
    saveText(folder.file("code.h"), exportHeader(made.map, options, bound));
    saveText(folder.file("code_test.c"), exportTest(made.map, options, bound));
  }

  /// The code of the map, then that of a changed law against the same test.
  template <class Run>
  void expectTestTells(ExportType type, const Run& run) {
    MapContent map = contentOfOneLaw();
    save(type, map);
    EXPECT_EQ(run(), 0) << logOf(folder);
    test_is_saved = true;
    for (double& number : map.laws) number += 0.1;
    save(type, map);
    EXPECT_GT(run(), 0) << logOf(folder);
  }

  /// For few and many parameters, at each level of optimisation.
  void expectStackWithinBound(ExportType type, const std::string& compiler) const {
    for (const std::uint32_t parameters : {1u, 8u}) {
      const MapContent map = content(parameters);
      save(type, map);
      ExportOptions options;
      options.name = "code";
      options.type = type;
      const std::size_t stated = exportStackBytes(MadeMap(map).map, options);
      for (const char* const level : {"-O0", "-O2"}) {
        ASSERT_EQ(runCommand(folder, compiler + kStrict + level + " -fstack-usage -c code.c -o code.o"), 0);
        ASSERT_EQ(runCommand(folder, "cat code.su"), 0);
        EXPECT_LE(static_cast<std::size_t>(stackOfLookup(logOf(folder))), stated)
            << parameters << level << logOf(folder);
      }
    }
  }

  /// For few and many parameters, of which nine are added in a loop. `bytes` is the bound for that processor.
  void expectCodeWithinBound(ExportType type, const std::string& compiler,
                             std::size_t FlashBytes::*bytes) const {
    const char* const kEntries = "-Wl,-e,code_evaluate -Wl,-u,code_locate";
    for (const std::uint32_t parameters : {1u, 3u, 8u, 9u}) {
      const MapContent map = content(parameters);
      save(type, map);
      ExportOptions options;
      options.name = "code";
      options.type = type;
      const std::size_t stated = exportFlashBytes(MadeMap(map).map, options).*bytes;
      EXPECT_LE(codeBytes(folder, compiler, "-Os", kEntries), stated) << parameters;
      const std::size_t fast = codeBytes(folder, compiler, "-O2", kEntries);
      EXPECT_LE(fast, stated) << parameters;
      // A sum of one product is shorter.
      if (parameters > 1) {
        EXPECT_LE(2 * stated, 3 * fast) << parameters;
      }
    }
  }

  ScratchFolder folder;
  bool test_is_saved = false;
};

class OnCortexM4 : public ExportTargets, public testing::WithParamInterface<ExportType> {};

TEST_P(OnCortexM4, ItsOwnTestPassesAndSeesChangedLaws) {
  if (!hasProgram("arm-none-eabi-gcc") || !hasProgram("qemu-system-arm"))
    GTEST_SKIP() << "no arm-none-eabi-gcc or qemu-system-arm";
  const std::string build = std::string(kCortexM4f) + " -std=c99 -DCODE_TEST_NO_MAIN -nostartfiles -T " +
                            file("cortex_m4.ld") + kStrict + "-fstack-usage " + file("cortex_m4_start.c") +
                            " code.c code_test.c -o code.elf";
  expectTestTells(GetParam(), [&] {
    const int compiled = runCommand(folder, build);
    EXPECT_EQ(compiled, 0) << logOf(folder);
    return runCommand(folder,
                      "timeout 60 qemu-system-arm -M mps2-an386 -nographic -semihosting-config "
                      "enable=on,target=native -kernel code.elf");
  });
  ASSERT_EQ(runCommand(folder, "cat *code.su"), 0);
  EXPECT_LE(stackOfLookup(logOf(folder)), GetParam() == ExportType::kDouble ? 256 : 128) << logOf(folder);
}

TEST_P(OnCortexM4, StackIsWithinTheStatedBound) {
  if (!hasProgram("arm-none-eabi-gcc")) GTEST_SKIP() << "no arm-none-eabi-gcc";
  expectStackWithinBound(GetParam(), kCortexM4f);
}

TEST_P(OnCortexM4, InstructionsAreWithinTheStatedBound) {
  if (!hasProgram("arm-none-eabi-gcc")) GTEST_SKIP() << "no arm-none-eabi-gcc";
  expectCodeWithinBound(GetParam(), kCortexM4f, &FlashBytes::cortex_m4f);
}

INSTANTIATE_TEST_SUITE_P(Types, OnCortexM4, testing::Values(ExportType::kDouble, ExportType::kFloat));

class OnAtmega328p : public ExportTargets, public testing::WithParamInterface<ExportType> {};

TEST_P(OnAtmega328p, ItsOwnTestPassesAndSeesChangedLaws) {
  if (!hasProgram("avr-gcc") || !hasProgram("simavr")) GTEST_SKIP() << "no avr-gcc or simavr";
  const std::string build = std::string(kAtmega328p) + " -std=c99 -DCODE_TEST_NO_MAIN" + kStrict +
                            file("atmega328p_start.c") + " code.c code_test.c -o code.elf";
  expectTestTells(GetParam(), [&] {
    EXPECT_EQ(runCommand(folder, build), 0) << logOf(folder);
    EXPECT_EQ(runCommand(folder, "timeout 60 simavr -m atmega328p -f 16000000 code.elf"), 0) << logOf(folder);
    const std::string log = logOf(folder);
    const std::optional<char> letter = letterSent(log);
    EXPECT_TRUE(letter.has_value()) << log;
    return letter ? *letter - 'A' : -1;
  });
}

TEST_P(OnAtmega328p, StackIsWithinTheStatedBound) {
  if (!hasProgram("avr-gcc")) GTEST_SKIP() << "no avr-gcc";
  expectStackWithinBound(GetParam(), kAtmega328p);
}

TEST_P(OnAtmega328p, InstructionsAreWithinTheStatedBound) {
  if (!hasProgram("avr-gcc")) GTEST_SKIP() << "no avr-gcc";
  expectCodeWithinBound(GetParam(), kAtmega328p, &FlashBytes::atmega328p);
}

INSTANTIATE_TEST_SUITE_P(Types, OnAtmega328p, testing::Values(ExportType::kFloat));

class UnderCppcheck : public ExportTargets, public testing::WithParamInterface<ExportType> {};

// region_maps/region_maps/export/README.md lists the deviations.
TEST_P(UnderCppcheck, MisraDeviationsAreTheListedOnes) {
  if (!hasProgram("cppcheck")) GTEST_SKIP() << "no cppcheck";
  save(GetParam(), content());
  expectListedDeviations(misraDeviations(folder, "-U__AVR__"), folder);
}

INSTANTIATE_TEST_SUITE_P(Types, UnderCppcheck, testing::Values(ExportType::kFloat));

// Warnings are errors, in C and in C++.
TEST_F(ExportTargets, FloatsCompileEverywhereAndPassTheirTest) {
  int tried = 0;
  save(ExportType::kFloat, contentOfOneLaw());
  for (const char* const compiler :
       {"gcc -std=c99", "clang -std=c99", "g++ -x c++ -std=c++17", "clang++ -x c++ -std=c++11"}) {
    if (!hasProgram(std::string(compiler).substr(0, std::string(compiler).find(' ')))) continue;
    EXPECT_EQ(runCommand(folder, std::string(compiler) + kStrict + "code.c code_test.c -o code && ./code"), 0)
        << compiler << logOf(folder);
    ++tried;
  }
  if (tried < 4) GTEST_SKIP() << "only " << tried << " of 4 compilers are installed";
}

}  // namespace
}  // namespace polyfly
