#pragma once

namespace polyfly {

/// Admissible values of an option, ends included.
struct Range {
  double least = 0.0;
  double greatest = 0.0;
};

}  // namespace polyfly
