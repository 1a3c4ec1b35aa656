#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "mpc_core/parametric_program.hpp"
#include "region_maps/map_image.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly::python {

/// A region map as Python holds it: read from a file, or an image in memory. Stays where it was made, since
/// arrays of Python point into it.
class LoadedMap {
 public:
  /// Reads the file. Throws Error.
  explicit LoadedMap(const std::string& path);
  /// `name` is used in errors.
  LoadedMap(MapImage image, const std::string& name);
  LoadedMap(const LoadedMap&) = delete;
  LoadedMap& operator=(const LoadedMap&) = delete;

  const RegionMap& map() const noexcept { return map_; }
  std::size_t parameterCount() const noexcept { return map_.parameters().size(); }
  std::size_t inputCount() const noexcept { return map_.inputs().size(); }

  /// The file that was read, as an input of checkOutputs. Empty: an image in memory.
  std::string file() const { return image_ ? "" : map_.path(); }

  /// Writes the map's bytes with writeFileAtomically. Throws Error.
  void save(const std::string& path) const;

  /// Inputs at theta. Throws OutsideError where there is none.
  void evaluate(const double* theta, double* u) const;
  /// Look-up of the region that holds theta. Throws OutsideError where none does.
  Lookup locate(const double* theta) const;

  /// Inputs at `count` parameters, one after the other; NaN where the map has no answer.
  void evaluateMany(const double* thetas, std::size_t count, int threads, double* u) const;
  /// Their regions; -1 where none holds a parameter.
  void locateMany(const double* thetas, std::size_t count, int threads, std::int64_t* regions) const;

  /// The program out of the problem text in the map. Throws Error, also for a robust problem, which is none.
  ParametricProgram program() const;
  /// Whether the map is that of a problem of type robust_mpc.
  bool isRobust() const;
  /// Where errors say that a problem text comes from.
  std::string textSource() const { return map_.path() + ": problem text"; }

 private:
  [[noreturn]] void failOutside(const double* theta, LookupStatus status) const;

  std::optional<MapImage> image_;
  RegionMap map_;
};

}  // namespace polyfly::python
