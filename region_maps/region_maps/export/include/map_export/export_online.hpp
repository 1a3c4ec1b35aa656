#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "map_export/export_map.hpp"
#include "region_maps/signal.hpp"

/// C code that solves a strictly convex program online (region_maps/region_maps/export/README.md, "Online solver").
namespace polyfly {

/// A program in coordinates v in which its cost is |v|^2 / 2: v = 0 is the minimiser without constraints. Sizes:
/// n variables, r rows, s sides, p parameters, m inputs.
struct OnlineTables {
  std::string program_name;
  /// Text of the problem file; its checksum stands in the code.
  std::string problem_text;
  /// At least one each.
  std::vector<Signal> parameters;
  std::vector<Signal> inputs;
  std::uint32_t variables = 0;

  /// r rows a of n numbers and unit length.
  std::vector<double> rows;
  /// Sides a . v <= limit: twice the row's index, plus 1 where a is the negated row. Sides of one row are neighbours.
  std::vector<std::uint32_t> sides;
  /// Of each side, the row of the program that it comes from. Not in the code.
  std::vector<std::uint32_t> origins;
  /// Of each side, p coefficients of theta and the constant.
  std::vector<double> limits;
  /// What must not be negative for a solution to exist: p coefficients of theta and the constant each.
  std::vector<double> conditions;
  /// Of each input, p coefficients of theta and the constant: u at v = 0.
  std::vector<double> law;
  /// Of each input, n numbers: its change with v.
  std::vector<double> effect;

  std::uint32_t rowCount() const { return static_cast<std::uint32_t>(rows.size() / variables); }
  std::uint32_t sideCount() const { return static_cast<std::uint32_t>(sides.size()); }
  std::uint32_t conditionCount() const {
    return static_cast<std::uint32_t>(conditions.size() / (parameters.size() + 1));
  }
  /// Sides that can be active at once.
  std::uint32_t activeLimit() const { return variables < rowCount() ? variables : rowCount(); }
};

struct OnlineOptions {
  /// Prefix of all identifiers and of the files' names, see checkExportName.
  std::string name;
  /// Double or float.
  ExportType type = ExportType::kDouble;
  /// Changes of the active set that one solution may make, at least 1.
  std::uint32_t iteration_limit = 0;
};

/// Tolerances of the solver.
struct OnlineTolerances {
  /// Violation of each side that is left alone. [|v|]
  std::vector<double> feasible;
  /// So many times that violation is left alone of an active side.
  double active_slack = 0.0;
  /// Squared distance of a row from the span of the active ones, up to which it depends on them. Rows have length 1.
  double dependent = 0.0;
  /// Rate of a multiplier up to which it does not block.
  double rate = 0.0;
};

/// By the type's precision, and by the greatest terms of each limit over the parameters' ranges.
OnlineTolerances onlineTolerances(const OnlineTables& tables, ExportType type);

/// 10 (n + r) + 30.
std::uint32_t defaultIterationLimit(const OnlineTables& tables);

/// What was met at the parameters that were tried.
struct OnlineRecord {
  std::uint64_t parameters = 0;
  std::uint64_t solved = 0;
  std::uint64_t infeasible = 0;
  /// Where the iteration limit was reached.
  std::uint64_t stopped = 0;
  /// Answers that the other solver confirmed. It is silent where rounding may decide whether there is a solution.
  std::uint64_t confirmed = 0;
  /// Greatest number of one solution that did not reach the limit.
  std::uint32_t iterations = 0;
  /// Greatest difference from another solver in double, of each input. Size m. [the input's unit]
  std::vector<double> error;
};

/// The text of NAME.c. Throws Error where a number does not fit the type, or `options` or `tables` break a rule of
/// theirs.
std::string onlineSource(const OnlineTables& tables, const OnlineOptions& options);

/// The text of NAME.h.
std::string onlineHeader(const OnlineTables& tables, const OnlineOptions& options);

/// The text of NAME_test.c: a program that returns 0 where the compiled code answers as the vectors say.
std::string onlineTest(const OnlineTables& tables, const OnlineOptions& options, const TestVectors& vectors);

/// Bound of the bytes of instructions on a Cortex-M4F, as FlashBytes has it of maps.
std::size_t onlineCodeBytes(ExportType type);

/// The text of NAME.json: bytes, the iteration limit, and what was met.
std::string onlineFacts(const OnlineTables& tables, const OnlineOptions& options, const OnlineRecord& record);

}  // namespace polyfly
