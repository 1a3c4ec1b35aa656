#include "export_online.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "export_proven/export_proven.hpp"
#include "export_proven/online_code.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/read_problem.hpp"
#include "region_maps/region_map.hpp"
#include "verify/parameter_sampler.hpp"

namespace polyfly {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kUniform = 20000;
/// Parameters in, on and beside each region of a map, on average.
constexpr std::size_t kOfRegion = 20;
constexpr std::size_t kMaxOfRegions = 400000;

using Parameters = std::vector<std::vector<double>>;

void append(Parameters& parameters, const Eigen::VectorXd& theta) {
  parameters.emplace_back(theta.data(), theta.data() + theta.size());
}

bool isProblemFile(const std::string& path) {
  const std::string kind = std::filesystem::path(path).extension();
  return kind == ".yaml" || kind == ".yml" || kind == ".json";
}

/// Uniform in the box of the program.
Parameters inBox(const ParametricProgram& program) {
  std::mt19937_64 random(kSeed);
  Parameters parameters(kUniform);
  for (std::vector<double>& theta : parameters) {
    for (const Signal& signal : program.parameters) {
      const double share = static_cast<double>(random() >> 11) * 0x1p-53;
      theta.push_back(signal.lower + share * (signal.upper - signal.lower));
    }
  }
  return parameters;
}

Parameters inRegions(const RegionMap& map) {
  ParameterSampler sampler(map, kSeed, 0);
  Parameters parameters;
  const std::size_t count = std::min(kMaxOfRegions, kOfRegion * map.regionCount());
  for (std::size_t i = 0; i < count; ++i) append(parameters, sampler.degenerate().theta);
  return parameters;
}

void print(const OnlineCode& code) {
  const OnlineRecord& record = code.record;
  std::printf("%s: %u variables, %u rows with %u sides\n", code.options.name.c_str(), code.tables.variables,
              code.tables.rowCount(), code.tables.sideCount());
  std::printf("tried at %" PRIu64 " parameters: %" PRIu64 " solved, %" PRIu64 " infeasible, %" PRIu64
              " at the iteration limit; %" PRIu64 " confirmed by another solver\n",
              record.parameters, record.solved, record.infeasible, record.stopped, record.confirmed);
  std::printf("most iterations %u of %u\n", record.iterations, code.options.iteration_limit);
}

}  // namespace

void exportOnline(const OnlineArguments& arguments) {
  const std::string& source = arguments.source;
  if (isProblemFile(source)) {
    checkExportOutputs(arguments.folder, arguments.options.name, filesOfProblem(source));
    const ParametricProgram program = loadProgram(source);
    const OnlineCode code = tryOnline(program, arguments.options, inBox(program));
    writeOnline(code, arguments.folder);
    return print(code);
  }
  checkExportOutputs(arguments.folder, arguments.options.name, {source});
  const RegionMap map = RegionMap::open(source);
  const ParametricProgram program =
      parseProgram(std::string(map.problemText()), std::string(map.problemKind()), source + ": problem text");
  Parameters parameters = inBox(program);
  for (std::vector<double>& theta : inRegions(map)) parameters.push_back(std::move(theta));
  const OnlineCode code = tryOnline(program, arguments.options, parameters);
  writeOnline(code, arguments.folder);
  print(code);
}

}  // namespace polyfly
