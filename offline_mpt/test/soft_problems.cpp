#include "soft_problems.hpp"

#include <algorithm>
#include <sstream>

#include "random.hpp"

namespace polyfly {
namespace {

class ProblemText {
 public:
  ProblemText(const ProblemTraits& traits, unsigned seed) : traits_(traits), random_(seed) {}

  std::string write() {
    text_.precision(4);
    horizon_ = 3 + random_.below(3);
    third_order_ = random_.below(3) == 0;
    changes_cost_ = traits_.limits_changes || random_.below(3) == 0;
    text_ << "polyfly_problem: 1\nname: made\ntype: tracking_mpc\n";
    writeModel();
    writeHorizon();
    writeWeights();
    if (traits_.is_soft) {
      const double weights[] = {5.0, 30.0, 400.0};
      text_ << "constraints:\n  - {of: v, range: [" << -random_.uniform(0.5, 2.0) << ", "
            << random_.uniform(0.5, 2.0) << "], soft: {linear: " << weights[random_.below(3)]
            << ", quadratic: " << random_.uniform(0.1, 40.0) << ", slack: horizon}}\n";
    }
    writeParameters();
    return text_.str();
  }

 private:
  void writeModel() {
    text_ << "model:\n  states:\n    - {name: p, unit: m}\n    - {name: v, unit: m/s}\n";
    if (third_order_) text_ << "    - {name: a, unit: m/s^2}\n";
    text_ << "  inputs:\n    - {name: u, unit: m/s^2, range: [" << -random_.uniform(0.5, 1.5) << ", "
          << random_.uniform(0.5, 1.5) << "]";
    if (traits_.limits_changes)
      text_ << ", change: [" << -random_.uniform(0.2, 0.6) << ", " << random_.uniform(0.2, 0.6) << "]";
    text_ << "}\n";
    const double drag = random_.uniform(0.0, 0.5), gain = random_.uniform(0.7, 2.0);
    if (third_order_) {
      const double lag = random_.uniform(2.0, 6.0);
      text_ << "  A: [[0, 1, 0], [0, " << -drag << ", " << gain << "], [0, 0, " << -lag << "]]\n"
            << "  B: [[0], [0], [" << lag << "]]\n  C: [[1, 0, 0]]\n";
    } else {
      text_ << "  A: [[0, 1], [0, " << -drag << "]]\n  B: [[0], [" << gain << "]]\n  C: [[1, 0]]\n";
    }
  }

  void writeHorizon() {
    const double periods[] = {0.1, 0.2, 0.5};
    text_ << "sampling_time: " << periods[random_.below(3)] << "\n";
    if (traits_.is_blocked) horizon_ *= 2;
    text_ << "horizon: " << horizon_ << "\n";
    if (!traits_.is_blocked) return;
    const int first = 1 + random_.below(2), second = 1 + random_.below(horizon_ - first - 1);
    text_ << "moves: [" << first << ", " << second << ", " << horizon_ - first - second << "]\n";
  }

  void writeWeights() {
    text_ << "weights:\n  Q: [" << random_.uniform(0.1, 40.0) << ", " << random_.uniform(0.1, 40.0);
    if (third_order_) text_ << ", " << random_.uniform(0.1, 40.0);
    text_ << "]\n  R: [" << random_.uniform(0.1, 10.0) << "]\n";
    if (changes_cost_) text_ << "  R_delta: [" << random_.uniform(0.1, 2.0) << "]\n";
  }

  void writeParameters() {
    text_ << "parameters:\n  - {name: e_p, role: error, of: p, unit: m, range: [-3, 3]}\n"
          << "  - {name: e_v, role: error, of: v, unit: m/s, range: [-2, 2]}\n";
    if (third_order_) text_ << "  - {name: e_a, role: error, of: a, unit: m/s^2, range: [-1, 1]}\n";
    if (changes_cost_)
      text_ << "  - {name: u_prev, role: previous_input, of: u, unit: m/s^2, range: [-0.5, 0.5]}\n";
  }

  ProblemTraits traits_;
  Random random_;
  std::ostringstream text_;
  int horizon_ = 0;
  bool third_order_ = false;
  bool changes_cost_ = false;
};

}  // namespace

std::string madeProblem(const ProblemTraits& traits, unsigned seed) {
  return ProblemText(traits, seed).write();
}

std::string cartProblem(const std::string& constraints, const CartTraits& traits) {
  std::ostringstream text;
  text << R"(polyfly_problem: 1
name: cart
type: tracking_mpc
model:
  time: discrete
  states:
    - {name: p, unit: m}
    - {name: v, unit: m/s}
  inputs:
    - {name: a, unit: m/s^2, range: [-1, 1.5]}
)";
  if (traits.is_disturbed) {
    text << R"(  disturbances: [{name: w, unit: m/s^2, range: [-0.2, 0.3]}]
  B_d: [[0.125], [0.5]]
)";
  }
  text << R"(  A: [[1, 0.5], [0, 1]]
  B: [[0.125], [0.5]]
  C: [[1, 0]]
sampling_time: 0.5
weights:
  Q: [4, 1]
  R: [[0.5]]
constraints:
)" << constraints
       << "horizon: " << traits.horizon << R"(
parameters:
  - {name: e_p, role: error, of: p, unit: m, range: [-10, 10]}
  - {name: e_v, role: error, of: v, unit: m/s, range: [-4, 4]}
)";
  return text.str();
}

std::string softSpeed(double linear, const std::string& slack) {
  return "  - {of: v, range: [-2, 2.5], soft: {linear: " + std::to_string(linear) +
         ", quadratic: 1, slack: " + slack + "}}\n";
}

}  // namespace polyfly
