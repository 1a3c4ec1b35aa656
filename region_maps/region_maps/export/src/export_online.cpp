#include "map_export/export_online.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "code_tables.hpp"
#include "floating_arithmetic.hpp"
#include "map_facts.hpp"
#include "online_header_template.hpp"
#include "online_source_template.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Shares of the terms of a limit: some of their rounding errors.
constexpr double kFeasibleDouble = 0x1p-44;
constexpr double kFeasibleFloat = 0x1p-20;
// A row counts as dependent where its pivot is down to some rounding errors of a sum of products.
constexpr double kDependentDouble = 0x1p-33;
constexpr double kDependentFloat = 0x1p-17;
constexpr double kRateDouble = 0x1p-40;
constexpr double kRateFloat = 0x1p-18;

// Active sides are solved for, with the condition of their Gram matrix.
constexpr double kActiveSlack = 16.0;

/// Bounds of the solver's instructions on a Cortex-M4F, as GCC translates it with -Os or -O2, with routines for doubles.
constexpr std::size_t kCodeDouble = 6300;
constexpr std::size_t kCodeFloat = 3100;

constexpr std::uint32_t kIterationsPerRow = 10;
constexpr std::uint32_t kLeastIterations = 30;

bool isDouble(const OnlineOptions& options) { return options.type == ExportType::kDouble; }

/// Sum of the terms of each side's limit, each at its greatest over the ranges of the parameters.
std::vector<double> greatestTerms(const OnlineTables& tables) {
  const std::size_t p = tables.parameters.size();
  std::vector<double> result;
  for (std::size_t i = 0; i < tables.limits.size(); i += p + 1) {
    double sum = std::abs(tables.limits[i + p]);
    for (std::size_t k = 0; k < p; ++k) {
      const Signal& signal = tables.parameters[k];
      sum += std::abs(tables.limits[i + k]) * std::max(std::abs(signal.lower), std::abs(signal.upper));
    }
    result.push_back(sum);
  }
  return result;
}

void check(const OnlineTables& tables, const OnlineOptions& options) {
  checkExportName(options.name);
  if (options.type != ExportType::kDouble && options.type != ExportType::kFloat)
    throw Error("--type: the online solver needs double or float");
  if (options.iteration_limit < 1 || options.iteration_limit > std::numeric_limits<std::uint16_t>::max())
    throw Error("--iteration-limit: must be 1 to 65535, got " + std::to_string(options.iteration_limit));
  // Products of indices of packed triangles must fit 16 bits, the least size of unsigned int.
  constexpr std::uint32_t kMaxVariables = 250;
  if (tables.variables > kMaxVariables || tables.sideCount() > std::numeric_limits<std::uint16_t>::max())
    throw Error(tables.program_name + ": the online solver takes at most 250 variables and 65535 sides");
  if (isDouble(options)) return;
  for (const std::vector<double>* table :
       {&tables.rows, &tables.limits, &tables.conditions, &tables.law, &tables.effect}) {
    for (const double value : *table) {
      if (!std::isfinite(static_cast<float>(value)))
        throw Error("--type float: " + tables.program_name + " has a number that exceeds float");
    }
  }
}

std::size_t factorSize(const OnlineTables& tables) {
  return std::size_t{tables.activeLimit()} * (tables.activeLimit() + 1) / 2;
}

Replacements onlineKeys(const OnlineTables& tables, const OnlineOptions& options) {
  const auto number = [](std::size_t value) { return std::to_string(value); };
  Replacements keys = sharedKeys(
      {options.name, options.type, tables.problem_text, tables.parameters.size(), tables.inputs.size()});
  keys["program_name"] = commentText(tables.program_name);
  keys["n"] = number(tables.variables);
  keys["rows"] = number(tables.rowCount());
  keys["sides"] = number(tables.sideCount());
  keys["active"] = number(tables.activeLimit());
  keys["active1"] = number(tables.activeLimit() + 1);
  keys["active_type"] = tables.sideCount() <= 256 ? "uint8_t" : "uint16_t";
  keys["factor_size"] = number(factorSize(tables));
  keys["limit"] = number(options.iteration_limit);
  return keys;
}

/// Bytes of the constant tables.
std::size_t tableBytes(const OnlineTables& tables, const OnlineOptions& options) {
  constexpr std::size_t kTolerances = 3;
  const std::size_t reals = tables.rows.size() + tables.limits.size() + tables.conditions.size() +
                            tables.law.size() + tables.effect.size() + tables.sideCount() + kTolerances;
  return reals * (isDouble(options) ? sizeof(double) : sizeof(float)) +
         indexBytes(tables.sides) * tables.sides.size();
}

/// Bytes of the workspace where unsigned int has 4, as the compilers of 32-bit processors lay it out.
std::size_t workspaceBytes(const OnlineTables& tables, const OnlineOptions& options) {
  const std::size_t real = isDouble(options) ? sizeof(double) : sizeof(float);
  const std::size_t active = tables.activeLimit() + 1;
  std::size_t bytes =
      real * (tables.sideCount() + 2 * std::size_t{tables.variables} + 3 * active + factorSize(tables));
  bytes += active * (tables.sideCount() <= 256 ? sizeof(std::uint8_t) : sizeof(std::uint16_t));
  const auto aligned = [](std::size_t value, std::size_t unit) { return (value + unit - 1) / unit * unit; };
  return aligned(aligned(bytes, sizeof(std::uint32_t)) + 2 * sizeof(std::uint32_t), real);
}

}  // namespace

OnlineTolerances onlineTolerances(const OnlineTables& tables, ExportType type) {
  const bool is_double = type == ExportType::kDouble;
  OnlineTolerances tolerances = {greatestTerms(tables), kActiveSlack,
                                 is_double ? kDependentDouble : kDependentFloat,
                                 is_double ? kRateDouble : kRateFloat};
  for (double& value : tolerances.feasible) value *= is_double ? kFeasibleDouble : kFeasibleFloat;
  return tolerances;
}

std::uint32_t defaultIterationLimit(const OnlineTables& tables) {
  return kIterationsPerRow * (tables.variables + tables.rowCount()) + kLeastIterations;
}

std::size_t onlineCodeBytes(ExportType type) {
  return type == ExportType::kDouble ? kCodeDouble : kCodeFloat;
}

std::string onlineSource(const OnlineTables& tables, const OnlineOptions& options) {
  check(tables, options);
  const OnlineTolerances tolerances = onlineTolerances(tables, options.type);
  const std::size_t p1 = tables.parameters.size() + 1;
  Replacements keys = onlineKeys(tables, options);
  keys["active_slack"] = constant(tolerances.active_slack, options.type);
  keys["dependent"] = constant(tolerances.dependent, options.type);
  keys["rate_zero"] = constant(tolerances.rate, options.type);
  keys["row_table"] = initialiser(tables.rows, tables.variables, options.type);
  keys["side_type"] = "uint" + std::to_string(8 * indexBytes(tables.sides)) + "_t";
  keys["side_table"] = initialiser(tables.sides, 0);
  keys["limit_table"] = initialiser(tables.limits, p1, options.type);
  keys["feasible_table"] = initialiser(tolerances.feasible, 0, options.type);
  keys["law_table"] = initialiser(tables.law, p1, options.type);
  keys["effect_table"] = initialiser(tables.effect, tables.variables, options.type);
  keys["conditions"] = std::to_string(tables.conditionCount());
  keys["condition_numbers"] = initialiser(tables.conditions, p1, options.type);
  const bool has_conditions = tables.conditionCount() > 0;
  keys["condition_table"] = has_conditions ? replaced(kOnlineConditionTable, keys) : "";
  keys["condition_test"] = has_conditions ? replaced(kOnlineConditionTest, keys) : "";
  keys["arithmetic"] = replaced(kFloatingArithmetic, keys);
  return replaced(kOnlineSourceTemplate, keys);
}

std::string onlineHeader(const OnlineTables& tables, const OnlineOptions& options) {
  check(tables, options);
  Replacements keys = onlineKeys(tables, options);
  keys["signals"] = signalLines("theta", tables.parameters) + signalLines("u", tables.inputs);
  return replaced(kOnlineHeaderTemplate, keys);
}

std::string onlineTest(const OnlineTables& tables, const OnlineOptions& options, const TestVectors& vectors) {
  check(tables, options);
  assert(!vectors.status.empty());
  Replacements keys = onlineKeys(tables, options);
  keys["oracle"] = "another solver in double";
  keys["workspace"] = "\nstatic " + options.name + "_workspace workspace;\n";
  keys["parameter_note"] =
      "vertices of the box, and points in it. Of all confirmed solutions, the last took the most iterations.";
  keys["call"] = options.name + "_solve(&workspace, theta, u)";
  return testText(std::move(keys), options.type, vectors);
}

std::string onlineFacts(const OnlineTables& tables, const OnlineOptions& options,
                        const OnlineRecord& record) {
  check(tables, options);
  const Replacements keys = onlineKeys(tables, options);
  const auto number = [](std::uint64_t value) { return std::to_string(value); };
  const std::size_t table_bytes = tableBytes(tables, options), code_bytes = onlineCodeBytes(options.type);
  std::string errors;
  for (const double error : record.error) errors += (errors.empty() ? "" : ", ") + roundedUp(error);
  return "{\n  \"name\": \"" + options.name + "\",\n  \"kind\": \"online\",\n  \"type\": \"" +
         keys.at("real") + "\",\n  \"version\": \"" + keys.at("version") + "\",\n  \"problem\": \"" +
         keys.at("problem_hash") + "\",\n  \"parameters\": " + keys.at("p") +
         ",\n  \"inputs\": " + keys.at("m") + ",\n  \"variables\": " + keys.at("n") +
         ",\n  \"rows\": " + keys.at("rows") + ",\n  \"sides\": " + keys.at("sides") +
         ",\n  \"flash_bytes\": " + number(table_bytes + code_bytes) +
         ",\n  \"table_bytes\": " + number(table_bytes) +
         ",\n  \"code_bytes\": {\"cortex_m4f\": " + number(code_bytes) + "}" +
         ",\n  \"workspace_bytes\": " + number(workspaceBytes(tables, options)) +
         ",\n  \"writable_bytes\": 0,\n  \"worst_case\": {\"iterations\": " + keys.at("limit") +
         "},\n  \"met\": {\"parameters\": " + number(record.parameters) +
         ", \"solved\": " + number(record.solved) + ", \"infeasible\": " + number(record.infeasible) +
         ", \"stopped\": " + number(record.stopped) + ", \"confirmed\": " + number(record.confirmed) +
         ", \"iterations\": " + number(record.iterations) + ", \"error\": [" + errors + "]}\n}\n";
}

}  // namespace polyfly
