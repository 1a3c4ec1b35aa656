#include <cstdio>
#include <nlohmann/json.hpp>

#include "offline_mpt/reduce.hpp"

namespace polyfly {
namespace {

struct Count {
  const char* key;
  const char* words;
  std::uint64_t before;
  std::uint64_t after;
};

std::vector<Count> counts(const MapSize& before, const MapSize& after) {
  return {{"regions", "regions", before.regions, after.regions},
          {"laws", "laws", before.laws, after.laws},
          {"planes", "distinct planes", before.planes, after.planes},
          {"nodes", "nodes", before.nodes, after.nodes},
          {"leaves", "leaves", before.leaves, after.leaves},
          {"depth", "depth", before.cost.depth, after.cost.depth},
          {"region_checks", "half-spaces at a leaf", before.cost.region_checks, after.cost.region_checks},
          {"multiply_adds", "multiply-adds", before.cost.multiply_adds, after.cost.multiply_adds},
          {"bytes", "bytes", before.bytes, after.bytes}};
}

}  // namespace

std::string reduceText(const ReduceStats& stats, const MapSize& before, const MapSize& after) {
  std::string text;
  char line[128];
  for (const Count& count : counts(before, after)) {
    std::snprintf(line, sizeof line, "%-22s %llu -> %llu\n", count.words,
                  static_cast<unsigned long long>(count.before),
                  static_cast<unsigned long long>(count.after));
    text += line;
  }
  if (stats.merge != MergeMethod::kNone) {
    std::snprintf(line, sizeof line,
                  "merged                 %zu of %zu laws; %zu proven fewest, %zu greedily\n",
                  stats.merged_laws, stats.laws, stats.optimal_laws, stats.greedy_laws);
    text += line;
  }
  if (!stats.separation.empty()) text += "separation             " + stats.separation + "\n";
  return text;
}

std::string reduceJson(const ReduceStats& stats, const MapSize& before, const MapSize& after, bool proven) {
  nlohmann::ordered_json json;
  json["merge"] = toString(stats.merge);
  json["proven"] = proven;
  json["distinct_laws"] = stats.laws;
  json["merged_laws"] = stats.merged_laws;
  json["optimal_laws"] = stats.optimal_laws;
  json["greedy_laws"] = stats.greedy_laws;
  json["separated"] = stats.separated;
  json["separation"] = stats.separation;
  json["saturated_regions"] = stats.saturated_regions;
  json["fallback_regions"] = stats.fallback_regions;
  json["separating_planes"] = stats.separating_planes;
  for (const Count& count : counts(before, after)) {
    json["before"][count.key] = count.before;
    json["after"][count.key] = count.after;
  }
  return json.dump(2) + "\n";
}

}  // namespace polyfly
