#include "offline_mpt/reduce_proven.hpp"

#include <optional>
#include <utility>

#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

constexpr int kMaxRepairs = 5;
// Of ReduceOptions::side_tolerance, in the order in which they are tried.
constexpr double kToleranceShares[] = {1.0, 3.0, 0.3};

}  // namespace

ProvenReduction reduceProven(const RegionMap& map, const std::string& name,
                             const ReduceOptions& reduce_options, const ReductionOptions& proof_options) {
  std::optional<ProvenReduction> attempt;
  for (const double share : kToleranceShares) {
    ReduceOptions options = reduce_options;
    options.side_tolerance *= share;
    ReduceResult result = reduce(map, options);
    for (int repairs = 0; repairs <= kMaxRepairs; ++repairs) {
      MapImage image(result.content);
      ReductionReport report = verifyReduction(image.view(name), map, proof_options);
      attempt.emplace(ProvenReduction{result.stats, std::move(image), std::move(report)});
      if (attempt->report.passed() || attempt->report.interrupted) return std::move(*attempt);
      if (!repairLeaves(result.content, attempt->report)) break;
    }
  }
  return std::move(*attempt);
}

}  // namespace polyfly
