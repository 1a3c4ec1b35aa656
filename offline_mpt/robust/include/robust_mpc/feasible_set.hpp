#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "robust_mpc/robust_program.hpp"

namespace polyfly {

/// {y = (theta, u~_0, tau) : some z meets all rows of the program}, exactly: the projection of the feasible
/// set of Eq. 34 on what the first move needs.
struct FeasibleSet {
  /// One scenario of a program row (its terms with these signs) and its weight in a facet.
  struct Part {
    int row = 0;
    std::vector<bool> negative;
    Rational weight;  ///< > 0
  };
  struct Facet {
    /// The half-space in y, in whole numbers without a common factor.
    ExactHalfSpace half_space;
    /// Whether the facet is a row of the box of theta alone.
    bool of_box = false;
    /// Parts whose weighted sum is a multiple of the half-space. z cancels in the sum.
    std::vector<Part> parts;
  };
  struct Vertex {
    RationalVector y;
    std::vector<int> facets;    ///< sorted: those it lies on
    RationalVector prediction;  ///< a z that meets every row with it; empty where none was computed
  };
  struct Stats {
    /// Linear programs solved in floating point.
    std::uint64_t linear_programs = 0;
    std::uint64_t pivots = 0;
    /// Vertices that no basis found in floating point could decide.
    std::uint64_t exact_programs = 0;
    /// Facets that only exact arithmetic found.
    std::uint64_t exact_cuts = 0;
    std::uint64_t vertices_proven = 0;
  };

  int dimension = 0;
  std::vector<Facet> facets;     ///< none redundant, sorted
  std::vector<Vertex> vertices;  ///< sorted; besides, y may be moved towards greater tau without end
  bool proven = false;           ///< every vertex was shown feasible in exact arithmetic
  bool interrupted = false;      ///< by ProjectOptions::stop; then no facets and vertices are told
  Stats stats;
};

struct ProjectOptions {
  /// Prove that every vertex has a prediction that meets all rows exactly, and repair the set where one has
  /// not. Without it vertices are decided in floating point; facets and vertices are exact all the same.
  bool exact = true;
  int threads = 1;  ///< at least 1; the result does not depend on it
  const std::atomic<bool>* stop = nullptr;
  std::function<void(std::uint64_t facets, std::uint64_t vertices, std::uint64_t open)> progress;
  /// Half-spaces of an earlier projection of this program to begin with, as readCuts returns them.
  std::vector<FeasibleSet::Facet> known;
  /// Called between passes over the vertices, and once it was stopped, with all half-spaces so far.
  std::function<void(const std::vector<FeasibleSet::Facet>&)> save;
};

/// By outer approximation, until every vertex is feasible. A linear program tests each vertex of the polyhedron so
/// far: how far must it be moved towards an interior point? Its dual solution, solved again in fractions, is a facet
/// that cuts the vertex off. Throws Error when no theta in the box has a solution with room around it.
FeasibleSet projectFeasibleSet(const RobustProgram& program, const ProjectOptions& options = {});

/// Writes the half-spaces by their parts, as JSON, to a file that replaces `path` when it is whole. Throws Error.
void writeCuts(const std::string& path, const std::vector<FeasibleSet::Facet>& cuts);

/// Reads them back and proves each by its parts, as proveFacets does. So a projection that begins with them ends with
/// the same set, whatever the file holds. Throws Error that names `path` and the half-space.
std::vector<FeasibleSet::Facet> readCuts(const std::string& path, const RobustProgram& program);

/// Checks that each facet is the weighted sum of its parts, in which the predictions cancel: then no feasible
/// y breaks it. Needs nothing that the projection computed but the parts.
bool proveFacets(const RobustProgram& program, const FeasibleSet& set);

/// Checks that the prediction of each vertex meets every row: then all between the vertices, and above them
/// in tau, is feasible.
bool proveVertices(const RobustProgram& program, const FeasibleSet& set);

}  // namespace polyfly
