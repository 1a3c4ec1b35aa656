#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "certify/farkas_proof.hpp"
#include "exact_kkt/exact_region.hpp"
#include "offline_mpt/certify.hpp"

namespace polyfly {

class RegionMap;
struct RegionView;

/// A listed half-space of a region of the map, after its exact row was found.
struct CheckedFacet {
  ExactOrigin origin;
  std::vector<ExactOrigin> same;  ///< other conditions with exactly the same half-space
};

/// What one region of the map is by itself.
struct RegionCheck {
  /// Whether the optimality conditions could be solved.
  bool described = false;
  /// Active rows without equalities, ascending.
  std::vector<int> active;
  /// Whether the map leaves the region out as a sliver, see slivers.hpp.
  bool is_sliver = false;
  /// Regions of the map that cover the sliver.
  std::set<std::uint32_t> covered_by;
  /// Facets in the order of the map, then those that it leaves out.
  std::vector<CheckedFacet> facets;
  /// Exact rows of `facets`. Empty in large maps, to save memory.
  std::vector<ExactRow> listed;
  /// Inequalities outside the active set that are tight in the whole region.
  std::vector<int> idle;
  /// A point strictly inside. Empty if there is none.
  std::vector<Rational> point;
  std::uint64_t rows = 0;
  std::uint64_t implied = 0;
  /// Conditions that bound it although the map does not list them: last of `listed`.
  std::size_t left_out = 0;
  /// Number of conditions that hold up to rounding only.
  std::uint64_t forgiven = 0;
  double law_error = 0.0;
  double plane_error = 0.0;
  std::vector<Defect> defects;
  /// Lines P, I and D of the certificate.
  std::string text;
};

/// The map, the program and what of the map is needed in exact form.
struct CheckContext {
  CheckContext(const RegionMap& checked, const ParametricProgram& given, const ExactProgram& exact,
               const CertifyOptions& chosen);

  const RegionMap& map;
  const ParametricProgram& source;
  const ExactProgram& program;
  const CertifyOptions& options;

  /// Ranges of the inputs; without one, the greatest |u| of all laws in the box.
  std::vector<Rational> input_sizes;

  /// What the law tolerance of an input is a share of: at least 1 and the greatest |u| of its law's `row` in the box, but no
  /// more than the input's size.
  Rational lawScale(std::size_t input, const double* row) const;
  bool stopped() const { return options.stop != nullptr && options.stop->load(); }
};

/// Row `row` of a region as the map has it, in t: row (t, 1) >= 0.
std::vector<Rational> mapRow(const CheckContext& context, const RegionView& region, std::uint32_t row);

/// The exact rows that the map's rows of a region stand for, in the map's order. `error` is the greatest
/// difference, infinite where there is no such row; `worst` tells where.
std::vector<ExactRow> matchRows(const CheckContext& context, const RegionView& region,
                                const ExactRegion& exact, double& error, int& worst);

/// The active set of a region of the map; empty with `valid` false where it names no rows of the program.
std::vector<int> mapActiveSet(const CheckContext& context, const RegionView& region, bool& valid);

/// Exact rows of one of the map's regions: those that the map lists.
std::vector<ExactRow> mapRows(const CheckContext& context, const std::vector<RegionCheck>& checks,
                              std::uint32_t region);

/// Exact rows of a region or sliver: those that the map lists, then those that it leaves out.
std::vector<ExactRow> listedRows(const CheckContext& context, const std::vector<RegionCheck>& checks,
                                 std::uint32_t region);

/// Fills in all that follows from the listed rows: facets, inner point, proofs that the others are implied.
void finishCheck(const CheckContext& context, std::uint32_t index, const ExactRegion& exact,
                 RegionCheck& check);

RegionCheck checkRegion(const CheckContext& context, std::uint32_t index);

/// The text begins with the region and, if it is not -1, its row.
Defect regionDefect(Defect::Kind kind, std::uint32_t region, int row, const std::string& text);

/// Kind and index as in the certificate, "m3".
std::string originText(const ExactOrigin& origin);

/// t of parameters, without rounding.
std::vector<Rational> toScaled(const ExactProgram& program, const Eigen::VectorXd& theta);

}  // namespace polyfly
