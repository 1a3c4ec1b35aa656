#pragma once

#include <string>

namespace polyfly {

/// A fence along x, made by code.
struct MadeFence {
  double period = 0.1;  ///< [s]
  double delay = 0.0;   ///< [s]

  /// Solves it and writes its map. Ranges: 2 m, 1.5 m/s, 2 m/s^2 to both sides.
  void writeMap(const std::string& file) const;
};

}  // namespace polyfly
