#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "region_maps/map_content.hpp"

namespace polyfly {

class RegionMap;

struct ReductionOptions {
  int threads = 1;  ///< 1..256; the report does not depend on it
  /// Laws that differ by less anywhere in the box count as one, relative as ReduceOptions::law_tolerance.
  double law_tolerance = 1e-8;
  bool certificate = false;                 ///< keep the proof
  const std::atomic<bool>* stop = nullptr;  ///< set from outside to end early
  /// Called now and then from the calling thread, with regions of both maps.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
};

/// Something that the reduced map gets wrong.
struct ReductionDefect {
  enum class Kind : std::uint8_t {
    kLost,   ///< a region of the original has a part that the reduced map does not answer as it should
    kClaim,  ///< a region of the reduced map claims a parameter that no region with its law holds
    /// A leaf of the reduced map does not test a row of a candidate. It is not proven to answer only within 8
    /// tolerances of that row.
    kAnswer,
  };
  Kind kind = Kind::kLost;
  std::uint32_t region = 0;  ///< kLost: of the original; otherwise of the reduced map
  Eigen::VectorXd witness;   ///< parameter in the box; empty for kAnswer
  std::string text;          ///< a sentence
  /// kLost: of the reduced map, at which the part arrives. kAnswer: that of the row, -1 where no leaf may leave out rows.
  int leaf = -1;
  int row = -1;  ///< kAnswer: of the region
  /// kLost: regions of the reduced map with its law that hold `witness` within the slack.
  std::vector<std::uint32_t> missing;
};

const char* toString(ReductionDefect::Kind kind);

/// What was proven. "Within the slack" means: in all half-spaces of a region moved outwards by `slack`.
struct ReductionReport {
  std::uint64_t original_regions = 0;
  std::uint64_t reduced_regions = 0;
  /// Parts of regions that were examined.
  std::uint64_t cells = 0;
  /// Regions of either map without interior.
  std::uint64_t flat_regions = 0;
  /// Half of the maps' tolerance.
  double slack = 0.0;  ///< [scaled]
  double law_tolerance = 0.0;
  /// Greatest difference of laws that count as one, relative as law_tolerance.
  double law_error = 0.0;
  /// Defects by map, then region.
  std::vector<ReductionDefect> defects;
  bool interrupted = false;
  /// The certificate (CERTIFICATE.md), if it was asked for and the reduction is proven.
  std::string certificate;

  bool passed() const { return defects.empty() && !interrupted && original_regions > 0; }
};

/// Proves in rational arithmetic, with doubles at their exact values, or refutes:
///
/// 1. Where a region of the original holds theta, the leaf of the reduced map at which theta arrives has a
///    candidate that holds theta within the slack, and its law is that of the region or (in slivers that the
///    tree leaves to a neighbour) of another region of the original that holds theta within the slack.
/// 2. Each region of the reduced map lies, within the slack, in the union of the original's regions with its law.
/// 3. Where a leaf does not test all rows of a candidate, a look-up in binary64 answers only within 8 tolerances of each.
///
/// So every answer of the reduced map is one that the original gives as well, within the tolerance that both maps
/// carry. Where the original answers, so does the reduced map. What is proven of the original holds for the reduced
/// map up to that tolerance and `law_error`. Throws Error when the maps do not belong together, or a certificate is
/// asked for that nests cuts more deeply than the checker reads.
ReductionReport verifyReduction(const RegionMap& reduced, const RegionMap& original,
                                const ReductionOptions& options = {});

/// Adds to the leaves of a reduced map the regions that its tree left out and that hold what was lost there. In
/// slivers, a tree may leave to a neighbour what none holds. Adds rows to test that are not proven to hold. False
/// where there is nothing to add. The result is to be verified as the map was.
bool repairLeaves(MapContent& content, const ReductionReport& report);

/// Writes the certificate beside `path`, syncs and renames it. Throws Error where there is none.
void writeCertificate(const ReductionReport& report, const std::string& path);

/// The report for people, several lines.
std::string reductionText(const ReductionReport& report);
std::string reductionJson(const ReductionReport& report);

}  // namespace polyfly
