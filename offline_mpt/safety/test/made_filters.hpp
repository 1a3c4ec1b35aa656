#pragma once

#include <sstream>
#include <string>

#include "mpc_core/safety_filter.hpp"

namespace polyfly {

/// Problems of tests.
struct MadeFilter {
  double period = 0.05;
  double delay = 0.0;
  double margin = 1e-8;
  double disturbance = 0.0;  ///< half of the range of w, acceleration
  double error = 0.0;        ///< of both measured states
  double input_error = 0.0;
  double strength = 2.0;  ///< half of the range of the input
  std::string A = "[[0, 1], [0, 0]]";
  std::string wish = "[-5, 5]";

  std::string text() const {
    std::ostringstream out;
    out.precision(17);
    out << "polyfly_problem: 1\nname: made\ntype: safety_filter\nsampling_time: " << period
        << "\ndelay: " << delay << "\nmargin: " << margin
        << "\nmodel:\n  states:\n    - {name: p, unit: m, range: [-1.5, 1.5], error: " << error
        << "}\n    - {name: v, unit: m/s, range: [-1.5, 1.5], error: " << error
        << "}\n  inputs:\n    - {name: a, unit: m/s^2, range: [" << -strength << ", " << strength
        << "], wish: " << wish << ", error: " << input_error << "}\n";
    if (disturbance > 0.0)
      out << "  disturbances:\n    - {name: w, unit: m/s^2, range: [" << -disturbance << ", " << disturbance
          << "]}\n  B_d: [[0], [1]]\n";
    out << "  A: " << A << "\n  B: [[0], [1]]\n";
    return out.str();
  }
  SafetyFilterProblem problem() const { return parseSafetyFilter(text(), "made.yaml"); }
};

}  // namespace polyfly
