#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/partition.hpp"

namespace polyfly {

class RegionMap;

struct CertifyOptions {
  int threads = 1;  ///< 1..256; the report and the certificate do not depend on it
  /// Greatest difference of u in the box between the map's law and the exact one, relative to max(1, |u|).
  double law_tolerance = 1e-8;
  double plane_tolerance = 5e-9;            ///< greatest difference of a plane's distance in the box [scaled]
  const std::atomic<bool>* stop = nullptr;  ///< set from outside to end early
  /// Called now and then from the calling thread.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
};

/// Something that the map gets wrong.
struct Defect {
  enum class Kind : std::uint8_t {
    /// The set names no row, or repeats one; its rows are dependent; or it does not fit the equalities.
    kActiveSet,
    kRepeated,          ///< another region has the same active set
    kLowerDimensional,  ///< the region has no interior
    kPlane,             ///< a plane of the region bounds nothing: no condition of optimality is near it
    kUnlisted,          ///< a condition of optimality fails at `witness`, which the region claims
    kLaw,               ///< u is wrong by `size`
    kGap,  ///< behind a facet there is a feasible parameter that no region holds: `witness`, if one was found
    kUnbounded,  ///< the same, and proven that no optimum is finite at `witness`: the map cannot go on there
  };
  Kind kind = Kind::kActiveSet;
  std::uint32_t region = 0;
  int row = -1;  ///< of the region, in map order; -1: the region as a whole
  /// kLaw, kPlane: the difference; kLowerDimensional: about the radius; kUnlisted: distance [scaled].
  double size = 0.0;
  Eigen::VectorXd witness;   ///< parameter, empty if there is none
  std::vector<int> missing;  ///< kGap: an active set that should be in the map; may be empty even so
  std::string text;          ///< a sentence
};

const char* toString(Defect::Kind kind);

/// What the exact verification found. `certificate` is the text of a certificate file (CERTIFICATE.md), empty
/// where there are defects.
struct CertifyReport {
  std::uint64_t regions = 0;
  std::uint64_t facets = 0;
  std::uint64_t domain_facets = 0;   ///< at the edge of the box or of A_theta theta <= b_theta
  std::uint64_t edge_facets = 0;     ///< beyond, the program is infeasible
  std::uint64_t matched_facets = 0;  ///< shared whole with one other region
  std::uint64_t covered_facets = 0;  ///< shared piecewise with several
  std::uint64_t rows = 0;            ///< optimality conditions of all regions
  std::uint64_t implied_rows = 0;    ///< of them proven to follow from the listed ones and the box
  std::uint64_t slivers = 0;  ///< regions that the map leaves to those about them, within plane_tolerance
  std::uint64_t left_out_rows = 0;     ///< half-spaces that it leaves out, within plane_tolerance
  double plane_tolerance = 0.0;        ///< as asked for
  double law_error = 0.0;              ///< greatest, relative as law_tolerance
  double plane_error = 0.0;            ///< greatest [scaled]
  bool singular = false;               ///< H is, and not zero: of several optima the shortest
  std::uint64_t replaced_entries = 0;  ///< of H, f, F and A, proven with others that differ by rounding
  double greatest_replacement = 0.0;   ///< difference, relative to the greatest entry of the matrix or row
  bool linear = false;
  /// With `widened`: rows that hold within 2^-40 of their size in some region.
  std::uint64_t forgiven_rows = 0;
  bool widened = false;  ///< coverage is that of the regions moved outwards by plane_tolerance
  /// Those of `implied_equalities` that are proven by two coinciding bounds.
  std::vector<int> narrow_rows;
  double greatest_narrowing = 0.0;  ///< difference of a bound, relative to the sum of its row's |entries|
  /// Inequalities that hold with equality wherever the program is feasible.
  std::vector<int> implied_equalities;
  std::vector<int> dropped_equalities;  ///< that follow from others up to rounding; proven within 2^-40
  /// Rows that others imply up to rounding; proven within 2^-30 of their size.
  std::vector<int> dropped_rows;
  /// Rows whose bounds count as greater by 2^-40 of their size: in some regions they are tight up to
  /// rounding.
  std::vector<int> relaxed_rows;
  std::vector<Defect> defects;  ///< by region, then row
  bool interrupted = false;
  std::string certificate;

  bool passed() const { return defects.empty() && !interrupted && regions > 0; }
};

/// Proves in rational arithmetic, or refutes, that the map is the solution of the program: see CERTIFICATE.md
/// for the statement. Doubles count at their exact values. Throws Error when map and program do not have the
/// same signals and problem text, or the program as a whole is infeasible, indefinite or has no interior.
CertifyReport certify(const RegionMap& map, const ParametricProgram& program,
                      const CertifyOptions& options = {});

/// A map's regions, described anew from their active sets, and those that were missing.
struct RepairResult {
  Partition partition;        ///< status complete if the last verification passed, else incomplete
  std::uint64_t added = 0;    ///< regions that the map lacks
  std::uint64_t removed = 0;  ///< regions of the map without interior, or that are no critical regions
  CertifyReport report;       ///< of the partition; its certificate is of no map that was written
};

/// Explores from where the map has gaps, with exact descriptions, until nothing is missing. Throws Error as
/// certify does, and when no region of the map can be used.
RepairResult repair(const RegionMap& map, const ParametricProgram& program,
                    const CertifyOptions& options = {});

std::string certifyText(const CertifyReport& report);  ///< for people, several lines
std::string certifyJson(const CertifyReport& report);

/// Writes the certificate beside `path` and renames it. Throws Error, also when there is none.
void writeCertificate(const CertifyReport& report, const std::string& path);

}  // namespace polyfly
