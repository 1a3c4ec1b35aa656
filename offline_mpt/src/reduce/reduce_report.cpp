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
  std::snprintf(line, sizeof line, "merged                 %zu of %zu laws\n", stats.merged_laws, stats.laws);
  return text + line;
}

std::string reduceJson(const ReduceStats& stats, const MapSize& before, const MapSize& after, bool proven) {
  nlohmann::ordered_json json;
  json["proven"] = proven;
  json["distinct_laws"] = stats.laws;
  json["merged_laws"] = stats.merged_laws;
  for (const Count& count : counts(before, after)) {
    json["before"][count.key] = count.before;
    json["after"][count.key] = count.after;
  }
  return json.dump(2) + "\n";
}

}  // namespace polyfly
