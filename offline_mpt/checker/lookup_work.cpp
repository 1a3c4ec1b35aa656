#include "lookup_work.hpp"

#include <algorithm>
#include <vector>

namespace checker {
namespace {

LookupWork sum(const LookupWork& a, const LookupWork& b) {
  return {a.sums + b.sums, a.comparisons + b.comparisons};
}

LookupWork greater(const LookupWork& a, const LookupWork& b) {
  return {std::max(a.sums, b.sums), std::max(a.comparisons, b.comparisons)};
}

LookupWork leafWork(const LookupTables& code, const std::vector<LookupTables::Candidate>& leaf) {
  LookupWork work = {code.q, 0};
  for (const LookupTables::Candidate& candidate : leaf) {
    const std::uint64_t rows = candidate.rows.size();
    work = sum(work, {rows, code.takes_first ? rows + 1 : 2 * rows + 2});
  }
  return work;
}

}  // namespace

LookupWork greatestWork(const LookupTables& code) {
  const std::size_t nodes = code.node_plane.size();
  std::vector<LookupWork> below(nodes);
  for (const std::vector<LookupTables::Candidate>& leaf : code.leaves) below.push_back(leafWork(code, leaf));
  // A child comes after its parents.
  for (std::size_t i = nodes; i-- > 0;)
    below[i] = sum({1, 1}, greater(below[code.children[i][0]], below[code.children[i][1]]));
  return sum({0, 2 * code.p}, below[code.root()]);
}

}  // namespace checker
