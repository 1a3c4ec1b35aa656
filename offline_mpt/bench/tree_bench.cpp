#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "../test/map_in_memory.hpp"
#include "bench_commands.hpp"
#include "law_tree.hpp"
#include "map_export/export_map.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "offline_mpt/reduce_proven.hpp"

namespace polyfly::bench {
namespace {

constexpr std::size_t kSamples = 20000;
constexpr double kSameInput = 1e-6;

double input(const RegionMap& map, std::size_t law, std::size_t row, const std::vector<double>& theta) {
  const double* const gain = map.law(law) + row * (theta.size() + 1);
  double u = gain[theta.size()];
  for (std::size_t j = 0; j < theta.size(); ++j) u += gain[j] * theta[j];
  return u;
}

/// Bytes of the tables of the exported map.
std::size_t tableBytes(const RegionMap& map) {
  ExportOptions code;
  code.name = "map";
  return exportFlashBytes(map, code).tables;
}

/// Bytes of its tables: planes and laws in double, a node or leaf in two indices, of 16 bits where those suffice.
std::size_t tableBytes(const LawTree& tree, const RegionMap& map) {
  const std::size_t width = map.parameters().size() + 1, entries = 2 * tree.nodes.size() + 1;
  const std::size_t most = std::max({tree.usedPlanes(), map.lawCount(), entries});
  const std::size_t index = most <= std::numeric_limits<std::uint16_t>::max() ? 2 : 4;
  return sizeof(double) * width * (tree.usedPlanes() + map.inputs().size() * map.lawCount()) +
         2 * index * entries;
}

/// What a look-up in the reduced map takes, and its tables.
void addReduced(const RegionMap& map, Json& result) {
  ReduceOptions options;
  options.tree = TreeMode::kSmall;
  const ProvenReduction reduced = reduceProven(map, "reduced", options, {});
  result["reduced_proven"] = reduced.report.passed();
  if (!reduced.report.passed()) return;
  const RegionMap& view = reduced.image.view("reduced");
  result["reduced_regions"] = view.regionCount();
  result["reduced_nodes"] = view.nodeCount();
  result["reduced_depth"] = view.cost().depth;
  result["reduced_multiply_adds"] = view.cost().multiply_adds;
  result["reduced_table_bytes"] = tableBytes(view);
}

/// Of random parameters, the share that a region holds, and the number of those that the tree answers otherwise.
void addSamples(const RegionMap& map, const LawTree& tree, Json& result) {
  std::mt19937_64 random(1);
  std::size_t inside = 0, wrong = 0;
  std::vector<double> theta(map.parameters().size());
  for (std::size_t i = 0; i < kSamples; ++i) {
    for (std::size_t j = 0; j < theta.size(); ++j) {
      const Signal& signal = map.parameters()[j];
      theta[j] = std::uniform_real_distribution<double>(signal.lower, signal.upper)(random);
    }
    const Lookup lookup = map.locate(theta.data());
    if (lookup.status != LookupStatus::kInside) continue;
    ++inside;
    const std::size_t law = tree.law(theta.data());
    bool same = true;
    for (std::size_t row = 0; row < map.inputs().size(); ++row) {
      const double u = input(map, lookup.law, row, theta);
      same = same && std::abs(input(map, law, row, theta) - u) <= kSameInput * (1.0 + std::abs(u));
    }
    wrong += same ? 0 : 1;
  }
  result["inside"] = static_cast<double>(inside) / static_cast<double>(kSamples);
  result["law_tree_wrong"] = wrong;
}

}  // namespace

Json compareTrees(const TreeArguments& arguments) {
  const ParametricProgram program = loadProgram(arguments.problem);
  const Partition partition = explore(program);
  TreeOptions options;
  options.mode = TreeMode::kSmall;
  const MapInMemory memory(encode(program, partition, options));
  const RegionMap& map = memory.map();
  Json result = sizesOf(program, partition, map);
  result["table_bytes"] = tableBytes(map);
  const LawTree tree = buildLawTree(map, arguments.time_limit);
  result["law_tree_late"] = tree.is_late;
  if (tree.is_late) return result;
  result["law_tree_nodes"] = tree.nodes.size();
  result["law_tree_depth"] = tree.depth;
  result["law_tree_multiply_adds"] = map.parameters().size() * (tree.depth + map.inputs().size());
  result["law_tree_table_bytes"] = tableBytes(tree, map);
  addSamples(map, tree, result);
  addReduced(map, result);
  return result;
}

}  // namespace polyfly::bench
