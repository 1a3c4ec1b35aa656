#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "region_maps/map_content.hpp"

namespace polyfly {

/// Regions in scaled parameters: each parameter's range is [-1, 1]. A plane is p + 1 numbers (a, c) with |a| = 1,
/// the half-space a . t <= c. Rows refer to planes as MapContent::rows does.
struct TreeRegions {
  int p = 0;
  std::vector<double> planes;
  std::vector<std::vector<std::int32_t>> rows;  ///< per region
  std::vector<double> centres;                  ///< per region p numbers, strictly inside
  /// Per region its law. Where it is given, planes that divide laws come before those that divide regions only.
  std::vector<std::uint32_t> laws;
};

/// Why a tree has grown no further.
enum class TreeEnd : std::uint8_t {
  kNoGain,  ///< No split shortens a look-up any more.
  kLittleGain,
  kNodes,    ///< The limit of nodes was reached.
  kBytes,    ///< The tree takes much more memory than the regions.
  kMemory,   ///< TreeOptions::memory_limit
  kPivots,   ///< It took as long as the mode allows.
  kStopped,  ///< TreeOptions::stop
};
const char* toString(TreeEnd end);

struct SearchTree {
  TreeEnd end = TreeEnd::kNoGain;
  std::uint32_t root = MapContent::kLeaf;
  std::uint32_t depth = 0;
  std::uint64_t worst = 0;   ///< half-spaces that the worst look-up evaluates, nodes and candidates' rows
  std::uint64_t pivots = 0;  ///< simplex pivots that it took
  std::vector<MapContent::Node> nodes;  ///< children follow their parents
  std::vector<MapContent::Leaf> leaves;
  std::vector<std::uint32_t> candidates;
  /// Per candidate the rows to test, as MapContent::tests: those that the planes on the path to the leaf, and the
  /// box, do not imply.
  std::vector<std::uint32_t> tests;
};

/// How much work and memory a tree may take for fast look-ups.
enum class TreeMode : std::uint8_t {
  kNone,  ///< No nodes: a look-up tests all regions.
  kFast,  ///< About as long as the exploration took, by its simplex pivots.
  /// Until further nodes gain little, or the tree takes much more memory than the regions. Also until 150 simplex
  /// pivots per half-space of the regions (and more than about 0.4 s). From 5 parameters on 60 are enough where the
  /// worst look-up evaluates at most one half-space of 64.
  kAuto,
  kSmall,  ///< Until no split shortens a look-up any more.
};
const char* toString(TreeMode mode);

struct TreeOptions {
  TreeMode mode = TreeMode::kAuto;
  /// Greatest number of interior nodes. 0: 64 per region in kSmall, 2 per region in the other modes.
  std::uint64_t node_limit = 0;
  /// Simplex pivots of the exploration: the measure of kFast.
  std::uint64_t explored_pivots = 0;
  /// What its cells may take while it grows [bytes]. Above two thirds of it, the tree grows in one cell after the other.
  std::uint64_t memory_limit = std::uint64_t{3} << 29;
  /// Planes of a cell whose split is computed exactly, the best by estimates, at least 1. kSmall builds two
  /// more trees with 4 and with 20, where those are more, and keeps the one with the shortest worst look-up.
  std::uint64_t planes_tried = 3;
  /// Look-ups test all rows of a candidate: the leaves of the map will not name any, and `tests` stays empty.
  bool all_rows = false;
  /// A part of a region that reaches no further across a plane is left to the other side [scaled].
  double side_tolerance = 1e-12;
  /// No plane crosses another one of its path, within the box, at a smaller angle: the sum of the differences of unit
  /// planes. Rounding to doubles alone needs 1e-4, which holds in any case.
  double least_angle = 0.0;
  /// No cell is made whose inscribed ball has a smaller radius [scaled].
  double least_cell = 0.0;
  /// Number of threads. The tree does not depend on it.
  int threads = 1;
  /// Set from outside to end early, with the tree as far as it has grown.
  const std::atomic<bool>* stop = nullptr;
  /// Called now and then from the calling thread.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
};

/// Binary search tree over the regions' own planes (Tondel, Johansen and Bemporad, 2003), grown from its worst leaf.
/// That is the one whose look-up evaluates the most half-spaces, nodes on the path and rows of its candidates
/// together.
///
/// Linear programs decide on which sides of a plane a region stays. It stays on each side on which its part within
/// the cell of the node reaches further than side_tolerance. Of its rows, those count that bound this part within the
/// cell, unless all_rows is set. Each split takes the plane after which the fuller side has the fewest rows to test.
SearchTree buildTree(const TreeRegions& regions, const TreeOptions& options = {});

/// Makes it the search tree of the map: all but its notes.
void moveTree(SearchTree tree, MapContent& content);

}  // namespace polyfly
