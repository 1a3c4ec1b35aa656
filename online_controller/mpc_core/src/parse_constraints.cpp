#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "parse_parts.hpp"

namespace polyfly {
namespace {

constexpr double kNoConstraintBound = std::numeric_limits<double>::infinity();

/// A state or an input by its name.
struct NamedSignal {
  const Signal* signal = nullptr;
  bool is_state = false;
  Eigen::Index index = 0;
};

NamedSignal findSignal(const YamlField& field, const std::string& name, const MpcProblem& problem) {
  for (const bool is_state : {true, false}) {
    const std::vector<Signal>& signals = is_state ? problem.states : problem.inputs;
    const auto found = std::find_if(signals.begin(), signals.end(),
                                    [&](const Signal& signal) { return signal.name == name; });
    if (found != signals.end()) return {&*found, is_state, found - signals.begin()};
  }
  field.fail("must name a state or an input, got '" + name + "'");
}

void setCoefficient(const NamedSignal& named, double coefficient, StageConstraint* constraint) {
  (named.is_state ? constraint->G_x : constraint->G_u)(named.index) = coefficient;
}

/// `of: NAME` bounds one signal. `of: {NAME: coefficient, ...}` bounds a sum, which has a name and a unit of its own.
void readSubject(const YamlField& field, const MpcProblem& problem, StageConstraint* constraint) {
  constraint->G_x = Eigen::RowVectorXd::Zero(problem.stateCount());
  constraint->G_u = Eigen::RowVectorXd::Zero(problem.inputCount());
  const YamlField of = field.at("of");
  const std::vector<std::string> names = of.keys();
  if (names.empty()) {
    const NamedSignal named = findSignal(of, of.name(), problem);
    setCoefficient(named, 1.0, constraint);
    constraint->signal.name = field.has("name") ? field.at("name").name() : named.signal->name;
    constraint->signal.unit = named.signal->unit;
    if (field.has("unit") && field.at("unit").unit() != named.signal->unit)
      field.at("unit").fail("must be " + named.signal->unit + " as for '" + named.signal->name + "'");
    return;
  }
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (!seen.insert(name).second) of.failAt(name, "duplicate key");
    const double coefficient = of.at(name).number();
    if (coefficient == 0.0) of.at(name).fail("must not be 0");
    setCoefficient(findSignal(of, name, problem), coefficient, constraint);
  }
  constraint->signal.name = field.at("name").name();
  constraint->signal.unit = field.at("unit").unit();
}

void readBounds(const YamlField& field, Signal* signal) {
  signal->lower = -kNoConstraintBound;
  signal->upper = kNoConstraintBound;
  const bool one_side = field.has("lower") || field.has("upper");
  if (field.has("range") == one_side) field.failAt("range", "must be given, or one of lower and upper");
  if (field.has("lower") && field.has("upper")) field.at("upper").fail("both sides are given as a range");
  if (field.has("range")) field.at("range").range(&signal->lower, &signal->upper);
  if (field.has("lower")) signal->lower = field.at("lower").number();
  if (field.has("upper")) signal->upper = field.at("upper").number();
}

void readSoftness(const YamlField& field, StageConstraint* constraint) {
  field.checkKeys({"quadratic"}, {"linear", "slack"});
  constraint->soft = true;
  constraint->quadratic_weight = field.at("quadratic").number();
  if (!(constraint->quadratic_weight > 0.0)) field.at("quadratic").fail("must be above 0");
  if (field.has("linear")) constraint->linear_weight = field.at("linear").number();
  if (constraint->linear_weight < 0.0) field.at("linear").fail("must be 0 or more");
  if (!field.has("slack")) return;
  const std::string slack = field.at("slack").text();
  if (slack != "stage" && slack != "horizon")
    field.at("slack").fail("must be stage or horizon, got '" + slack + "'");
  if (slack == "horizon") constraint->slack = StageConstraint::Slack::kPerHorizon;
}

StageConstraint readConstraint(const YamlField& field, const MpcProblem& problem) {
  field.checkKeys({"of"}, {"name", "unit", "range", "lower", "upper", "measured_from", "soft"});
  StageConstraint constraint;
  readSubject(field, problem, &constraint);
  readBounds(field, &constraint.signal);
  if (field.has("measured_from")) {
    const std::string origin = field.at("measured_from").text();
    if (origin != "zero" && origin != "reference")
      field.at("measured_from").fail("must be zero or reference, got '" + origin + "'");
    constraint.absolute = origin == "zero";
  }
  if (field.has("soft")) readSoftness(field.at("soft"), &constraint);
  return constraint;
}

bool hasParameter(const MpcProblem& problem, ParameterRole role, Eigen::Index index) {
  const auto matches = [&](const MpcProblem::Parameter& parameter) {
    return parameter.role == role && parameter.index == index;
  };
  return std::any_of(problem.parameters.begin(), problem.parameters.end(), matches) ||
         std::any_of(problem.fixed_parameters.begin(), problem.fixed_parameters.end(), matches);
}

void checkPreviousInputs(const YamlField& root, const MpcProblem& problem) {
  for (std::size_t i = 0; i < problem.changes.size(); ++i) {
    const Signal& change = problem.changes[i];
    const bool bounded = std::isfinite(change.lower) || std::isfinite(change.upper);
    if (!bounded || hasParameter(problem, ParameterRole::kPreviousInput, static_cast<Eigen::Index>(i)))
      continue;
    const std::string& name = problem.inputs[i].name;
    root.at("model").at("inputs").items()[i].at("change").fail(
        "needs a parameter with role previous_input of " + name);
  }
}

}  // namespace

void readConstraints(const YamlField& root, MpcProblem* problem) {
  if (!root.has("constraints")) return;
  std::set<std::string> names;
  for (const YamlField& field : root.at("constraints").items()) {
    const StageConstraint constraint = readConstraint(field, *problem);
    if (!names.insert(constraint.signal.name).second)
      field.failAt("name", "duplicate name '" + constraint.signal.name + "'");
    problem->constraints.push_back(constraint);
  }
}

void readTerminalSet(const YamlField& root, MpcProblem* problem) {
  problem->T = Eigen::MatrixXd::Zero(0, problem->stateCount());
  if (!root.has("terminal_set")) return;
  const YamlField set = root.at("terminal_set");
  if (problem->terminal_equality)
    set.fail("must be absent: weights.terminal: equality ends at the reference");
  set.checkKeys({"T", "t"}, {});
  const int rows = static_cast<int>(set.at("T").items().size());
  if (rows == 0) set.at("T").fail("must have at least one row");
  problem->T = set.at("T").matrix(rows, problem->stateCount());
  const std::vector<YamlField> bounds = set.at("t").items();
  if (static_cast<int>(bounds.size()) != rows)
    set.at("t").fail("must have " + std::to_string(rows) + " numbers, got " + std::to_string(bounds.size()));
  problem->t.resize(rows);
  for (int i = 0; i < rows; ++i) {
    problem->t(i) = bounds[static_cast<std::size_t>(i)].number();
    if (problem->T.row(i).isZero(0.0))
      set.at("T").items()[static_cast<std::size_t>(i)].fail("must not be zero");
    if (!(problem->t(i) > 0.0))
      bounds[static_cast<std::size_t>(i)].fail("must be above 0: the set holds the reference");
  }
}

void checkNeededParameters(const YamlField& root, const MpcProblem& problem) {
  checkPreviousInputs(root, problem);
  bool follows = false;
  for (Eigen::Index i = 0; i < problem.inputCount(); ++i)
    follows = follows || hasParameter(problem, ParameterRole::kInputReference, i);
  if (!follows) return;
  for (std::size_t i = 0; i < problem.constraints.size(); ++i) {
    const StageConstraint& constraint = problem.constraints[i];
    for (Eigen::Index state = 0; constraint.absolute && state < constraint.G_x.size(); ++state) {
      if (constraint.G_x(state) == 0.0 || hasParameter(problem, ParameterRole::kStateReference, state))
        continue;
      const std::string& name = problem.states[static_cast<std::size_t>(state)].name;
      root.at("constraints")
          .items()[i]
          .fail("bounds " + name +
                " itself, while u_ref is a parameter: needs a parameter with role "
                "state_reference of " +
                name + ", or measured_from: reference");
    }
  }
}

}  // namespace polyfly
