#include "map_plot/slice.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "error_of.hpp"
#include "map_fixture.hpp"

namespace polyfly {
namespace {

constexpr int kPlanes = 5;
constexpr double kNearPlane = 1e-6;  // grid points this close to a border are not judged [scaled]

// Crossing-number test, which shares nothing with clipping.
bool holds(const SlicePolygon& polygon, double x, double y) {
  bool inside = false;
  const auto& ring = polygon.corners;
  for (std::size_t here = 0, before = ring.size() - 1; here < ring.size(); before = here++) {
    const bool crosses = (ring[here].second > y) != (ring[before].second > y);
    if (crosses && x < (ring[before].first - ring[here].first) * (y - ring[here].second) /
                               (ring[before].second - ring[here].second) +
                           ring[here].first) {
      inside = !inside;
    }
  }
  return inside;
}

// The cell that holds theta by the signs of the planes alone, or -1 near a border.
int cellOf(const MapContent& content, const std::vector<double>& theta) {
  int cell = 0;
  for (int plane = 0; plane < kPlanes; ++plane) {
    const double* row = &content.planes[static_cast<std::size_t>(plane) * 4];
    const double excess = row[0] * theta[0] + row[1] * theta[1] + row[2] * theta[2] - row[3];
    if (std::abs(excess) < kNearPlane) return -1;
    if (excess < 0.0) cell |= 1 << plane;
  }
  return cell;
}

class SliceOfArrangement : public testing::TestWithParam<unsigned> {};

TEST_P(SliceOfArrangement, agreesWithPointLocationOnAGrid) {
  const MapContent content = arrangement(GetParam(), kPlanes);
  const MapInMemory memory(content);
  const Slice cut = slice(memory.map(), {"alpha", "beta", {{"gamma", 0.1}}});
  ASSERT_EQ(cut.x, 0);
  ASSERT_EQ(cut.y, 1);
  int judged = 0;
  constexpr int kSteps = 83;
  for (int column = 1; column < kSteps; ++column) {
    for (int row = 1; row < kSteps; ++row) {
      const std::vector<double> theta = {-1.0 + 3.0 * column / kSteps, 1.0 + 8.0 * row / kSteps, 0.1};
      const int cell = cellOf(content, theta);
      if (cell < 0) continue;
      std::vector<int> found;
      for (const SlicePolygon& polygon : cut.polygons) {
        if (holds(polygon, theta[0], theta[1])) found.push_back(static_cast<int>(polygon.region));
      }
      EXPECT_EQ(found, std::vector<int>{cell}) << "at " << theta[0] << ", " << theta[1];
      ++judged;
    }
  }
  EXPECT_GT(judged, kSteps * kSteps * 9 / 10);
}

TEST_P(SliceOfArrangement, fillsTheBoxWithCounterClockwisePolygons) {
  const MapInMemory memory(arrangement(GetParam(), kPlanes));
  const Slice cut = slice(memory.map(), {"gamma", "alpha", {}});
  EXPECT_DOUBLE_EQ(cut.theta[1], 5.0);  // zero is not in beta's range, so its middle
  double sum = 0.0;
  for (const SlicePolygon& polygon : cut.polygons) {
    double twice = 0.0;
    for (std::size_t corner = 0; corner < polygon.corners.size(); ++corner) {
      const auto& [x0, y0] = polygon.corners[corner];
      const auto& [x1, y1] = polygon.corners[(corner + 1) % polygon.corners.size()];
      twice += x0 * y1 - x1 * y0;
    }
    EXPECT_GT(twice, 0.0);
    EXPECT_EQ(polygon.law, polygon.region);
    sum += 0.5 * twice;
  }
  EXPECT_NEAR(sum, 1.0 * 3.0, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Seeds, SliceOfArrangement, testing::Range(1u, 13u));

TEST(Slice, keepsOrDropsARegionWhosePlaneIsParallelToTheSlice) {
  MapContent content = arrangement(1, 1);
  content.planes = {0.0, 0.0, 2.0, 0.4};  // gamma <= 0.2
  const MapInMemory memory(content);
  const Slice below = slice(memory.map(), {"alpha", "beta", {{"gamma", -0.1}}});
  ASSERT_EQ(below.polygons.size(), 1u);
  EXPECT_EQ(below.polygons[0].region, 1u);
  EXPECT_EQ(below.polygons[0].corners.size(), 4u);
  const Slice above = slice(memory.map(), {"alpha", "beta", {{"gamma", 0.3}}});
  ASSERT_EQ(above.polygons.size(), 1u);
  EXPECT_EQ(above.polygons[0].region, 0u);
}

TEST(Slice, refusesBadRequestsByName) {
  const MapInMemory memory(arrangement(1, 2));
  const auto message = [&memory](const SliceRequest& request) {
    return errorOf([&] { slice(memory.map(), request); });
  };
  EXPECT_EQ(message({"alpha", "delta", {}}),
            "arrangement: slice: no parameter 'delta'; the map has alpha, beta, gamma");
  EXPECT_EQ(message({"alpha", "alpha", {}}), "arrangement: slice: both axes are 'alpha'");
  EXPECT_NE(message({"alpha", "beta", {{"beta", 2.0}}}).find("already an axis"), std::string::npos);
  EXPECT_NE(message({"alpha", "beta", {{"gamma", 0.0}, {"gamma", 0.1}}}).find("given before"),
            std::string::npos);
  EXPECT_NE(message({"alpha", "beta", {{"gamma", 0.6}}}).find("outside its range"), std::string::npos);
  EXPECT_NE(message({"alpha", "beta", {{"gamma", std::nan("")}}}).find("outside its range"),
            std::string::npos);
}

TEST(SlicePanel, coversTheSliceWithBandsOfTheInput) {
  const MapInMemory memory(arrangement(3, kPlanes));
  const Slice cut = slice(memory.map(), {"alpha", "beta", {}});
  const Panel panel = slicePanel(memory.map(), cut);
  double sum = 0.0;
  for (const Patches& patches : panel.patches) {
    // Outlines have no fill.
    if (patches.fill.empty()) continue;
    for (const auto& ring : patches.polygons) {
      for (std::size_t corner = 0; corner < ring.size(); ++corner) {
        const auto& [x0, y0] = ring[corner];
        const auto& [x1, y1] = ring[(corner + 1) % ring.size()];
        sum += 0.5 * (x0 * y1 - x1 * y0);
      }
    }
  }
  EXPECT_NEAR(sum, 3.0 * 8.0, 1e-9);
  EXPECT_EQ(panel.x_label, "alpha [m]");
  EXPECT_EQ(panel.y_label, "beta [m/s]");
  ASSERT_TRUE(panel.scale.has_value());
  EXPECT_EQ(panel.scale->label, "u [rad]");
}

TEST(PlotSlice, writesBothKindsOfPicture) {
  const MapInMemory memory(arrangement(3, kPlanes));
  for (const char* ending : {"svg", "png"}) {
    const std::string path =
        testing::TempDir() + "polyfly_slice_" + std::to_string(getpid()) + " 'quoted; name." + ending;
    plotSlice(memory.map(), {"alpha", "beta", {}}, path);
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    EXPECT_NE(bytes.substr(0, 400).find(ending == std::string("svg") ? "<svg" : "\x89PNG"),
              std::string::npos);
    std::remove(path.c_str());
  }
}

}  // namespace
}  // namespace polyfly
