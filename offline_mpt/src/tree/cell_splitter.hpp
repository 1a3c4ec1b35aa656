#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "offline_mpt/search_tree.hpp"
#include "tree/cell.hpp"
#include "tree/cell_solver.hpp"
#include "tree/member_solver.hpp"

namespace polyfly {

/// A plane and what it leaves on its sides.
struct CellSplit {
  std::size_t plane = 0;
  Cell below;
  Cell above;
};

/// Chooses planes and splits cells. What it returns depends on the cell alone.
class CellSplitter {
 public:
  /// `regions` must outlive the object.
  CellSplitter(const TreeRegions& regions, const TreeOptions& options);

  /// All regions, to begin with.
  Cell whole();

  /// Half-spaces that a look-up tests in the cell at most.
  std::size_t tests(const Cell& cell) const;

  /// Splits the cell by the plane after which the fuller side has the fewest rows to test, and takes its members.
  /// Nothing, and the cell stays, where no plane shortens its look-ups. Different threads may split
  /// different cells; `thread` is 0 .. TreeOptions::threads - 1.
  std::optional<CellSplit> split(Cell& cell, std::size_t thread);

  /// The same with all threads, for a cell with many members.
  std::optional<CellSplit> splitTogether(Cell& cell);

  /// Completes the rows to test of a leaf's members, see MemberSolver::addRowsForTolerance.
  void finishLeaf(Cell& cell, std::size_t thread);

  /// The rows to test of a member, as MapContent::tests.
  std::uint32_t testsOf(const CellMember& member) const { return solvers_.front().members.testsOf(member); }

  /// Simplex pivots of all threads.
  std::uint64_t pivots() const;

 private:
  /// What a thread asks.
  struct Solvers {
    MemberSolver members;
    CellSolver cells;

    std::uint64_t pivots() const { return members.pivots() + cells.pivots(); }
  };

  /// The rows to test that a plane leaves on its sides.
  struct Estimate {
    std::size_t plane = 0;
    std::size_t below = 0;
    std::size_t above = 0;
    /// On the side with more of them; 0 where laws do not count.
    std::size_t laws = 0;

    std::size_t fuller() const { return below > above ? below : above; }
    void add(unsigned sides, std::size_t rows);
    /// Whether a plane with at least so much on its sides may be as good as the other one.
    bool mayReach(const Estimate& other) const;
    bool isBetterThan(const Estimate& other) const;
  };

  std::size_t tests(const CellMember& member) const;
  std::size_t testsBesides(const CellMember& member, std::size_t plane) const;
  template <class ForEach>
  std::optional<CellSplit> splitWith(Cell& cell, Solvers& own, const ForEach& for_each);
  /// Whether the plane crosses one on the cell's path within the box at an angle below the least one.
  bool makesSharpEdge(const Cell& cell, std::size_t plane) const;
  bool hasBadSide(const Cell& cell, std::size_t plane, const std::vector<unsigned char>& sides,
                  Solvers& solvers) const;
  template <class ForEach>
  std::optional<Estimate> bestOf(Cell& cell, std::vector<Estimate> estimates, Solvers& own,
                                 const ForEach& for_each, std::vector<unsigned char>& best_sides);
  bool isBetter(Cell& cell, const Estimate& best, MemberSolver& solver, Estimate& exact,
                std::vector<unsigned char>& sides) const;
  std::vector<Estimate> estimate(const Cell& cell, bool& is_short) const;
  std::vector<Estimate> scored(const Cell& cell, const std::vector<std::size_t>& planes,
                               std::size_t most) const;
  std::vector<std::size_t> planesOf(const Cell& cell) const;
  std::size_t lawsOf(const Cell& cell, const std::vector<unsigned char>& sides, unsigned side) const;
  void estimateLaws(const Cell& cell, std::size_t step, const std::vector<std::size_t>& planes,
                    std::vector<Estimate>& estimates) const;
  template <class ForEach>
  CellSplit divide(Cell& cell, std::size_t plane, const std::vector<unsigned char>& sides,
                   const ForEach& for_each);

  const TreeRegions& regions_;
  int threads_;
  std::size_t planes_tried_;
  // kSmall: estimates by all members, and all points that exact splits find.
  bool is_thorough_;
  bool all_rows_;
  double side_tolerance_;
  double least_cell_;
  double least_angle_;
  std::vector<Solvers> solvers_;  // one per thread
};

}  // namespace polyfly
