#include "export_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace checker {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double roundedUp(double value) { return std::nextafter(value, kInfinity); }

/// The box of the code, and all parameters that are rounded into it.
Box widened(const LookupTables& code) {
  Box box = code.box;
  for (std::size_t i = 0; i < box.size(); ++i) {
    const double rounding = roundedUp(2.0 * code.parameter_error[i]);
    box.lower[i] -= rounding;
    box.upper[i] += rounding;
  }
  return box;
}

}  // namespace

ExportProof::ExportProof(const Map& map, const LookupTables& code, const ProofWatch& watch)
    : regions_(map), watch_(watch), map_(lookupOf(map)), code_(code), cell_(map_.box) {
  require(code_.p == map_.p && code_.q == map_.q,
          "the code has other numbers of parameters or inputs than the map");
  answers_.error.assign(map_.q, 0.0);
}

ExportedAnswers ExportProof::run() {
  compareBoxes();
  // Half-spaces of both that are nearly but not quite parallel would make bases that are nearly singular.
  code_ = withPlanesOf(map_, std::move(code_), kInfinity);
  descend(code_.root(), map_.root());
  const Box code_box = widened(code_);
  cell_ = Cell(code_box);
  visitCandidates(code_, code_.root(), [this](const Candidate& candidate) { boundRows(candidate); });
  return answers_;
}

void ExportProof::compareBoxes() const {
  for (std::size_t i = 0; i < map_.p; ++i) {
    require(code_.box.lower[i] <= map_.box.lower[i] && code_.box.upper[i] >= map_.box.upper[i],
            "the code's box does not hold the map's");
  }
}

/// Where the computed value of a row is at most `limit`.
void ExportProof::addRow(const LookupTables& tables, std::uint32_t row, double limit) {
  const double* const plane = tables.planes.data() + std::size_t{row / 2} * (tables.p + 1);
  const double sign = row % 2 == 0 ? 1.0 : -1.0;
  const double error = tables.plane_error[row / 2];
  cell_.add({plane, sign, roundedUp(roundedUp(sign * plane[tables.p] + limit) + error)});
}

/// Where the computed value of a row is at least `limit`.
void ExportProof::addOutsideRow(const LookupTables& tables, std::uint32_t row, double limit) {
  addRow(tables, row ^ 1u, -limit);
}

/// All pairs of leaves at which code and map arrive for one theta. `cell_` is where they do.
void ExportProof::descend(std::uint32_t code_child, std::uint32_t map_child) {
  const std::size_t size = cell_.size();
  const bool code_descends = code_child < code_.node_plane.size();
  const bool map_descends = map_child < map_.node_plane.size();
  if (!code_descends && !map_descends) {
    compare(static_cast<std::uint32_t>(code_child - code_.node_plane.size()),
            static_cast<std::uint32_t>(map_child - map_.node_plane.size()));
    return;
  }
  for (std::size_t code_side = 0; code_side < (code_descends ? 2 : 1); ++code_side) {
    for (std::size_t map_side = 0; map_side < (map_descends ? 2 : 1); ++map_side) {
      std::uint32_t next_code = code_child, next_map = map_child;
      if (code_descends) {
        addRow(code_, 2 * code_.node_plane[code_child] + static_cast<std::uint32_t>(code_side), 0.0);
        next_code = code_.children[code_child][code_side];
      }
      if (map_descends) {
        addRow(map_, 2 * map_.node_plane[map_child] + static_cast<std::uint32_t>(map_side), 0.0);
        next_map = map_.children[map_child][map_side];
      }
      if (!cell_.isEmpty()) descend(next_code, next_map);
      cell_.shrink(size);
    }
  }
}

/// Visits the parts of the cell in which each of the candidates violates a row by more than the tolerance as computed.
void ExportProof::withoutHeld(const LookupTables& tables, const Candidates& candidates,
                              const std::function<void()>& visit) {
  if (candidates.first == candidates.end) {
    visit();
    return;
  }
  const std::size_t size = cell_.size();
  const Candidates others = {candidates.first + 1, candidates.end};
  const std::vector<std::uint32_t>& rows = candidates.first->rows;
  // A candidate that holds nowhere in the cell cuts nothing off. Its rows would cut the cell into ever more parts. To leave
  // a cut out is safe: more is visited.
  for (const std::uint32_t row : rows) addRow(tables, row, tables.tolerance);
  const bool holds_nowhere = cell_.isEmpty();
  cell_.shrink(size);
  if (holds_nowhere) return withoutHeld(tables, others, visit);
  for (const std::uint32_t row : rows) {
    addOutsideRow(tables, row, tables.tolerance);
    if (!cell_.isEmpty()) withoutHeld(tables, others, visit);
    cell_.shrink(size);
    // The other parts hold this row.
    addRow(tables, row, tables.tolerance);
  }
  cell_.shrink(size);
}

/// Visits the candidates of a leaf that a look-up may choose, with the part of the cell in which it may.
void ExportProof::choices(const LookupTables& tables, const std::vector<Candidate>& leaf, bool visits_outside,
                          const Visit& visit) {
  for (const Candidate& candidate : leaf) {
    const std::size_t before = cell_.size();
    for (const std::uint32_t row : candidate.rows) addRow(tables, row, tables.tolerance);
    if (!cell_.isEmpty()) visit(&candidate);
    cell_.shrink(before);
  }
  if (visits_outside) withoutHeld(tables, {leaf.data(), leaf.data() + leaf.size()}, [&] { visit(nullptr); });
}

void ExportProof::look() {
  if (watch_.stop != nullptr && *watch_.stop) throw Stopped();
  if (watch_.progress) watch_.progress(pairs_);
}

void ExportProof::compare(std::uint32_t code_leaf, std::uint32_t map_leaf) {
  look();
  ++pairs_;
  choices(map_, map_.leaves[map_leaf], false, [&](const Candidate* map_choice) {
    choices(code_, code_.leaves[code_leaf], true, [&](const Candidate* code_choice) {
      if (code_choice == nullptr) {
        answers_.missing.emplace(code_leaf, map_choice->region);
      } else {
        boundLaws(*code_choice, *map_choice);
      }
    });
  });
}

/// Raises the error to the greatest difference of two laws in the cell.
void ExportProof::boundLaws(const Candidate& code, const Candidate& map) {
  const std::size_t p = map_.p;
  std::vector<double>& error = answers_.error;
  std::vector<double> difference(p);
  for (std::size_t j = 0; j < map_.q; ++j) {
    const std::size_t code_row = std::size_t{code.law} * map_.q + j,
                      map_row = std::size_t{map.law} * map_.q + j;
    const double* const a = code_.laws.data() + code_row * (p + 1);
    const double* const b = map_.laws.data() + map_row * (p + 1);
    // What rounding takes from the differences themselves.
    double own = std::abs(a[p] - b[p]);
    double anywhere = own;
    for (std::size_t i = 0; i < p; ++i) {
      own += std::abs(a[i] - b[i]) * map_.box.greatest(i);
      anywhere = own;
    }
    own *= 4.0 * std::numeric_limits<double>::epsilon();
    const double rounding = code_.law_error[code_row] + map_.law_error[map_row] + own;
    // Less than what is stated already, all over the box.
    if ((anywhere + rounding) * (1.0 + 1e-9) <= error[j]) continue;
    for (const double sign : {1.0, -1.0}) {
      for (std::size_t i = 0; i < p; ++i) difference[i] = sign * (a[i] - b[i]);
      const double bound = cell_.upperBound(difference, sign * (a[p] - b[p]));
      require(!std::isnan(bound), "the laws' difference has no bound");
      error[j] = std::max(error[j], roundedUp(roundedUp(bound + rounding)));
    }
  }
}

/// Visits all candidates of all leaves, with the cell in which the look-up may choose each.
void ExportProof::visitCandidates(const LookupTables& tables, std::uint32_t child,
                                  const std::function<void(const Candidate&)>& visit) {
  const std::size_t size = cell_.size();
  if (child < tables.node_plane.size()) {
    for (std::size_t side = 0; side < 2; ++side) {
      addRow(tables, 2 * tables.node_plane[child] + static_cast<std::uint32_t>(side), 0.0);
      if (!cell_.isEmpty()) visitCandidates(tables, tables.children[child][side], visit);
      cell_.shrink(size);
    }
    return;
  }
  for (const Candidate& candidate : tables.leaves[child - tables.node_plane.size()]) {
    for (const std::uint32_t row : candidate.rows) addRow(tables, row, tables.tolerance);
    visit(candidate);
    cell_.shrink(size);
  }
}

/// How far outside of its region the code may use the law of this candidate.
void ExportProof::boundRows(const Candidate& candidate) {
  look();
  const std::size_t p = map_.p;
  require(candidate.region < regions_.regions.size(), "a candidate of the code is no region of the map");
  const Map::Region& region = regions_.regions[candidate.region];
  std::vector<double> normal(p);
  for (std::uint32_t i = 0; i < region.row_count; ++i) {
    const std::int32_t row = regions_.rows[region.first_row + i];
    const double* const plane = map_.planes.data() + (std::size_t(std::abs(row)) - 1) * (p + 1);
    const double sign = row < 0 ? -1.0 : 1.0;
    for (std::size_t k = 0; k < p; ++k) normal[k] = sign * plane[k];
    const double bound = cell_.upperBound(normal, -sign * plane[p]);
    require(!std::isnan(bound), "a half-space's violation has no bound");
    answers_.margin = std::max(answers_.margin, bound);
  }
}

void requireSameTables(const Map& map, const LookupTables& exported) {
  const LookupTables same = lookupOf(map);
  require(exported.p == same.p, "the code has another number of parameters than the map");
  const LookupTables code = withPlanesOf(same, exported, 0.0);
  require(code.box.lower == same.box.lower && code.box.upper == same.box.upper,
          "the code's box is not the map's");
  require(code.laws == same.laws && code.q == same.q, "the code's laws are not the map's");
  require(code.tolerance == same.tolerance, "the code's tolerance is not the map's");
  require(code.node_plane == same.node_plane && code.children == same.children && code.root() == same.root(),
          "the code's search tree is not the map's");
  require(code.leaves.size() == same.leaves.size(), "the code's leaves are not the map's");
  const auto equal = [](const LookupTables::Candidate& a, const LookupTables::Candidate& b) {
    return a.region == b.region && a.law == b.law && a.rows == b.rows;
  };
  for (std::size_t i = 0; i < code.leaves.size(); ++i) {
    require(std::equal(code.leaves[i].begin(), code.leaves[i].end(), same.leaves[i].begin(),
                       same.leaves[i].end(), equal),
            "a leaf of the code is not the map's");
  }
}

ExportedAnswers exportedAnswers(const Map& map, const ExportedCode& code, const ProofWatch& watch) {
  if (code.type != CodeType::kDouble) return ExportProof(map, code.tables, watch).run();
  requireSameTables(map, code.tables);
  return {std::vector<double>(map.q, 0.0), {}, map.tolerance};
}

}  // namespace checker
