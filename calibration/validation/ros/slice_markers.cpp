#include "validation_ros/slice_markers.hpp"

#include <cmath>
#include <string>

#include "online_controller/laws/axis.hpp"
#include "validation/flight_slice.hpp"
#include "validation_ros/marker_colors.hpp"

namespace polyfly_ros {
namespace {

using visualization_msgs::Marker;

// Distance between the middles of two slices; a slice is 2 wide [m].
constexpr double kSpacing = 2.6;
constexpr double kRegionWidth = 0.004;
constexpr double kSampleWidth = 0.025;
constexpr double kTitleHeight = 0.1;
// What is drawn later lies above [m].
constexpr double kAbove = 0.01;

double scaled(double value, const polyfly::Panel::Range& range) {
  return 2.0 * (value - range.first) / (range.second - range.first) - 1.0;
}

// From the parameters of a slice to its square.
class Square {
 public:
  Square(const polyfly::Slice& cut, std::size_t axis)
      : cut_(cut), offset_(kSpacing * (static_cast<double>(axis) - 1.0)) {}

  geometry_msgs::Point at(double x, double y, double z) const {
    geometry_msgs::Point point;
    point.x = offset_ + scaled(x, cut_.x_range);
    point.y = scaled(y, cut_.y_range);
    point.z = z;
    return point;
  }

  bool holds(double x, double y) const {
    return std::abs(scaled(x, cut_.x_range)) <= 1.0 && std::abs(scaled(y, cut_.y_range)) <= 1.0;
  }

 private:
  const polyfly::Slice& cut_;
  double offset_;
};

Marker marker(const std::string& name, int type, double width) {
  Marker result;
  result.header.frame_id = "map_slices";
  result.ns = name;
  result.type = type;
  result.action = Marker::ADD;
  result.pose.orientation.w = 1.0;
  result.scale.x = width;
  result.color = kGrey;
  return result;
}

Marker outlines(const polyfly::Slice& cut, const Square& square, const std::string& name) {
  Marker lines = marker(name, Marker::LINE_LIST, kRegionWidth);
  for (const polyfly::SlicePolygon& polygon : cut.polygons) {
    for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
      for (const auto& [x, y] : {polygon.corners[i], polygon.corners[(i + 1) % polygon.corners.size()]})
        lines.points.push_back(square.at(x, y, 0.0));
    }
  }
  return lines;
}

Marker flown(const std::vector<polyfly::ReplaySample>& samples, const polyfly::Slice& cut,
             const Square& square, std::size_t axis) {
  Marker points =
      marker(std::string(polyfly::kAxisNames[axis].axis) + "/flown", Marker::POINTS, kSampleWidth);
  points.scale.y = kSampleWidth;
  for (const polyfly::ReplaySample& sample : samples) {
    const polyfly::AxisReport& report = sample.report.axis[axis];
    if (!sample.has_reference || report.size == 0) continue;
    const double x = report.theta[static_cast<std::size_t>(cut.x)];
    const double y = report.theta[static_cast<std::size_t>(cut.y)];
    if (!square.holds(x, y)) continue;
    points.points.push_back(square.at(x, y, kAbove));
    points.colors.push_back(report.lookup == polyfly::LookupStatus::kInside ? kGreen : kRed);
  }
  return points;
}

Marker title(const polyfly::RegionMap& map, const polyfly::Slice& cut, const Square& square,
             const std::string& name) {
  Marker text = marker(name, Marker::TEXT_VIEW_FACING, 0.0);
  const auto signal = [&](int index) {
    return polyfly::axisLabel(map.parameters()[static_cast<std::size_t>(index)]);
  };
  text.text = std::string(map.name()) + "\nright " + signal(cut.x) + ", up " + signal(cut.y);
  text.scale.z = kTitleHeight;
  text.pose.position = square.at(0.5 * (cut.x_range.first + cut.x_range.second), cut.y_range.second, 0.0);
  text.pose.position.y += 2.0 * kTitleHeight;
  return text;
}

}  // namespace

std::vector<Marker> sliceMarkers(const std::vector<polyfly::ReplaySample>& samples,
                                 const polyfly::RegionMap& map, std::size_t axis) {
  const polyfly::Slice cut = polyfly::slice(map, polyfly::flightSlice(samples, map, axis));
  const Square square(cut, axis);
  const std::string name = polyfly::kAxisNames[axis].axis;
  return {outlines(cut, square, name + "/regions"), flown(samples, cut, square, axis),
          title(map, cut, square, name + "/title")};
}

}  // namespace polyfly_ros
