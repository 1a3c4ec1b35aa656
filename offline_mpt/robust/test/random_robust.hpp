#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

#include "../../test/random.hpp"

namespace polyfly {

/// A robust problem drawn by chance, as text: vehicle, bounds, disturbances, outputs, horizon, stack,
/// feedback, invariance, references, tie-break, sampling time. The same seed gives the same text.
class RandomRobust {
 public:
  RandomRobust(std::uint64_t seed, int longest_horizon) : random_(seed) { draw(longest_horizon); }

  const std::string& text() const { return text_; }

 private:
  struct State {
    const char* name;
    const char* unit;
    // Half width of the bound and of the error's box.
    double half;
    bool bounded;
  };

  std::string number(double low, double high) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.4g", random_.uniform(low, high));
    return digits;
  }
  bool chance(double share) { return random_.uniform(0.0, 1.0) < share; }
  static std::string range(double half) {
    char both[64];
    std::snprintf(both, sizeof both, "[%.4g, %.4g]", -half, half);
    return both;
  }

  // Not symmetric in half of the problems.
  std::string disturbance(double most) {
    const double half = random_.uniform(0.1 * most, most);
    if (chance(0.5)) return range(half);
    return "[" + number(-half, -0.2 * half) + ", " + number(0.2 * half, half) + "]";
  }

  void draw(int longest_horizon) {
    const int n = 2 + random_.below(3);
    const bool torque = chance(0.35);
    text_ = "polyfly_problem: 1\nname: drawn\ntype: robust_mpc\nmodel:\n  states:\n";
    State states[] = {{"p", "m", random_.uniform(0.5, 3.0), chance(0.2)},
                      {"v", "m/s", random_.uniform(0.8, 3.0), chance(0.85)},
                      {"phi", "rad", random_.uniform(0.2, 0.6), chance(0.85)},
                      {"rate", "rad/s", random_.uniform(2.0, 6.0), chance(0.3)}};
    for (int i = 0; i < n; ++i) {
      text_ += std::string("    - {name: ") + states[i].name + ", unit: " + states[i].unit;
      if (states[i].bounded) text_ += ", range: " + range(states[i].half);
      text_ += "}\n";
    }
    const double input = n == 2 ? random_.uniform(2.0, 6.0) : random_.uniform(0.2, 0.6);
    text_ += "  inputs:\n    - {name: u, unit: rad, range: " + range(input) + "}\n  disturbances:\n";
    text_ += "    - {name: w, unit: m/s^2, range: " + disturbance(0.8) + "}\n";
    if (torque) text_ += "    - {name: t, unit: rad/s, range: " + disturbance(0.3) + "}\n";
    matrices(n, torque);
    outputs(n);
    static const char* const kPeriods[] = {"0.05", "0.08", "0.1", "0.16"};
    text_ += std::string("sampling_time: ") + kPeriods[random_.below(4)] +
             "\nhorizon: " + std::to_string(2 + random_.below(longest_horizon - 1)) +
             "\nstack: " + (chance(0.6) ? "paper" : "shift");
    static const char* const kFeedback[] = {"free", "free", "free", "zero", "fixed"};
    text_ += std::string("\nfeedback_predictions: ") + kFeedback[random_.below(5)];
    // the exact invariant set of four states takes minutes in some of these problems
    const bool closed = n < 4 && states[1].bounded && (n < 3 || states[2].bounded);
    text_ += std::string("\ninvariance: ") + (closed && chance(0.3) ? "first_step" : "none");
    if (chance(0.4)) text_ += "\nfloor: " + number(0.0, 0.08);
    text_ += "\npeak_in_map: true\ntie_break: {Q: [";
    for (int i = 0; i < n; ++i) text_ += (i > 0 ? ", " : "") + number(1.0, 60.0);
    text_ += "], R: [" + number(5.0, 60.0) + "]}\nparameters:\n";
    for (int i = 0; i < n; ++i)
      text_ += std::string("  - {name: e_") + states[i].name + ", role: error, of: " + states[i].name +
               ", unit: " + states[i].unit + ", range: " + range(states[i].half) + "}\n";
    if (n < 4 && chance(0.25)) {
      text_ += "  - {name: v_ref, role: reference, unit: m/s, range: " + range(random_.uniform(0.1, 0.6)) +
               ", state: [0, 1" + (n == 3 ? ", 0" : "") + "], input: [0]}\n";
    }
  }

  void matrices(int n, bool torque) {
    const std::string second = torque ? ", 0]" : "]", last = torque ? ", 1]" : "]";
    const std::string drag = number(-0.4, 0.0), gravity = chance(0.5) ? "9.81" : "-9.81";
    if (n == 2) {
      text_ += "  A: [[0, 1], [0, " + drag + "]]\n  B: [[0], [1]]\n  G: [[0" + second + ", [1" + last + "]\n";
    } else if (n == 3) {
      const double tau = random_.uniform(0.08, 0.5), gain = random_.uniform(0.6, 1.2);
      char loop[96];
      std::snprintf(loop, sizeof loop, "%.5g]]\n  B: [[0], [0], [%.5g]]\n", -1.0 / tau, gain / tau);
      text_ += "  A: [[0, 1, 0], [0, " + drag + ", " + gravity + "], [0, 0, " + loop;
      text_ += "  G: [[0" + second + ", [1" + second + ", [0" + last + "]\n";
    } else {
      const double wn = random_.uniform(6.0, 15.0), zeta = random_.uniform(0.5, 1.2);
      char loop[160];
      std::snprintf(loop, sizeof loop, "%.5g, %.5g]]\n  B: [[0], [0], [0], [%.5g]]\n", -wn * wn,
                    -2.0 * zeta * wn, random_.uniform(0.6, 1.2) * wn * wn);
      text_ += "  A: [[0, 1, 0, 0], [0, " + drag + ", " + gravity + ", 0], [0, 0, 0, 1], [0, 0, " + loop;
      text_ += "  G: [[0" + second + ", [1" + second + ", [0" + second + ", [0" + last + "]\n";
    }
  }

  // One to three rows, the position in the first.
  void outputs(int n) {
    const int rows = chance(0.5) ? 1 : 2 + random_.below(2);
    text_ += "  C: [";
    for (int i = 0; i < rows; ++i) {
      text_ += i > 0 ? ", [" : "[";
      for (int j = 0; j < n; ++j) {
        const bool there = (i == 0 && j == 0) || chance(i == 0 ? 0.25 : 0.5);
        text_ += (j > 0 ? ", " : "") + (there ? (i + j == 0 ? "1" : number(-0.8, 0.8)) : std::string("0"));
      }
      text_ += "]";
    }
    text_ += "]\n";
  }

  Random random_;
  std::string text_;
};

}  // namespace polyfly
