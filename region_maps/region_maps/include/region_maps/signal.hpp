#pragma once

#include <string>

namespace polyfly {

/// One named entry of a parameter or input vector.
struct Signal {
  std::string name;
  std::string unit;    ///< SI or rad, as text: "m", "m/s", "rad", "m/s^2"
  double lower = 0.0;  ///< least admissible value [unit]
  double upper = 0.0;  ///< greatest admissible value [unit]
};

}  // namespace polyfly
