#pragma once

namespace polyfly {

/// Greatest and root-mean-square difference of two series.
struct Difference {
  double max = 0.0;
  double rms = 0.0;
  /// Time of the greatest difference [s].
  double stamp = 0.0;
};

}  // namespace polyfly
