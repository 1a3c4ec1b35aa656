#include "lookup_work.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace checker {
namespace {

/// Paths in one leaf that are looked at. From then on each path counts as taken.
constexpr std::uint64_t kMostTried = 20000;

LookupWork sum(const LookupWork& a, const LookupWork& b) {
  return {a.planes + b.planes, a.rows + b.rows, a.comparisons + b.comparisons};
}

LookupWork greater(const LookupWork& a, const LookupWork& b) {
  return {std::max(a.planes, b.planes), std::max(a.rows, b.rows), std::max(a.comparisons, b.comparisons)};
}

constexpr LookupWork kNode = {1, 0, 1};

LookupWork candidateWork(std::uint64_t rows) { return {rows, rows, 2 * rows + 4}; }

}  // namespace

// Sums of integers are exact, so only numbers of floating point have errors.
WorkProof::WorkProof(const ExportedCode& code, const ProofWatch& watch)
    : code_(code.tables), watch_(watch), cell_(code.tables.box), error_(code.tables.plane_error) {
  if (code.type == CodeType::kInt16) error_.assign(error_.size(), 0.0);
}

LookupWork WorkProof::run() {
  countPaths();
  descend(code_.root(), {0, 0, 2 * code_.p});
  return greatest_;
}

void WorkProof::countPaths() {
  const std::size_t nodes = code_.node_plane.size();
  rest_.assign(nodes + code_.leaves.size(), {});
  rest_of_leaf_.clear();
  for (std::size_t i = 0; i < code_.leaves.size(); ++i) {
    const std::vector<Candidate>& leaf = code_.leaves[i];
    std::vector<LookupWork> rest(leaf.size() + 1);
    for (std::size_t k = leaf.size(); k-- > 0;)
      rest[k] = sum(candidateWork(leaf[k].rows.size()), rest[k + 1]);
    rest_[nodes + i] = rest.front();
    rest_of_leaf_.push_back(std::move(rest));
  }
  // A child comes after its parents.
  for (std::size_t i = nodes; i-- > 0;)
    rest_[i] = sum(kNode, greater(rest_[code_.children[i][0]], rest_[code_.children[i][1]]));
}

bool WorkProof::mayRaise(const LookupWork& work, const LookupWork& rest) const {
  const LookupWork whole = sum(work, rest);
  return whole.planes > greatest_.planes || whole.rows > greatest_.rows ||
         whole.comparisons > greatest_.comparisons;
}

void WorkProof::raise(const LookupWork& work) { greatest_ = greater(greatest_, work); }

/// Where the computed value of a row is at most `limit`.
void WorkProof::addRow(std::uint32_t row, double limit) {
  const double* const plane = code_.planes.data() + std::size_t{row / 2} * (code_.p + 1);
  const double sign = row % 2 == 0 ? 1.0 : -1.0;
  // One unit for each of the sums.
  constexpr double kOwnRounding = 0x1p-51;
  const double constant = sign * plane[code_.p];
  const double rounding = kOwnRounding * (std::abs(constant) + std::abs(limit) + error_[row / 2]);
  cell_.add({plane, sign, constant + limit + error_[row / 2] + rounding});
}

bool WorkProof::isTaken() {
  ++tried_;
  return tried_ > kMostTried || !cell_.isEmpty();
}

/// The side with more work first, so that the other one is often left out.
void WorkProof::descend(std::uint32_t child, LookupWork work) {
  const std::size_t nodes = code_.node_plane.size();
  if (!mayRaise(work, rest_[child])) return;
  if (watch_.stop != nullptr && *watch_.stop) throw Stopped();
  if (child >= nodes) {
    tried_ = 0;
    search(static_cast<std::uint32_t>(child - nodes), 0, work);
    return;
  }
  const std::size_t size = cell_.size();
  const std::array<std::uint32_t, 2>& children = code_.children[child];
  const std::uint32_t first = rest_[children[1]].planes > rest_[children[0]].planes ? 1 : 0;
  for (const std::uint32_t side : {first, 1 - first}) {
    addRow(2 * code_.node_plane[child] + side, 0.0);
    tried_ = 0;
    if (isTaken()) descend(children[side], sum(work, kNode));
    cell_.shrink(size);
  }
}

/// From a candidate of a leaf on. It ends at a row that is violated by more than the tolerance, or with all rows held.
void WorkProof::search(std::uint32_t leaf, std::size_t candidate, LookupWork work) {
  const std::vector<Candidate>& candidates = code_.leaves[leaf];
  if (!mayRaise(work, rest_of_leaf_[leaf][candidate])) return;
  if (candidate == candidates.size() || tried_ > kMostTried) {
    raise(sum(work, rest_of_leaf_[leaf][candidate]));
    return;
  }
  const Candidate& tested = candidates[candidate];
  const std::size_t size = cell_.size();
  for (std::size_t k = 0; k < tested.rows.size(); ++k) {
    const std::size_t held = cell_.size();
    addViolatedRow(tested.rows[k], code_.tolerance);
    goOn(leaf, candidate + 1, sum(work, candidateWork(k + 1)));
    cell_.shrink(held);
    addRow(tested.rows[k], code_.tolerance);
  }
  const LookupWork whole = sum(work, candidateWork(tested.rows.size()));
  if (!isTaken()) {
    cell_.shrink(size);
    return;
  }
  raise(whole);
  // The look-up goes on after a fallback region, and where a row is violated by less than the tolerance.
  if (tested.is_fallback) {
    goOn(leaf, candidate + 1, whole);
  } else {
    const std::size_t held = cell_.size();
    for (const std::uint32_t row : tested.rows) {
      addViolatedRow(row, 0.0);
      goOn(leaf, candidate + 1, whole);
      cell_.shrink(held);
    }
  }
  cell_.shrink(size);
}

/// The next candidate, where some parameter comes to it.
void WorkProof::goOn(std::uint32_t leaf, std::size_t candidate, const LookupWork& work) {
  if (mayRaise(work, rest_of_leaf_[leaf][candidate]) && isTaken()) search(leaf, candidate, work);
}

}  // namespace checker
