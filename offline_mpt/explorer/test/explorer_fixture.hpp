#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "explorer_content/explorer_content.hpp"
#include "region_maps/region_map.hpp"
#include "scratch_folder.hpp"

namespace polyfly {

/// Of numbers that browser and library sum in the same order.
constexpr double kSameSum = 1e-12;

/// Half of 1,000 points anywhere in the box and a little around it, half on facets.
std::vector<std::vector<double>> pointsOf(const RegionMap& map, unsigned seed);

ExplorerFlight asFlight(const std::vector<std::vector<double>>& points);

/// Compares what the page shows at points with the library's look-ups.
void expectSameAnswers(const RegionMap& map, const std::vector<std::vector<double>>& points,
                       const nlohmann::json& answers);

/// Skips where there is no browser.
class Explorer : public ::testing::Test {
 protected:
  void SetUp() override;

  /// Runs offline_mpt.
  static void run(const std::string& arguments);
  /// Path of the map of a problem file.
  std::string solve(const std::string& file);
  /// Path of the page of a map.
  std::string savePage(const RegionMap& map, const ExplorerContent& content);

  ScratchFolder folder_;
};

}  // namespace polyfly
