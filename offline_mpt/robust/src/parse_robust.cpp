#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "cited_ranges.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/problem_type.hpp"
#include "mpc_core/read_problem.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/yaml_field.hpp"
#include "polytope_sets/exact_fields.hpp"
#include "rational_parts.hpp"
#include "robust_mpc/robust_problem.hpp"

namespace polyfly {
namespace {

constexpr int kMaxHorizon = 40;
constexpr int kDefaultBits = 40;  // after the binary point: errors of 1e-12, fractions that stay short
constexpr int kMaxBits = 200;

using Names = std::set<std::string>;

RobustProblem::Range rangeOf(const YamlField& field) {
  const RationalVector ends = vectorOf(field, 2);
  if (ends[0] >= ends[1]) field.fail("lower end must be below the upper end");
  return {ends[0], ends[1]};
}

void setBounds(Signal& signal, const RobustProblem::Range& range) {
  signal.lower = nearestDouble(range.lower);
  signal.upper = nearestDouble(range.upper);
}

void readSignals(const YamlField& model, RobustProblem& problem,
                 std::vector<RobustProblem::Range>& disturbance_ranges) {
  Names taken;
  for (const YamlField& field : model.at("states").items()) {
    field.checkKeys({"name", "unit"}, {"range"});
    problem.states.push_back(signalOf(field, taken));
    problem.state_ranges.emplace_back();
    if (field.has("range")) problem.state_ranges.back() = rangeOf(field.at("range"));
  }
  if (problem.states.empty()) model.at("states").fail("must have at least one entry");
  for (const YamlField& field : model.at("inputs").items()) {
    field.checkKeys({"name", "unit", "range"}, {});
    problem.inputs.push_back(signalOf(field, taken));
    problem.input_ranges.push_back(rangeOf(field.at("range")));
    setBounds(problem.inputs.back(), problem.input_ranges.back());
  }
  if (problem.inputs.size() != 1) model.at("inputs").fail("must have exactly one entry");
  for (const YamlField& field : model.at("disturbances").items()) {
    field.checkKeys({"name", "unit", "range"}, {});
    problem.disturbances.push_back(signalOf(field, taken));
    disturbance_ranges.push_back(rangeOf(field.at("range")));
    setBounds(problem.disturbances.back(), disturbance_ranges.back());
  }
  if (problem.disturbances.empty()) model.at("disturbances").fail("must have at least one entry");
}

/// To a multiple of 2^-bits.
RationalMatrix roundedMatrix(const Eigen::MatrixXd& matrix, int bits) {
  const Rational step(Integer(1), Integer(1) << static_cast<unsigned>(bits));
  return matrix.unaryExpr([&](double value) { return nearestMultiple(Rational(value), step); });
}

void discretiseExactly(const YamlField& model, RobustProblem& problem, int bits) {
  MpcProblem continuous;
  continuous.A_c = toDoubles(problem.A);
  continuous.B_c = toDoubles(problem.B);
  continuous.Bd_c = toDoubles(problem.G);
  DiscreteModel discrete;
  try {
    discrete = discretise(continuous, problem.sampling_time);
  } catch (const Error&) {
    model.at("A").fail("must not overflow within one sampling_time (Eq. 42)");
  }
  problem.A = roundedMatrix(discrete.A, bits);
  problem.B = roundedMatrix(discrete.B, bits);
  problem.G = roundedMatrix(discrete.Bd, bits);
}

void normaliseDisturbances(RobustProblem& problem, const std::vector<RobustProblem::Range>& ranges) {
  problem.drift.assign(static_cast<std::size_t>(problem.stateCount()), Rational(0));
  for (int j = 0; j < problem.channelCount(); ++j) {
    const RobustProblem::Range& range = ranges[static_cast<std::size_t>(j)];
    const Rational middle = (range.lower + range.upper) / 2, half = (range.upper - range.lower) / 2;
    for (int i = 0; i < problem.stateCount(); ++i) {
      problem.drift[static_cast<std::size_t>(i)] += problem.G(i, j) * middle;
      problem.G(i, j) *= half;
    }
  }
}

int readModel(const YamlField& model, RobustProblem& problem) {
  model.checkKeys({"states", "inputs", "disturbances", "A", "B", "G", "C"}, {"time", "bits", "delay"});
  readDelay(model);  // of the controller, which predicts over it
  std::vector<RobustProblem::Range> ranges;
  readSignals(model, problem, ranges);
  const int nx = static_cast<int>(problem.states.size());
  problem.A = matrixOf(model.at("A"), nx, nx);
  problem.B = matrixOf(model.at("B"), nx, static_cast<int>(problem.inputs.size()));
  problem.G = matrixOf(model.at("G"), nx, static_cast<int>(problem.disturbances.size()));
  problem.C = matrixOf(model.at("C"), -1, nx);
  if (problem.outputCount() == 0) model.at("C").fail("must have at least one row");
  const int bits = model.has("bits") ? model.at("bits").integer(8, kMaxBits) : kDefaultBits;
  const std::string time = model.has("time") ? model.at("time").text() : "continuous";
  if (time != "continuous" && time != "discrete")
    model.at("time").fail("must be continuous or discrete, got '" + time + "'");
  if (time == "continuous") discretiseExactly(model, problem, bits);
  normaliseDisturbances(problem, ranges);
  return bits;
}

RationalMatrix readGain(const YamlField& field, const RobustProblem& problem, int bits) {
  field.checkKeys({}, {"gain", "Q", "R"});
  if (field.has("gain")) {
    if (field.has("Q") || field.has("R")) field.fail("must have either gain, or Q and R");
    return matrixOf(field.at("gain"), problem.inputCount(), problem.stateCount());
  }
  const Eigen::MatrixXd Q = field.at("Q").weight(problem.stateCount());
  const Eigen::MatrixXd R = field.at("R").weight(problem.inputCount());
  const Eigen::MatrixXd A = toDoubles(problem.A), B = toDoubles(problem.B);
  try {
    const Eigen::MatrixXd P = solveRiccati(A, B, Q, R);
    const Eigen::MatrixXd curvature = R + B.transpose() * P * B;
    return roundedMatrix(-curvature.ldlt().solve(B.transpose() * P * A), bits);
  } catch (const Error& error) {
    field.fail(error.what());
  }
}

template <typename Value>
Value choice(const YamlField& root, const char* key, Value absent,
             const std::vector<std::pair<std::string, Value>>& known) {
  if (!root.has(key)) return absent;
  const std::string text = root.at(key).text();
  std::string list;
  for (const auto& [name, value] : known) {
    if (name == text) return value;
    list += (list.empty() ? "" : ", ") + name;
  }
  root.at(key).fail("must be one of " + list + ", got '" + text + "'");
}

void readChoices(const YamlField& root, RobustProblem& problem, int bits) {
  problem.stack =
      choice<Stack>(root, "stack", Stack::kPaper, {{"paper", Stack::kPaper}, {"shift", Stack::kShift}});
  problem.feedback = choice<FeedbackPrediction>(root, "feedback_predictions", FeedbackPrediction::kFree,
                                                {{"free", FeedbackPrediction::kFree},
                                                 {"zero", FeedbackPrediction::kZero},
                                                 {"fixed", FeedbackPrediction::kFixed}});
  problem.invariance = choice<InvarianceRule>(root, "invariance", InvarianceRule::kNone,
                                              {{"none", InvarianceRule::kNone},
                                               {"first_step", InvarianceRule::kFirstStep},
                                               {"terminal", InvarianceRule::kTerminal}});
  problem.peak_in_map = choice<bool>(root, "peak_in_map", false, {{"true", true}, {"false", false}});
  problem.tie_gain = readGain(root.at("tie_break"), problem, bits);
  const bool fixed = problem.feedback == FeedbackPrediction::kFixed;
  if (root.has("feedback_gain")) {
    if (!fixed) root.at("feedback_gain").fail("goes with feedback_predictions: fixed only");
    problem.feedback_gain = readGain(root.at("feedback_gain"), problem, bits);
  } else if (fixed) {
    problem.feedback_gain = problem.tie_gain;
  }
  if (root.has("floor")) problem.floor = rationalOf(root.at("floor"));
  if (problem.floor < 0) root.at("floor").fail("must not be below 0");
}

void readParameter(const YamlField& field, Names& taken, std::set<int>& errors, RobustProblem& problem) {
  field.checkKeys({"name", "role", "unit", "range"}, {"of", "state", "input"});
  RobustProblem::Parameter parameter;
  parameter.signal = signalOf(field, taken);
  parameter.range = rangeOf(field.at("range"));
  setBounds(parameter.signal, parameter.range);
  const std::string role = field.at("role").text();
  if (role == "error") {
    const std::string of = field.at("of").name();
    const auto found = std::find_if(problem.states.begin(), problem.states.end(),
                                    [&](const Signal& state) { return state.name == of; });
    if (found == problem.states.end()) field.at("of").fail("must name a state, got '" + of + "'");
    parameter.state = static_cast<int>(found - problem.states.begin());
    if (!errors.insert(parameter.state).second)
      field.at("of").fail("another parameter has this role for '" + of + "'");
    if (parameter.signal.unit != found->unit)
      field.at("unit").fail("must be " + found->unit + " as for '" + of + "'");
  } else if (role == "reference") {
    if (field.has("of")) field.at("of").fail("goes with role error only");
    parameter.state_shift = vectorOf(field.at("state"), problem.stateCount());
    parameter.input_shift = vectorOf(field.at("input"), problem.inputCount());
  } else {
    field.at("role").fail("must be error or reference, got '" + role + "'");
  }
  problem.parameters.push_back(std::move(parameter));
}

void readParameters(const YamlField& parameters, RobustProblem& problem) {
  Names taken;
  std::set<int> errors;
  for (const YamlField& field : parameters.items()) readParameter(field, taken, errors, problem);
  for (int i = 0; i < problem.stateCount(); ++i) {
    if (errors.count(i) == 0)
      parameters.fail("must have one with role error of state '" +
                      problem.states[static_cast<std::size_t>(i)].name + "'");
  }
}

}  // namespace

std::vector<int> RobustProblem::errorParameters() const {
  std::vector<int> result(states.size(), -1);
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    if (parameters[j].state >= 0) result[static_cast<std::size_t>(parameters[j].state)] = static_cast<int>(j);
  }
  return result;
}

bool isRobustProblem(const std::string& text, const std::string& source) {
  const YamlField root = YamlField::parse(text, source);
  return root.has("type") && root.at("type").text() == "robust_mpc";
}

RobustProblem parseRobustProblem(const std::string& text, const std::string& source) {
  const YamlField root = YamlField::parse(text, source);
  if (root.has("type") && root.at("type").text() != "robust_mpc")
    root.at("type").fail("must be robust_mpc, got '" + root.at("type").text() + "'");
  root.checkKeys(
      {"polyfly_problem", "name", "type", "model", "sampling_time", "horizon", "tie_break", "parameters"},
      {"description", "provenance", "stack", "feedback_predictions", "feedback_gain", "floor", "invariance",
       "peak_in_map", "calibration"});
  // readProblem puts the numbers of these files in place of the key.
  if (root.has("calibration")) root.at("calibration").fail("names files: only a problem file may have it");
  root.at("polyfly_problem").integer(1, 1);
  RobustProblem problem;
  problem.source = source;
  problem.text = text;
  problem.name = root.at("name").name();
  if (root.has("description")) problem.description = root.at("description").text();
  problem.sampling_time = root.at("sampling_time").number();
  if (!(problem.sampling_time > 0.0)) root.at("sampling_time").fail("must be greater than 0");
  problem.horizon = root.at("horizon").integer(2, kMaxHorizon);
  const int bits = readModel(root.at("model"), problem);
  readChoices(root, problem, bits);
  readParameters(root.at("parameters"), problem);
  return problem;
}

RobustProblem loadRobustProblem(const std::string& path) {
  return parseRobustProblem(withCitedRanges(readProblem(path), path), path);
}

}  // namespace polyfly
