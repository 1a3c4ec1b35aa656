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

// What is said of a set's proof: none, or a witness follows.
constexpr std::uint8_t kNone = 0;
constexpr std::uint8_t kProven = 1;
constexpr std::uint8_t kLawApart = 2;  // beside kProven

constexpr std::uint32_t kNoFacet = std::numeric_limits<std::uint32_t>::max();

class CountWorker : public Worker {
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

  void answer(RowSpan set, ByteWriter& out) override {
    active_.assign(set.begin(), set.end());
    computeRegion(program_, worker_, active_, described_);
    const RegionResult& described = described_;
    out.put(described.status);
    out.put(static_cast<std::uint32_t>(described.neighbours.size()));
    state_.findProven(described.neighbours, proven_);
    facet_ = kNoFacet;
    for (std::size_t k = 0; k < described.neighbours.size(); ++k) {
      writeSet(described.neighbours[k], out);
      writeProof(!proven_[k] && k < described.behind.size() && provenBehind(described, k), out);
    }
    if (described.status == BuildStatus::kRegion) writeRegion(described, out);
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

  void writeProof(bool proven, ByteWriter& out) {
    out.put(!proven ? kNone : static_cast<std::uint8_t>(witness_.law_apart ? kProven | kLawApart : kProven));
    if (proven) out.putArray(witness_.t.data(), witness_.t.size());
  }

  void writeRegion(const RegionResult& described, ByteWriter& out) {
    const Region& region = described.region;
    // as ExplorationState: bounded by slacks alone, a region is known by its tight rows
    const bool by_tight = region.by_slack && region.tight.size() > active_.size();
    writeSet({region.tight.data(), by_tight ? region.tight.size() : 0}, out);
    out.put(static_cast<std::uint32_t>(region.facets.size()));
    out.put(static_cast<std::uint32_t>(described.unresolved.size()));
    out.putArray(described.unresolved.data(), described.unresolved.size());
    const bool proven = test_.at(named(active()), region.centre.data(), region.radius, witness_) ||
                        exact_.at(active_, region.centre.data(), region.radius, witness_);
    writeProof(proven, out);
  }

  const NormalisedProgram& program_;
  const std::vector<int>& names_;
  const CountState& state_;
  RegionWorkspace worker_;
  StrictComplementarityCheck test_;
  ExactStrictComplementarity exact_;
  ActiveSet active_;
  RegionResult described_;
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
      record_(std::move(record)),
      witness_(static_cast<std::size_t>(program.parameterCount())) {}

std::uint8_t CountState::readProof(ByteReader& answer) {
  const auto proof = answer.get<std::uint8_t>();
  if (proof != kNone) answer.getArray(witness_.data(), witness_.size());
  return proof;
}

void CountState::findProven(const ActiveSetList& sets, std::vector<char>& proven) const {
  const std::shared_lock lock(growing_);
  proven.clear();
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const std::optional<std::uint32_t> index = found.find(sets[k]);
    proven.push_back(index && *index < is_proven.size() && is_proven[*index]);
  }
}

// With the witness that was read last.
void CountState::prove(std::uint32_t index, std::uint8_t proof) {
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
  if ((proof & kLawApart) != 0) ++count.laws;
  if (record_) record_(set, witness_.data());
}

void CountState::merge(ByteReader& answer) {
  const auto status = answer.get<BuildStatus>();
  const auto neighbours = answer.get<std::uint32_t>();
  const std::unique_lock lock(growing_);
  is_proven.resize(found.size());
  for (std::uint32_t k = 0; k < neighbours; ++k) {
    const RowSpan set = readSet(answer, rows_);
    const std::uint8_t proof = readProof(answer);
    if (found.insert(set)) is_proven.push_back(false);
    if (proof != kNone) prove(*found.find(set), proof);
  }
  if (status == BuildStatus::kFailed) failed = true;
  const bool counted = status == BuildStatus::kRegion && mergeRegion(answer);
  if (!counted && is_proven[described]) ++contradicted;
  is_region.push_back(counted);
  ++described;
}

// False where the same region was found before.
bool CountState::mergeRegion(ByteReader& answer) {
  const RowSpan tight_rows = readSet(answer, rows_);
  const bool known = tight_rows.count > 0 && !tight.insert(tight_rows);
  const auto facet_count = answer.get<std::uint32_t>();
  const auto probes = answer.get<std::uint32_t>();
  answer.need(probes, sizeof(double));
  const std::size_t before = unresolved.size();
  unresolved.resize(before + probes);
  answer.getArray(unresolved.data() + before, probes);
  const std::uint8_t proof = readProof(answer);
  if (known) {
    unresolved.resize(before);
    return false;
  }
  ++regions;
  facets += facet_count;
  if (proof != kNone) prove(static_cast<std::uint32_t>(described), proof);
  if (!is_proven[described]) ++unproven;
  return true;
}

MakeWorker countWorkers(const NormalisedProgram& program, const ExploreOptions& options,
                        const StrictComplementaritySystem& system, const LawSeparation& gap,
                        const std::vector<int>& names, const CountState& state) {
  return [&] { return std::make_unique<CountWorker>(program, options, system, gap, names, state); };
}

}  // namespace polyfly
