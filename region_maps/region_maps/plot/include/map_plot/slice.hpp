#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "map_plot/figure.hpp"

namespace polyfly {

class RegionMap;
struct Signal;

/// A plane through the parameter space: two parameters are free, the others fixed.
struct SliceRequest {
  std::string x;  ///< name of the parameter along x
  std::string y;  ///< name of the parameter along y
  /// Values of the others by name, in the parameter's unit. Not named: 0 where the box holds it, else the
  /// box's middle.
  std::vector<std::pair<std::string, double>> at;
};

/// A region of the map, cut by the plane.
struct SlicePolygon {
  std::uint32_t region = 0;
  std::uint32_t law = 0;
  std::vector<std::pair<double, double>> corners;  ///< convex, counter-clockwise, in the parameters' units
};

struct Slice {
  /// Index of the parameter along x.
  int x = 0;
  /// Index of the parameter along y.
  int y = 0;
  /// Ranges along x and y, those of the box.
  Panel::Range x_range;
  Panel::Range y_range;
  /// All parameters. Entries x and y are not used.
  std::vector<double> theta;
  /// Polygons in file order. Regions that the plane misses are left out.
  std::vector<SlicePolygon> polygons;
};

/// Cuts every region of the map. Throws Error naming the map, the parameter and the rule. A name must be known and
/// given once, and a value must be in the box.
Slice slice(const RegionMap& map, const SliceRequest& request);

/// "name [unit]".
std::string axisLabel(const Signal& signal);

/// The slice as a panel: filled by the value of the first input, lines between regions.
Panel slicePanel(const RegionMap& map, const Slice& cut);

/// The picture of a slice. Throws Error.
Figure sliceFigure(const RegionMap& map, const SliceRequest& request);

/// Draws a slice into `file` (.svg or .png). Throws Error.
void plotSlice(const RegionMap& map, const SliceRequest& request, const std::string& file);

}  // namespace polyfly
