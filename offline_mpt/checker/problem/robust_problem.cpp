#include "problem/robust_problem.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdlib>

#include "core/text.hpp"
#include "problem/fields.hpp"

namespace checker {
namespace {

constexpr std::size_t kMostStages = 40;
constexpr unsigned kMostBits = 200;
constexpr long kMostDigits = 400;

mpz_class wholeOf(const std::string& digits) {
  mpz_class value;
  require(!digits.empty() && digits.find_first_not_of("0123456789") == std::string::npos &&
              value.set_str(digits, 10) == 0,
          "problem: " + digits + " is no number");
  return value;
}

mpz_class powerOfTen(long exponent) {
  mpz_class power;
  mpz_ui_pow_ui(power.get_mpz_t(), 10, static_cast<unsigned long>(exponent));
  return power;
}

/// A decimal number without sign: digits, perhaps a point, perhaps an exponent.
Fraction decimalOf(const std::string& text) {
  const bool leads = text.size() > 1 && text[0] == '0' && text[1] >= '0' && text[1] <= '9';
  require(!leads, "problem: " + text + " is no number in decimal digits without leading zeros");
  const std::size_t e = text.find_first_of("eE");
  std::string digits = text.substr(0, e);
  long exponent = 0;
  if (e != std::string::npos) {
    const bool has_sign = e + 1 < text.size() && (text[e + 1] == '-' || text[e + 1] == '+');
    const mpz_class stated = wholeOf(text.substr(e + (has_sign ? 2 : 1)));
    require(stated <= kMostDigits, "problem: " + text + " is out of range");
    exponent = stated.get_si();
    if (has_sign && text[e + 1] == '-') exponent = -exponent;
  }
  const std::size_t point = digits.find('.');
  if (point != std::string::npos) {
    exponent -= static_cast<long>(digits.size() - point - 1);
    digits.erase(point, 1);
  }
  require(std::abs(exponent) <= kMostDigits, "problem: " + text + " is out of range");
  Fraction value(wholeOf(digits));
  if (exponent >= 0) return value * Fraction(powerOfTen(exponent));
  value /= Fraction(powerOfTen(-exponent));
  return value;
}

/// A number as written, or a quotient of two.
Fraction exactOf(const YAML::Node& node) {
  std::string text = node.as<std::string>();
  const bool is_negative = !text.empty() && text[0] == '-';
  if (is_negative || (!text.empty() && text[0] == '+')) text.erase(0, 1);
  const std::size_t slash = text.find('/');
  Fraction value = decimalOf(text.substr(0, slash));
  if (slash != std::string::npos) {
    const Fraction divisor = decimalOf(text.substr(slash + 1));
    require(divisor != 0, "problem: a division by 0");
    value /= divisor;
  }
  return is_negative ? Fraction(-value) : value;
}

Matrix zeros(std::size_t rows, std::size_t columns) { return {rows, columns, Vector(rows * columns)}; }

RobustProblem::Range exactRange(const YAML::Node& node) {
  require(node.IsSequence() && node.size() == 2, "problem: a range has two numbers");
  RobustProblem::Range range(exactOf(node[0]), exactOf(node[1]));
  require(range.first < range.second, "problem: a range is empty");
  return range;
}

class RobustReader {
 public:
  explicit RobustReader(const YAML::Node& root) : root_(root) {}

  RobustProblem read() {
    requireHead(root_, "robust_mpc",
                {"polyfly_problem", "name", "type", "description", "provenance", "model", "sampling_time",
                 "horizon", "stack", "feedback_predictions", "feedback_gain", "tie_break", "floor",
                 "invariance", "peak_in_map", "parameters"});
    problem_.sampling_time = Fraction(numberOf(root_["sampling_time"]));
    problem_.horizon = countOf(root_["horizon"]);
    require(problem_.sampling_time > 0 && problem_.horizon >= 2 && problem_.horizon <= kMostStages,
            "problem: sampling_time or horizon is out of range");
    readSignals(root_["model"]);
    readModel(root_["model"]);
    readChoices();
    readGains();
    readParameters(root_["parameters"]);
    return problem_;
  }

 private:
  void readSignals(const YAML::Node& model) {
    requireKeys(model, {"time", "bits", "states", "inputs", "disturbances", "A", "B", "G", "C", "delay"});
    for (const auto& state : model["states"]) {
      requireKeys(state, {"name", "unit", "range"});
      if (state["range"]) problem_.state_ranges[states_.size()] = exactRange(state["range"]);
      states_.push_back(state["name"].as<std::string>());
    }
    require(!states_.empty() && model["inputs"].size() == 1, "problem: one input is needed, and a state");
    requireKeys(model["inputs"][0], {"name", "unit", "range"});
    problem_.input_range = exactRange(model["inputs"][0]["range"]);
    for (const auto& disturbance : model["disturbances"]) {
      requireKeys(disturbance, {"name", "unit", "range"});
      problem_.disturbances.push_back(exactRange(disturbance["range"]));
    }
    require(!model["delay"] || numberOf(model["delay"]) >= 0.0, "problem: delay is negative");
  }

  void readModel(const YAML::Node& model) {
    const std::size_t nx = states_.size();
    problem_.is_discrete = choiceOf(model["time"], {"continuous", "discrete"}) == 1;
    if (model["bits"]) problem_.bits = static_cast<unsigned>(countOf(model["bits"]));
    require(problem_.bits >= 8 && problem_.bits <= kMostBits, "problem: bits is out of range");
    problem_.A = matrixOf(model["A"], nx, nx, exactOf);
    problem_.B = matrixOf(model["B"], nx, 1, exactOf);
    problem_.G = matrixOf(model["G"], nx, problem_.disturbances.size(), exactOf);
    problem_.C = matrixOf(model["C"], model["C"].size(), nx, exactOf);
  }

  void readChoices() {
    problem_.is_shifted = choiceOf(root_["stack"], {"paper", "shift"}) == 1;
    problem_.feedback = static_cast<RobustProblem::Feedback>(
        choiceOf(root_["feedback_predictions"], {"free", "zero", "fixed"}));
    problem_.invariance = static_cast<RobustProblem::Invariance>(
        choiceOf(root_["invariance"], {"none", "first_step", "terminal"}));
    problem_.has_peak = choiceOf(root_["peak_in_map"], {"false", "true"}) == 1;
    if (root_["floor"]) problem_.floor = exactOf(root_["floor"]);
  }

  void readGains() {
    problem_.tie_gain = gainOf(root_["tie_break"]);
    const bool is_fixed = problem_.feedback == RobustProblem::Feedback::kFixed;
    require(is_fixed || !root_["feedback_gain"],
            "problem: feedback_gain goes with feedback_predictions: fixed");
    problem_.feedback_gain = root_["feedback_gain"] ? gainOf(root_["feedback_gain"]) : problem_.tie_gain;
  }

  RobustProblem::Gain gainOf(const YAML::Node& node) const {
    requireKeys(node, {"gain", "Q", "R"});
    RobustProblem::Gain result;
    if (node["gain"]) {
      require(node.size() == 1, "problem: a gain has weights too");
      result.value = matrixOf(node["gain"], 1, states_.size(), exactOf);
    } else {
      result.Q = weightOf(node["Q"], states_.size(), exactOf);
      result.R = weightOf(node["R"], 1, exactOf);
    }
    return result;
  }

  void readParameters(const YAML::Node& parameters) {
    const std::size_t p = parameters.size(), nx = states_.size();
    problem_.ranges = zeros(p, 2);
    problem_.state_shift = zeros(p, nx);
    problem_.input_shift = zeros(p, 1);
    problem_.errors.assign(nx, p);
    for (std::size_t j = 0; j < p; ++j) {
      const YAML::Node parameter = parameters[j];
      requireKeys(parameter, {"name", "role", "of", "unit", "range", "state", "input"});
      const RobustProblem::Range range = exactRange(parameter["range"]);
      problem_.ranges.entries[2 * j] = range.first;
      problem_.ranges.entries[2 * j + 1] = range.second;
      if (choiceOf(parameter["role"], {"error", "reference"}) == 0) {
        const auto state = std::find(states_.begin(), states_.end(), parameter["of"].as<std::string>());
        require(state != states_.end(), "problem: a parameter names no state");
        std::size_t& error = problem_.errors[static_cast<std::size_t>(state - states_.begin())];
        require(error == p, "problem: two parameters are the error of one state");
        error = j;
        continue;
      }
      require(parameter["state"].size() == nx && parameter["input"].size() == 1,
              "problem: a reference has another size");
      for (std::size_t i = 0; i < nx; ++i)
        problem_.state_shift.entries[j * nx + i] = exactOf(parameter["state"][i]);
      problem_.input_shift.entries[j] = exactOf(parameter["input"][0]);
    }
    require(std::count(problem_.errors.begin(), problem_.errors.end(), p) == 0,
            "problem: a state has no error among the parameters");
  }

  const YAML::Node root_;
  std::vector<std::string> states_;
  RobustProblem problem_;
};

}  // namespace

RobustProblem readRobustProblem(const std::string& text) {
  return withDocument(text, [](const YAML::Node& root) { return RobustReader(root).read(); });
}

}  // namespace checker
