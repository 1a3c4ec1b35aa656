#pragma once

#include <Eigen/Core>
#include <string>

#include "robust_mpc/robust_problem.hpp"

namespace polyfly {

/// A lateral axis, p' = v, v' = g phi - 0.01 v + w, phi' = (0.9 u - phi) / 0.2 (or second order), as text.
struct MadeRobust {
  int states = 3;  ///< 2: the vertical axis p' = v, v' = u + w; 3; 4: phi'' = 144 (0.9 u - phi) - 19.2 phi'
  int horizon = 6;
  std::string stack = "paper";
  std::string feedback = "free";
  std::string invariance = "none";
  std::string outputs;  ///< rows of C; empty: the position
  std::string floor = "0";
  std::string disturbance = "[-0.5, 0.5]";  ///< [m/s^2]
  std::string input = "[-0.35, 0.35]";
  bool bounded_position = false;
  bool torque = false;      ///< a second channel, on the last state
  bool references = false;  ///< v_ref and, with three states, phi_ref
  bool peak_in_map = false;

  std::string text() const {
    static const char* const kNames[] = {"p", "v", "phi", "rate"};
    static const char* const kUnits[] = {"m", "m/s", "rad", "rad/s"};
    static const char* const kBox[] = {"[-1.5, 1.5]", "[-1.5, 1.5]", "[-0.35, 0.35]", "[-3, 3]"};
    const auto entries = [&](int one) {  // a row of zeros but for one entry
      std::string row = "[";
      for (int j = 0; j < states; ++j) row += std::string(j > 0 ? ", " : "") + (j == one ? "1" : "0");
      return row + "]";
    };
    std::string file = "polyfly_problem: 1\nname: made\ntype: robust_mpc\nmodel:\n  states:\n";
    for (int i = 0; i < states; ++i) {
      file += std::string("    - {name: ") + kNames[i] + ", unit: " + kUnits[i];
      if (i == 1 || i == 2 || (i == 0 && bounded_position)) file += std::string(", range: ") + kBox[i];
      file += "}\n";
    }
    file += "  inputs:\n    - {name: u, unit: rad, range: " + input + "}\n  disturbances:\n";
    file += "    - {name: w, unit: m/s^2, range: " + disturbance + "}\n";
    if (torque) file += "    - {name: t, unit: rad/s, range: [-0.1, 0.2]}\n";
    file += matrices();
    file += "  C: " + (outputs.empty() ? "[" + entries(0) + "]" : outputs) + "\n";
    file += "sampling_time: 0.08\nhorizon: " + std::to_string(horizon) + "\nstack: " + stack +
            "\nfeedback_predictions: " + feedback + "\ninvariance: " + invariance + "\nfloor: " + floor +
            "\npeak_in_map: " + (peak_in_map ? "true" : "false") + "\ntie_break: {Q: [40, 20";
    for (int i = 2; i < states; ++i) file += i == 2 ? ", 10" : ", 1";
    file += "], R: [35]}\nparameters:\n";
    for (int i = 0; i < states; ++i)
      file += std::string("  - {name: e_") + kNames[i] + ", role: error, of: " + kNames[i] +
              ", unit: " + kUnits[i] + ", range: " + kBox[i] + "}\n";
    if (references) {
      file += "  - {name: v_ref, role: reference, unit: m/s, range: [-0.8, 0.8], state: " + entries(1) +
              ", input: [0]}\n";
      if (states == 3)
        file +=
            "  - {name: phi_ref, role: reference, unit: rad, range: [-0.15, 0.15], state: [0, 0, 1], "
            "input: [\"10/9\"]}\n";
    }
    return file;
  }

  RobustProblem problem() const { return parseRobustProblem(text(), "made.yaml"); }

 private:
  std::string matrices() const {
    const std::string t2 = torque ? ", 0]" : "]", t1 = torque ? ", 1]" : "]";
    switch (states) {
      case 2:
        return "  A: [[0, 1], [0, -0.01]]\n  B: [[0], [1]]\n  G: [[0" + t2 + ", [1" + t1 + "]\n";
      case 3:
        return "  A: [[0, 1, 0], [0, -0.01, 9.81], [0, 0, -5]]\n  B: [[0], [0], [4.5]]\n  G: [[0" + t2 +
               ", [1" + t2 + ", [0" + t1 + "]\n";
      default:
        return "  A: [[0, 1, 0, 0], [0, -0.01, 9.81, 0], [0, 0, 0, 1], [0, 0, -144, -19.2]]\n"
               "  B: [[0], [0], [0], [129.6]]\n  G: [[0" +
               t2 + ", [1" + t2 + ", [0" + t2 + ", [0" + t1 + "]\n";
    }
  }
};

/// Solved in a moment, its peak in the map.
inline MadeRobust smallRobust() {
  MadeRobust made;
  made.horizon = 4;
  made.peak_in_map = true;
  return made;
}

}  // namespace polyfly
