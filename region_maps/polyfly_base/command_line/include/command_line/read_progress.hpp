#pragma once

#include <iostream>

namespace polyfly {

/// The share of a log that was read, on one line of a terminal, which it leaves empty at the end.
inline void showReadProgress(double share) {
  constexpr double kStep = 0.01;
  static double shown = 0.0;
  if (share < shown + kStep && share < 1.0) return;
  shown = share;
  std::cerr << "\rreading " << static_cast<int>(100.0 * share) << " %"
            << (share < 1.0 ? "" : "\r            \r") << std::flush;
}

}  // namespace polyfly
