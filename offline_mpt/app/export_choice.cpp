#include "export_choice.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "command.hpp"
#include "offline_mpt/reduce_proven.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

enum class MapKind { kGiven, kReduced };

const char* wordOf(MapKind kind) { return kind == MapKind::kGiven ? "the map" : "the reduced map"; }

/// Code that fits.
struct Attempt {
  ProvenExport proven;
  MapKind kind = MapKind::kGiven;
  std::string summary;
  /// See errorOf.
  double error = 0.0;
};

/// The greatest error of an input as a multiple of what is taken without looking further: of a safety filter, what its
/// proof allows; of other maps, this part of the input's range, where it has one.
double errorOf(const RegionMap& map, const ExportBound& bound) {
  constexpr double kPartOfRange = 0.01;
  double greatest = 0.0;
  for (std::size_t j = 0; j < bound.error.size(); ++j) {
    const Signal& input = map.inputs()[j];
    const double taken =
        bound.allowed.empty() ? kPartOfRange * (input.upper - input.lower) : bound.allowed[j];
    // A filter's input without an allowance takes no error. Another one without a range has no part of it.
    if (bound.error[j] > 0.0 && (taken > 0.0 || !bound.allowed.empty()))
      greatest = std::max(greatest, bound.error[j] / taken);
  }
  return greatest;
}

/// Tries maps and types in turn.
class ExportChoice {
 public:
  ExportChoice(const RegionMap& map, const std::string& reduced_name, const ExportRequest& request)
      : map_(map), reduced_name_(reduced_name), request_(request) {}

  ChosenExport choose() {
    using Types = std::vector<ExportType>;
    const Types types =
        request_.chooses_type ? Types{ExportType::kDouble, ExportType::kFloat} : Types{request_.type};
    for (const MapKind kind : {MapKind::kGiven, MapKind::kReduced}) {
      for (const ExportType type : types) {
        std::optional<Attempt> fitting = attempt(kind, type);
        if (!fitting) continue;
        if (request_.flash_limit == 0 || fitting->error <= 1.0) return chosen(std::move(*fitting));
        if (!best_ || fitting->error < best_->error) best_ = std::move(fitting);
      }
    }
    if (best_) return chosen(std::move(*best_));
    throw Error("--flash-limit: of " + map_.path() + ", the code needs " + needs_);
  }

 private:
  /// Without a limit, each one fits, or throws its error.
  std::optional<Attempt> attempt(MapKind kind, ExportType type) {
    const std::string what = std::string(wordOf(kind)) + " in " + toString(type);
    try {
      if (kind == MapKind::kReduced && !canReduce()) return std::nullopt;
      const std::optional<RegionMap> reduced =
          kind == MapKind::kGiven ? std::nullopt : std::optional<RegionMap>(image_->view(reduced_name_));
      const RegionMap& map = reduced ? *reduced : map_;
      ExportOptions options;
      options.name = request_.name;
      options.type = type;
      ExportProofOptions proof;
      proof.progress = [this, &what](std::uint64_t pairs) {
        request_.progress("proof of " + what + ": compared " + std::to_string(pairs) + " pairs of leaves");
      };
      ProvenExport proven = proveExport(map, std::move(options), proof);
      const std::size_t bytes = exportFlashBytes(map, proven.options).total();
      const std::string size = std::to_string(bytes) + " bytes";
      if (request_.flash_limit == 0 || bytes <= request_.flash_limit) {
        const double error = errorOf(map, proven.bound);
        return Attempt{std::move(proven), kind, size + " of flash, " + what, error};
      }
      note(size + " as " + what);
    } catch (const Error& error) {
      if (request_.flash_limit == 0) throw;
      note("no number as " + what + " (" + error.what() + ")");
    }
    return std::nullopt;
  }

  ChosenExport chosen(Attempt&& attempt) {
    if (attempt.kind == MapKind::kGiven) image_.reset();
    return {std::move(attempt.proven), std::move(image_), std::move(attempt.summary)};
  }

  void note(const std::string& need) { needs_ += (needs_.empty() ? "" : ", ") + need; }

  /// Reduces the map once. False where it cannot be reduced, which is noted once.
  bool canReduce() {
    if (image_ || is_refused_) return !is_refused_;
    is_refused_ = true;
    ReduceOptions reduce;
    reduce.threads = defaultThreads();
    reduce.progress = [this](std::uint64_t done, std::uint64_t total) {
      request_.progress("joined regions of " + std::to_string(done) + " of " + std::to_string(total) +
                        " laws");
    };
    ReductionOptions proof;
    proof.threads = reduce.threads;
    ProvenReduction proven = reduceProven(map_, reduced_name_, reduce, proof);
    if (!proven.report.passed()) throw Error("its reduction could not be proven");
    image_ = std::make_unique<MapImage>(std::move(proven.image));
    is_refused_ = false;
    return true;
  }

  const RegionMap& map_;
  const std::string& reduced_name_;
  const ExportRequest& request_;
  /// The reduced map.
  std::unique_ptr<MapImage> image_;
  bool is_refused_ = false;
  /// Of what fits, the one with the least error.
  std::optional<Attempt> best_;
  std::string needs_;
};

}  // namespace

ChosenExport chooseExport(const RegionMap& map, const std::string& reduced_name,
                          const ExportRequest& request) {
  return ExportChoice(map, reduced_name, request).choose();
}

}  // namespace polyfly
