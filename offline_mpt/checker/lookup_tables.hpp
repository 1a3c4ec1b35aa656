#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cell_bound.hpp"
#include "core/map.hpp"

/// Look-ups as tables, of a map (region_maps/FORMAT.md) or of exported code (region_maps/region_maps/export/README.md), with bounds
/// of the rounding of each sum.
namespace checker {

struct LookupTables {
  struct Candidate {
    std::uint32_t region = 0, law = 0;
    /// Twice the plane's number, plus one where both sides are negated.
    std::vector<std::uint32_t> rows;
  };

  std::size_t p = 0, q = 0;
  /// The parameters that are not outside of the box.
  Box box;
  /// p + 1 numbers each: a, c.
  std::vector<double> planes;
  /// q rows of p + 1 numbers each.
  std::vector<double> laws;
  /// Whether the first candidate of a leaf whose rows hold within the tolerance is taken. Otherwise it is the one whose
  /// greatest violation is least, and the search ends at one without a violation.
  bool takes_first = false;
  double tolerance = 0.0;
  /// Node 0 is the root; without nodes it is leaf `root_leaf`. Children from the number of nodes on are leaves.
  std::vector<std::uint32_t> node_plane;
  std::vector<std::array<std::uint32_t, 2>> children;
  std::uint32_t root_leaf = 0;
  std::vector<std::vector<Candidate>> leaves;

  /// Bounds of |computed - exact| in the box: of a . theta - c for each plane, of each row of each law.
  std::vector<double> plane_error, law_error;
  /// Greatest rounding of each parameter of the box on its way to the look-up.
  std::vector<double> parameter_error;

  std::uint32_t root() const { return node_plane.empty() ? root_leaf : 0; }
};

/// The arithmetic of a look-up.
struct Arithmetic {
  /// Half the distance from 1 to the next number.
  double unit = 0.0;
  /// More than any number that is flushed to zero, and than any error by underflow.
  double smallest = 0.0;
  double greatest = 0.0;
  /// Whether parameters are rounded to this type first.
  bool rounds_parameters = false;
};

constexpr Arithmetic kDoubles = {0x1p-53, 0x1p-1022, 0x1p1023, false};
constexpr Arithmetic kFloats = {0x1p-24, 0x1p-126, 0x1p127, true};

/// Fills in the bounds of rounding. They hold for sums in any order, with contracted multiply-adds too. Throws Refused
/// where a sum may overflow.
void boundRounding(LookupTables& tables, const Arithmetic& arithmetic);

LookupTables lookupOf(const Map& map);

/// The code's tables with planes of the map in place of its own, for each the nearest. Their difference, which counts as
/// rounding from then on, is not above `most`. Planes that the code lacks get the greatest error. Throws Refused.
LookupTables withPlanesOf(const LookupTables& map, LookupTables code, double most);

enum class CodeType { kDouble, kFloat };

/// What NAME.c holds. All numbers are exact as doubles.
struct ExportedCode {
  std::string name;
  CodeType type = CodeType::kDouble;
  LookupTables tables;
};

/// The name of a type in NAME.json.
const char* nameOf(CodeType type);

/// Reads the tables of NAME.c. Throws Refused where they are not as the code needs them, or where any other token of the text
/// is not that of an exported map.
ExportedCode readCode(const std::string& text);

/// The text of NAME.h is that of the code and its map. Throws Refused.
void requireHeader(const std::string& header, const ExportedCode& code, const Map& map);

}  // namespace checker
