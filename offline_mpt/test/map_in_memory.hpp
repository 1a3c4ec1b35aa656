#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>

#include "region_maps/aligned_bytes.hpp"
#include "region_maps/format.hpp"
#include "region_maps/map_content.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly {

/// A map laid out in memory, aligned as RegionMap::view asks.
class MapInMemory {
 public:
  explicit MapInMemory(const MapContent& content)
      : bytes_(layOut(content)), map_(RegionMap::view(bytes_.data(), bytes_.size(), content.name)) {}
  const RegionMap& map() const { return map_; }
  std::size_t size() const { return bytes_.size(); }
  std::string bytes() const { return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()}; }

 private:
  AlignedBytes bytes_;
  RegionMap map_;
};

/// Half the range of a parameter.
inline double halfRange(const MapContent& content, std::size_t parameter) {
  return 0.5 * (content.parameters[parameter].upper - content.parameters[parameter].lower);
}

/// Turns a plane by the angle, from the greatest of its other entries towards `entry`. Its length stays.
inline void turnPlane(MapContent& content, std::size_t plane, std::size_t entry, double angle) {
  const std::size_t p = content.parameters.size();
  double* const a = content.planes.data() + plane * (p + 1);
  std::size_t other = entry == 0 ? 1 : 0;
  for (std::size_t j = 0; j < p; ++j) {
    const bool greater =
        std::abs(a[j] * halfRange(content, j)) > std::abs(a[other] * halfRange(content, other));
    if (j != entry && greater) other = j;
  }
  const double x = a[entry] * halfRange(content, entry), y = a[other] * halfRange(content, other);
  a[entry] = (x * std::cos(angle) + y * std::sin(angle)) / halfRange(content, entry);
  a[other] = (y * std::cos(angle) - x * std::sin(angle)) / halfRange(content, other);
}

/// Moves a plane where `number` is its constant, and turns it where it is an entry.
inline void changePlane(MapContent& content, std::size_t number, double by) {
  const std::size_t width = content.parameters.size() + 1;
  if (number % width == width - 1) {
    content.planes[number] += by;
  } else {
    turnPlane(content, number / width, number % width, by);
  }
}

/// The map's bytes with the checksum that belongs to them: no writer of ours writes others.
inline std::string resealed(std::string bytes) {
  const std::uint64_t checksum = format::checksum(bytes.data(), bytes.size());
  std::memcpy(bytes.data() + offsetof(format::Header, checksum), &checksum, sizeof checksum);
  return bytes;
}

/// With other bytes from a place on.
inline std::string withBytes(std::string map, std::size_t at, const std::string& bytes) {
  return resealed(map.replace(at, bytes.size(), bytes));
}

/// With all planes multiplied.
inline std::string withScaledPlanes(std::string bytes, double factor) {
  const format::Header header = format::readHeader(bytes.data());
  const format::SectionEntry& planes = header.sections[format::kPlanes];
  for (std::size_t i = 0; i < planes.count * (header.parameters + 1); ++i) {
    double value = 0.0;
    char* const at = bytes.data() + planes.offset + i * sizeof value;
    std::memcpy(&value, at, sizeof value);
    value *= factor;
    std::memcpy(at, &value, sizeof value);
  }
  return resealed(bytes);
}

}  // namespace polyfly
