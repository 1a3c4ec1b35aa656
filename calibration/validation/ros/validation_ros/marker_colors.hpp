#pragma once

#include <std_msgs/ColorRGBA.h>

namespace polyfly_ros {

inline std_msgs::ColorRGBA markerColor(float r, float g, float b) {
  std_msgs::ColorRGBA color;
  color.r = r;
  color.g = g;
  color.b = b;
  color.a = 1.0F;
  return color;
}

/// Inside a map.
inline const std_msgs::ColorRGBA kGreen = markerColor(0.0F, 0.62F, 0.45F);
/// Outside of it.
inline const std_msgs::ColorRGBA kRed = markerColor(0.84F, 0.0F, 0.0F);
inline const std_msgs::ColorRGBA kGrey = markerColor(0.6F, 0.64F, 0.68F);

}  // namespace polyfly_ros
