#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "region_maps/map_content.hpp"
#include "region_maps/region_map.hpp"

/// C code of a region map, for processors that read no file (region_maps/region_maps/export/README.md).
namespace polyfly {

/// Type of the numbers in the tables, of the parameters and of the inputs.
enum class ExportType { kDouble, kFloat };

/// What is said of a type that was removed.
constexpr const char* kNoInt16 =
    "int16 was removed, because its error may exceed the input's range; use float";

/// double, float
const char* toString(ExportType type);

/// A leaf of the map, a region, and the rows to test of it as MapContent::tests has them.
struct ChosenCandidate {
  std::uint32_t leaf = 0;
  std::uint32_t region = 0;
  std::uint32_t tests = MapContent::kAllRows;
};

struct ExportOptions {
  /// Prefix of all identifiers and of the files' names, see checkExportName.
  std::string name;
  ExportType type = ExportType::kDouble;
  /// Of float, the tolerance of look-ups is the type's own one times this. Double has that of the map.
  double tolerance = 1.0;
  /// Candidates that leaves have besides those of the map, and candidates of the map with other rows to test. Rounding
  /// may lead a parameter beside a leaf's cell into it, where none of the map's candidates holds the parameter.
  std::vector<ChosenCandidate> chosen;
};

/// No look-up takes more operations: along each path of the tree, with all rows of the leaf.
struct LookupWork {
  /// Sums of p products: planes of nodes and of candidates' rows, and rows of the law.
  std::uint64_t sums = 0;
  std::uint64_t comparisons = 0;
};

/// What is proven of the exported code, to be stated in its header.
struct ExportBound {
  /// Greatest difference from the map's answer. Size m. [the input's unit]
  std::vector<double> error;
  /// Greatest violation of a half-space of the region whose law is used. [scaled]
  double margin = 0.0;
  LookupWork work;
  /// Of a safety filter, the greatest error of each input for which its set is proven. Size m; empty for other maps. [the
  /// input's unit]
  std::vector<double> allowed;

  /// Whether the errors are within what the filter allows.
  bool isAllowed() const;
};

/// Throws Error where `name` is no C identifier of 1 to 24 characters that begins with a letter.
void checkExportName(const std::string& name);

/// The text of NAME.c: tables and look-up. Throws Error where a number of the map does not fit the type, or the
/// map has more tables than 32-bit indices reach. The same map and options give the same text.
std::string exportSource(const RegionMap& map, const ExportOptions& options);

/// Bytes of flash. The instructions are bounds of what GCC makes of the look-up with -O2 or -Os. They count the compiler's
/// routines for numbers that the processor lacks.
struct FlashBytes {
  std::size_t tables = 0;
  std::size_t cortex_m4f = 0;
  /// 0: the code does not run there, because it has doubles or needs more than the processor's 32 kB.
  std::size_t atmega328p = 0;

  /// Tables, and the greater number of instructions.
  std::size_t total() const;
};
FlashBytes exportFlashBytes(const RegionMap& map, const ExportOptions& options);

/// Bytes of stack of one look-up, where addresses have up to 32 bits. Arguments, automatic variables and the terms of
/// a sum count along the deepest chain of calls, in 4 bytes each or 8 of a double. Each call counts 16 bytes.
/// Compilers keep most of them in registers. Routines of the compiler for numbers that the processor does not have
/// are not counted.
std::size_t exportStackBytes(const RegionMap& map, const ExportOptions& options);

/// The text of NAME.h.
std::string exportHeader(const RegionMap& map, const ExportOptions& options, const ExportBound& bound);

/// Parameters with answers, for NAME_test.c.
struct TestVectors {
  /// p numbers each.
  std::vector<double> theta;
  /// 0: u is the answer. 1: there is none; u is any value.
  std::vector<std::uint32_t> status;
  /// m numbers each.
  std::vector<double> u;
  /// Greatest difference that is allowed of each input. Size m.
  std::vector<double> tolerance;
};

/// The text of NAME_test.c: a program that returns 0 where the compiled code answers within the bound.
std::string exportTest(const RegionMap& map, const ExportOptions& options, const ExportBound& bound);

/// The text of NAME.json: bytes of flash and stack, greatest numbers of operations, bound, checksums.
std::string exportFacts(const RegionMap& map, const ExportOptions& options, const ExportBound& bound);

}  // namespace polyfly
