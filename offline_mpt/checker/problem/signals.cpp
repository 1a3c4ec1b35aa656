#include "problem/signals.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "problem/fields.hpp"

namespace checker {
namespace {

constexpr double kSameBound = 1e-12;  // relative: a range in doubles, or rounded from a quotient

struct Signal {
  std::string name, unit;
  double lower = -HUGE_VAL, upper = HUGE_VAL;
};

/// A number, or a quotient of two.
double quotientOf(const YAML::Node& node) {
  const auto text = node.as<std::string>();
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) return numberOf(text);
  return numberOf(text.substr(0, slash)) / numberOf(text.substr(slash + 1));
}

Signal signalOf(const YAML::Node& node) {
  Signal signal{node["name"].as<std::string>(), node["unit"].as<std::string>()};
  if (!node["range"]) return signal;
  signal.lower = quotientOf(node["range"][0]);
  signal.upper = quotientOf(node["range"][1]);
  return signal;
}

/// Of a file of type tracking_mpc or robust_mpc; a parameter with a value is no entry of theta.
std::vector<Signal> signalsOfModel(const YAML::Node& root) {
  std::vector<Signal> signals;
  for (const auto& parameter : root["parameters"]) {
    if (!parameter["value"]) signals.push_back(signalOf(parameter));
  }
  for (const auto& input : root["model"]["inputs"]) signals.push_back(signalOf(input));
  if (root["peak_in_map"] && root["peak_in_map"].as<bool>())
    signals.push_back({"tau", "1", root["floor"] ? quotientOf(root["floor"]) : 0.0, HUGE_VAL});
  return signals;
}

/// Of a file of type safety_filter: states, inputs before where there is a delay, wishes; then the inputs.
std::vector<Signal> signalsOfFilter(const YAML::Node& root) {
  std::vector<Signal> signals, inputs, wishes;
  for (const auto& state : root["model"]["states"]) signals.push_back(signalOf(state));
  for (const auto& input : root["model"]["inputs"]) {
    inputs.push_back(signalOf(input));
    wishes.push_back(inputs.back());
    wishes.back().name += "_wish";
    if (!input["wish"]) continue;
    wishes.back().lower = quotientOf(input["wish"][0]);
    wishes.back().upper = quotientOf(input["wish"][1]);
  }
  if (root["delay"] && numberOf(root["delay"]) > 0.0) {
    for (Signal before : inputs) {
      before.name += "_before";
      signals.push_back(std::move(before));
    }
  }
  signals.insert(signals.end(), wishes.begin(), wishes.end());
  signals.insert(signals.end(), inputs.begin(), inputs.end());
  return signals;
}

/// Of a program in JSON. What it does not name is theta_0, theta_1, .. and u_0, u_1, .. without unit.
std::vector<Signal> signalsOfProgram(const YAML::Node& root, std::size_t p, std::size_t q) {
  std::vector<Signal> signals;
  const auto add = [&](const char* key, const char* letter, std::size_t count) {
    const YAML::Node named = root[key];
    require(!named || named.size() == count, std::string(key) + ": not as many as the map has");
    for (std::size_t j = 0; j < count; ++j) {
      signals.push_back({letter + std::to_string(j), "1"});
      if (!named) continue;
      signals.back().name = named[j]["name"].as<std::string>();
      signals.back().unit = named[j]["unit"].as<std::string>();
      const YAML::Node lower = named[j]["lower"], upper = named[j]["upper"];
      if (lower && !lower.IsNull()) signals.back().lower = numberOf(lower);
      if (upper && !upper.IsNull()) signals.back().upper = numberOf(upper);
    }
  };
  add("parameters", "theta_", p);
  for (std::size_t j = 0; j < p; ++j) {
    signals[j].lower = numberOf(root["lb"][j]);
    signals[j].upper = numberOf(root["ub"][j]);
  }
  add("inputs", "u_", q);
  return signals;
}

bool isSame(double in_map, double in_problem) {
  if (!std::isfinite(in_problem)) return in_map == in_problem;
  return std::abs(in_map - in_problem) <= kSameBound * std::abs(in_problem);
}

void match(const Map& map, const YAML::Node& root) {
  // Name, problem, kind, status and notes come before the names and units of signals.
  constexpr std::size_t kFirst = 5;
  const bool is_program = static_cast<bool>(root["H"]);
  require(map.kind() == (is_program ? "json" : "yaml"), "the map's kind of problem is another one");
  const bool is_filter = !is_program && root["type"].as<std::string>() == "safety_filter";
  const std::vector<Signal> signals = is_program  ? signalsOfProgram(root, map.p, map.q)
                                      : is_filter ? signalsOfFilter(root)
                                                  : signalsOfModel(root);
  require(signals.size() == std::size_t{map.p} + map.q, "the map has another number of signals");
  for (std::size_t k = 0; k < signals.size(); ++k) {
    const Signal& signal = signals[k];
    require(map.words[kFirst + 2 * k] == signal.name,
            "the map has the signal " + map.words[kFirst + 2 * k] + " in the place of " + signal.name);
    require(map.words[kFirst + 2 * k + 1] == signal.unit, signal.name + ": its unit is another one");
    require(isSame(map.bounds[2 * k], signal.lower) && isSame(map.bounds[2 * k + 1], signal.upper),
            signal.name + ": its range is not that of the problem");
  }
  const YAML::Node period = root[is_program ? "period" : "sampling_time"];
  require(map.period == (period ? numberOf(period) : 0.0), "the map's period is not that of the problem");
}

}  // namespace

std::string problemType(const std::string& problem) {
  return withDocument(problem, [](const YAML::Node& root) {
    return root.IsMap() && root["type"] ? root["type"].as<std::string>() : "";
  });
}

void matchSignals(const Map& map, const std::string& problem) {
  withDocument(problem, [&](const YAML::Node& root) { match(map, root); });
}

}  // namespace checker
