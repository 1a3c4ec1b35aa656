#include "lookup_work.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace checker {
namespace {

/// Parts into which PathSearch may cut the box for one path.
constexpr int kMostParts = 400;
/// Paths in one leaf that are looked at. From then on each path counts as taken.
constexpr std::uint64_t kMostTried = 20000;

constexpr std::uint64_t LookupWork::*kKinds[] = {&LookupWork::sums, &LookupWork::comparisons};

bool exceeds(const LookupWork& work, const LookupWork& other) {
  return std::any_of(std::begin(kKinds), std::end(kKinds),
                     [&](const auto kind) { return work.*kind > other.*kind; });
}

/// Both sides of a plane compare the same computed number.
bool contradict(const PathStep& a, const PathStep& b) {
  if (a.row != (b.row ^ 1u)) return false;
  const double room = a.limit + b.limit;
  return room < 0.0 || (room == 0.0 && (a.is_strict || b.is_strict));
}

}  // namespace

WorkProof::WorkProof(const ExportedCode& code, const ProofWatch& watch)
    : exported_(code),
      code_(code.tables),
      watch_(watch),
      paths_(code),
      cell_(code.tables.box),
      error_(code.tables.plane_error) {}

LookupWork WorkProof::run() {
  countPaths();
  // What is found with little effort leaves out most of the other paths.
  for (const int most_parts : {1, kMostParts}) {
    most_parts_ = most_parts;
    unknown_ = {};
    descend(code_.root(), {0, 2 * code_.p});
  }
  keepReached();
  greatest_ = greater(greatest_, unknown_);
  return greatest_;
}

void WorkProof::countPaths() {
  const std::size_t nodes = code_.node_plane.size();
  rest_.assign(nodes + code_.leaves.size(), {});
  rest_of_leaf_.clear();
  for (std::size_t i = 0; i < code_.leaves.size(); ++i) {
    const std::vector<Candidate>& leaf = code_.leaves[i];
    std::vector<LookupWork> rest(leaf.size() + 1, lawWork(code_));
    for (std::size_t k = leaf.size(); k-- > 0;)
      rest[k] = sum(candidateWork(code_, leaf[k].rows.size()), rest[k + 1]);
    rest_[nodes + i] = rest.front();
    rest_of_leaf_.push_back(std::move(rest));
  }
  // A child comes after its parents.
  for (std::size_t i = nodes; i-- > 0;)
    rest_[i] = sum(kNodeWork, greater(rest_[code_.children[i][0]], rest_[code_.children[i][1]]));
}

bool WorkProof::mayRaise(const LookupWork& work, const LookupWork& rest) const {
  return exceeds(sum(work, rest), greatest_);
}

/// At the end of a path. It counts where numbers take it, and where they are not proven not to.
void WorkProof::raise(const LookupWork& work) {
  if (!exceeds(work, greatest_)) return;
  const PathSearch::Verdict verdict = paths_.run(path_, most_parts_);
  // They may take another path with more work.
  if (!paths_.tried().empty()) reach(paths_.tried());
  if (verdict == PathSearch::Verdict::kImpossible) return;
  if (verdict == PathSearch::Verdict::kTaken) {
    reach(paths_.theta());
  } else {
    unknown_ = greater(unknown_, work);
  }
}

void WorkProof::reach(const std::vector<double>& theta) {
  const LookupWork work = workAt(exported_, theta);
  if (!exceeds(work, greatest_)) return;
  greatest_ = greater(greatest_, work);
  reached_.push_back(theta);
}

/// Of what was reached on the way, one parameter for each kind.
void WorkProof::keepReached() {
  std::vector<std::vector<double>> kept;
  for (const auto kind : kKinds) {
    const auto isGreatest = [&](const std::vector<double>& theta) {
      return workAt(exported_, theta).*kind == greatest_.*kind;
    };
    if (std::any_of(kept.begin(), kept.end(), isGreatest)) continue;
    const auto found = std::find_if(reached_.begin(), reached_.end(), isGreatest);
    if (found != reached_.end()) kept.push_back(*found);
  }
  reached_ = std::move(kept);
}

void WorkProof::addStep(const PathStep& step) {
  const double* const plane = code_.planes.data() + std::size_t{step.row / 2} * (code_.p + 1);
  const double sign = step.row % 2 == 0 ? 1.0 : -1.0;
  // One unit for each of the sums.
  constexpr double kOwnRounding = 0x1p-51;
  const double constant = sign * plane[code_.p];
  const double error = error_[step.row / 2];
  const double limit = step.limit;
  const double rounding = kOwnRounding * (std::abs(constant) + std::abs(limit) + error);
  cell_.add({plane, sign, constant + limit + error + rounding});
  const auto contradicts = [&step](const PathStep& other) { return contradict(step, other); };
  if (possible_ == path_.size() && std::none_of(path_.begin(), path_.end(), contradicts)) ++possible_;
  path_.push_back(step);
}

void WorkProof::shrink(std::size_t size) {
  cell_.shrink(size);
  path_.resize(size);
  possible_ = std::min(possible_, size);
}

bool WorkProof::isTaken() {
  ++tried_;
  if (possible_ < path_.size()) return false;
  return tried_ > kMostTried || !cell_.isEmpty();
}

/// The side with more work first, so that the other one is often left out.
void WorkProof::descend(std::uint32_t child, LookupWork work) {
  const std::size_t nodes = code_.node_plane.size();
  if (!mayRaise(work, rest_[child])) return;
  if (watch_.stop != nullptr && *watch_.stop) throw Stopped();
  if (child >= nodes) {
    tried_ = 0;
    search(static_cast<std::uint32_t>(child - nodes), 0, work, false);
    return;
  }
  const std::size_t size = path_.size();
  const std::array<std::uint32_t, 2>& children = code_.children[child];
  const std::uint32_t first = rest_[children[1]].sums > rest_[children[0]].sums ? 1 : 0;
  for (const std::uint32_t side : {first, 1 - first}) {
    const std::uint32_t row = 2 * code_.node_plane[child];
    side == 0 ? addRow(row, 0.0) : addViolatedRow(row, 0.0);
    tried_ = 0;
    if (isTaken()) descend(children[side], sum(work, kNodeWork));
    shrink(size);
  }
}

/// From a candidate of a leaf on. `has_answer`: an earlier one holds. It ends at a row that is violated by more than the tolerance, or with all rows held.
void WorkProof::search(std::uint32_t leaf, std::size_t candidate, LookupWork work, bool has_answer) {
  const std::vector<Candidate>& candidates = code_.leaves[leaf];
  if (!mayRaise(work, rest_of_leaf_[leaf][candidate])) return;
  if (tried_ > kMostTried) {
    unknown_ = greater(unknown_, sum(work, rest_of_leaf_[leaf][candidate]));
    return;
  }
  if (candidate == candidates.size()) return raise(has_answer ? sum(work, lawWork(code_)) : work);
  const Candidate& tested = candidates[candidate];
  const std::size_t size = path_.size();
  for (std::size_t k = 0; k < tested.rows.size(); ++k) {
    const std::size_t held = path_.size();
    addViolatedRow(tested.rows[k], code_.tolerance);
    goOn(leaf, candidate + 1, sum(work, candidateWork(code_, k + 1)), has_answer);
    shrink(held);
    addRow(tested.rows[k], code_.tolerance);
  }
  const LookupWork whole = sum(work, candidateWork(code_, tested.rows.size()));
  if (isTaken()) {
    raise(sum(whole, lawWork(code_)));
    if (!code_.takes_first) searchBeyond(leaf, candidate, whole);
  }
  shrink(size);
}

/// Where the least violation counts, the look-up goes on after a fallback region, and where a row is violated by less
/// than the tolerance.
void WorkProof::searchBeyond(std::uint32_t leaf, std::size_t candidate, const LookupWork& whole) {
  const Candidate& tested = code_.leaves[leaf][candidate];
  if (tested.is_fallback) return goOn(leaf, candidate + 1, whole, true);
  const std::size_t held = path_.size();
  for (const std::uint32_t row : tested.rows) {
    addViolatedRow(row, 0.0);
    goOn(leaf, candidate + 1, whole, true);
    shrink(held);
  }
}

/// The next candidate, where some parameter comes to it.
void WorkProof::goOn(std::uint32_t leaf, std::size_t candidate, const LookupWork& work, bool has_answer) {
  if (mayRaise(work, rest_of_leaf_[leaf][candidate]) && isTaken()) search(leaf, candidate, work, has_answer);
}

}  // namespace checker
