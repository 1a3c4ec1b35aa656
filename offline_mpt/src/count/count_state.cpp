#include "count/count_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>

#include "count/exact_strict_complementarity.hpp"
#include "explore/region/compute_region.hpp"

namespace polyfly {
namespace {

constexpr std::uint32_t kNoFacet = std::numeric_limits<std::uint32_t>::max();

/// Examines active sets. One object, one thread.
class CountWorker {
 public:
  CountWorker(const NormalisedProgram& program, const ExploreOptions& options,
              const StrictComplementaritySystem& system, const LawSeparation& gap,
              const std::vector<int>& names, const CountState& state)
      : program_(program),
        names_(names),
        state_(state),
        worker_(program, options),
        test_(system, gap.slack),
        exact_(program, system, gap.slack),
        from_(static_cast<std::size_t>(program.p)),
        direction_(from_) {}

  void examine(RowSpan set, ProvenResult& out) {
    active_.assign(set.begin(), set.end());
    out.proofs.clear();
    out.witnesses.clear();
    const RegionResult& described = out.region;
    computeRegion(program_, worker_, active_, out.region);
    state_.findProven(described.neighbours, proven_);
    facet_ = kNoFacet;
    for (std::size_t k = 0; k < described.neighbours.size(); ++k)
      addProof(!proven_[k] && k < described.behind.size() && provenBehind(described, k), out);
    addProof(described.status == BuildStatus::kRegion && isProven(described.region), out);
  }

 private:
  RowSpan active() const { return {active_.data(), active_.size()}; }

  const std::vector<int>& named(RowSpan set) {
    rows_.clear();
    for (const std::uint16_t row : set) rows_.push_back(names_[row]);
    return rows_;
  }

  // The way from the centre to a point beyond the facet: where it crosses it, and on.
  void crossFacet(const RegionResult& described, std::uint32_t f) {
    const Region& region = described.region;
    const Facet& facet = region.facets[f];
    const double fraction = crossingFraction(region, facet);
    double squared = 0.0;
    for (std::size_t j = 0; j < from_.size(); ++j) {
      direction_[j] = facet.beyond[j] - region.centre[j];
      from_[j] = region.centre[j] + fraction * direction_[j];
      squared += direction_[j] * direction_[j];
    }
    for (double& entry : direction_) entry /= std::sqrt(squared);
    leaving_ = facet.origin.kind == RowOrigin::Kind::kSlack
                   ? test_.leaving(named(active()), names_[facet.origin.index], from_.data())
                   : StrictComplementarityCheck::kNone;
    facet_ = f;
  }

  // Looks behind the facet. Of sets that have another row for one of this one, those that keep the row which
  // leaves at the crossing begin elsewhere.
  bool provenBehind(const RegionResult& described, std::size_t k) {
    if (facet_ != described.behind[k]) crossFacet(described, described.behind[k]);
    const std::vector<int>& rows = named(described.neighbours[k]);
    if (std::find(rows.begin(), rows.end(), leaving_) != rows.end()) return false;
    return test_.onRay(rows, from_.data(), direction_.data(), witness_);
  }

  bool isProven(const Region& region) {
    return test_.at(named(active()), region.centre.data(), region.radius, witness_) ||
           exact_.at(active_, region.centre.data(), region.radius, witness_);
  }

  void addProof(bool proven, ProvenResult& out) const {
    out.proofs.push_back(!proven              ? SetProof::kNone
                         : witness_.law_apart ? SetProof::kProvenLawApart
                                              : SetProof::kProven);
    if (proven) out.witnesses.insert(out.witnesses.end(), witness_.t.begin(), witness_.t.end());
  }

  const NormalisedProgram& program_;
  const std::vector<int>& names_;
  const CountState& state_;
  RegionWorkspace worker_;
  StrictComplementarityCheck test_;
  ExactStrictComplementarity exact_;
  ActiveSet active_;
  std::vector<int> rows_;
  // Whether each neighbour is proven.
  std::vector<char> proven_;
  // The facet that the next three members belong to.
  std::uint32_t facet_ = kNoFacet;
  // Start and direction of the ray behind the facet.
  std::vector<double> from_, direction_;
  // Row of the set that a new row replaces behind the facet.
  int leaving_ = StrictComplementarityCheck::kNone;
  Witness witness_;
};

}  // namespace

CountState::CountState(const ParametricProgram& program, std::uint64_t map_limit, Record record)
    : tight(memory),
      is_proven(&memory),
      is_region(&memory),
      unresolved(&memory),
      program_(program),
      map_limit_(map_limit),
      record_(std::move(record)) {}

void CountState::findProven(const ActiveSetList& sets, std::vector<char>& proven) const {
  const std::shared_lock lock(growing_);
  proven.clear();
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const std::optional<std::uint32_t> index = found.find(sets[k]);
    proven.push_back(index && *index < is_proven.size() && is_proven[*index]);
  }
}

void CountState::prove(std::uint32_t index, SetProof proof, const std::int64_t* witness) {
  if (is_proven[index]) return;
  is_proven[index] = true;
  if (index < is_region.size()) {  // it was described before
    if (is_region[index]) {
      --unproven;
    } else {
      ++contradicted;
    }
  }
  const RowSpan set = found[index];
  ++count.proven;
  count.active_rows += set.count;
  if (proof == SetProof::kProvenLawApart) ++count.laws;
  if (record_) record_(set, witness);
}

void CountState::merge(const ProvenResult& result) {
  const ActiveSetList& neighbours = result.region.neighbours;
  const auto p = static_cast<std::size_t>(program_.parameterCount());
  const std::int64_t* witness = result.witnesses.data();
  const std::unique_lock lock(growing_);
  is_proven.resize(found.size());
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    if (found.insert(neighbours[k])) is_proven.push_back(false);
    if (result.proofs[k] == SetProof::kNone) continue;
    prove(*found.find(neighbours[k]), result.proofs[k], witness);
    witness += p;
  }
  if (result.region.status == BuildStatus::kFailed) failed = true;
  const bool counted = result.region.status == BuildStatus::kRegion && mergeRegion(result.region);
  if (counted && result.proofs.back() != SetProof::kNone)
    prove(static_cast<std::uint32_t>(described), result.proofs.back(), witness);
  if (counted && !is_proven[described]) ++unproven;
  if (!counted && is_proven[described]) ++contradicted;
  is_region.push_back(counted);
  ++described;
}

// False where the same region was found before.
bool CountState::mergeRegion(const RegionResult& result) {
  const Region& region = result.region;
  const std::size_t active_count = found[static_cast<std::uint32_t>(described)].count;
  if (region.isKnownByTightRows(active_count) && !tight.insert({region.tight.data(), region.tight.size()}))
    return false;
  unresolved.insert(unresolved.end(), result.unresolved.begin(), result.unresolved.end());
  ++regions;
  facets += region.facets.size();
  return true;
}

void proveRegions(const NormalisedProgram& program, const ExploreOptions& options,
                  const StrictComplementaritySystem& system, const LawSeparation& gap,
                  const std::vector<int>& names, const CountState& state, WorkQueue<ProvenResult>& queue) {
  CountWorker worker(program, options, system, gap, names, state);
  while (Batch<ProvenResult>* const batch = queue.pop()) {
    for (std::size_t k = 0; k < batch->sets.size(); ++k) worker.examine(batch->sets[k], batch->results[k]);
    queue.push(batch);
  }
}

}  // namespace polyfly
