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
class ProcessGroup;

struct CertifyOptions {
  int threads = 1;  ///< 1..256; the report and the certificate do not depend on it
  /// Greatest difference of u in the box between the map's law and the exact one. It is relative to max(1, the
  /// greatest |u| of this law in the box), and to the input's range where that is less (without one, to the greatest |u| of
  /// all laws). The certificate states 1e-10 where that holds.
  double law_tolerance = 1e-8;
  double plane_tolerance = 5e-9;            ///< greatest difference of a plane's distance in the box [scaled]
  const std::atomic<bool>* stop = nullptr;  ///< set from outside to end early
  /// Processes that prove together; not owned. Process 0 calls certify. The others call runCertifyProcess with the same
  /// map, program and options. Only these two use it.
  ProcessGroup* group = nullptr;
  /// Called now and then from the calling thread. `total` is three times the number of regions: their conditions, their
  /// facets, and look-ups.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
};

/// Something that the map gets wrong.
struct Defect {
  enum class Kind : std::uint8_t {
    /// The set names no row, or repeats one; its rows are dependent; or it does not fit the equalities.
    kActiveSet,
    /// Another region has the same active set.
    kRepeated,
    /// The region has no interior.
    kLowerDimensional,
    /// A plane of the region bounds nothing. No condition of optimality is near it.
    kPlane,
    /// A condition of optimality fails at `witness`, which the region claims to hold.
    kUnlisted,
    /// u is wrong by `size`.
    kLaw,
    /// No region holds a feasible parameter behind a facet: `witness`, if one was found.
    kGap,
    /// A gap at whose `witness` the optimum is proven not to be finite. The map cannot go on there.
    kUnbounded,
    /// A look-up answers what it should not, or not what it should: at `witness`, if one was found.
    kLookup,
  };
  Kind kind = Kind::kActiveSet;
  std::uint32_t region = 0;
  /// Row of the region, in map order. -1: the whole region.
  int row = -1;
  /// kLaw, kPlane: the difference; kLowerDimensional: about the radius; kUnlisted: distance [scaled].
  double size = 0.0;
  /// A parameter. Empty if there is none.
  Eigen::VectorXd witness;
  /// kGap: an active set that should be in the map. It may be empty even so.
  std::vector<int> missing;
  /// The defect as a sentence.
  std::string text;
};

const char* toString(Defect::Kind kind);

/// What the exact verification found. `certificate` is the text of a certificate file (CERTIFICATE.md), empty
/// where there are defects.
struct CertifyReport {
  std::uint64_t regions = 0;
  std::uint64_t facets = 0;
  /// Facets at the edge of the box or of A_theta theta <= b_theta.
  std::uint64_t domain_facets = 0;
  /// Facets beyond which the program is infeasible.
  std::uint64_t edge_facets = 0;
  /// Facets shared whole with one other region.
  std::uint64_t matched_facets = 0;
  /// Facets shared piecewise with several regions.
  std::uint64_t covered_facets = 0;
  /// Optimality conditions of all regions.
  std::uint64_t rows = 0;
  /// Conditions proven to follow from the listed conditions and the box.
  std::uint64_t implied_rows = 0;
  /// Regions that the map leaves to their neighbours, within plane_tolerance.
  std::uint64_t slivers = 0;
  /// Half-spaces that the map leaves out, within plane_tolerance.
  std::uint64_t left_out_rows = 0;
  /// The plane tolerance that was asked for.
  double plane_tolerance = 0.0;
  /// Greatest error of a law, relative as law_tolerance.
  double law_error = 0.0;
  /// Strictly convex programs: how much u may differ, where a look-up answers beyond a facet of a region, from that of
  /// the region behind it. 0 where nothing is stated.
  double beyond_facet = 0.0;
  /// Greatest error of a plane.
  double plane_error = 0.0;  ///< [scaled]
  bool linear = false;
  /// With `widened`: rows that hold within 2^-40 of their size in some region.
  std::uint64_t forgiven_rows = 0;
  /// Coverage is that of the regions moved outwards by plane_tolerance.
  bool widened = false;
  /// Inequalities that hold with equality wherever the program is feasible.
  std::vector<int> implied_equalities;
  /// Equalities that follow from others up to rounding. They are proven within 2^-40.
  std::vector<int> dropped_equalities;
  /// Rows that others imply up to rounding; proven within 2^-30 of their size.
  std::vector<int> dropped_rows;
  /// Defects by region, then row.
  std::vector<Defect> defects;
  bool interrupted = false;
  /// What else the map must keep, such as a safe set, is proven.
  bool further_holds = true;
  std::string certificate;

  bool passed() const { return defects.empty() && !interrupted && regions > 0 && further_holds; }
};

/// Proves in rational arithmetic, or refutes, that the map is the solution of the program: see CERTIFICATE.md for the
/// statement. Doubles count at their exact values. Throws Error when map and program do not have the same signals and
/// problem text. It throws when the program as a whole is infeasible, indefinite or has no interior. Also when the
/// certificate would need a cell of more rows than the checker reads. With a group it throws LostProcess in process
/// 0, and Error where another process fails or has another map or other tolerances.
CertifyReport certify(const RegionMap& map, const ParametricProgram& program,
                      const CertifyOptions& options = {});

/// Takes part in the proof of process 0 of options.group, and returns when that is over. What goes wrong is reported to
/// process 0.
void runCertifyProcess(const RegionMap& map, const ParametricProgram& program, const CertifyOptions& options);

/// A map's regions, described anew from their active sets, and those that were missing.
struct RepairResult {
  /// The status is complete if the last verification passed, else incomplete.
  Partition partition;
  /// Regions that the map lacks.
  std::uint64_t added = 0;
  /// Regions of the map without interior, or that are no critical regions.
  std::uint64_t removed = 0;
  /// Report of the partition. Its certificate does not belong to a map that was written.
  CertifyReport report;
};

/// Explores from where the map has gaps, with exact descriptions, until nothing is missing. Throws Error as
/// certify does, and when no region of the map can be used.
RepairResult repair(const RegionMap& map, const ParametricProgram& program,
                    const CertifyOptions& options = {});

/// The report for people, several lines.
std::string certifyText(const CertifyReport& report);
std::string certifyJson(const CertifyReport& report);

/// Writes the certificate beside `path` and renames it. Throws Error, also when there is none.
void writeCertificate(const CertifyReport& report, const std::string& path);

}  // namespace polyfly
