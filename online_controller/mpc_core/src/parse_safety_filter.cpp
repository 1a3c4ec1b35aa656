#include <set>
#include <utility>

#include "mpc_core/safety_filter.hpp"
#include "polyfly_base/yaml_field.hpp"

namespace polyfly {
namespace {

constexpr double kDefaultInputError = 1e-6;
constexpr double kDefaultMargin = 1e-4;
constexpr double kLeastMargin = 1e-9;
constexpr double kGreatestMargin = 0.1;
constexpr std::size_t kMaxStates = 6;
constexpr std::size_t kMaxInputs = 3;

using TakenNames = std::set<std::string>;

Signal readRangedSignal(const YamlField& field, TakenNames& taken) {
  Signal signal{field.at("name").name(), field.at("unit").unit(), 0.0, 0.0};
  if (!taken.insert(signal.name).second) field.at("name").fail("duplicate name '" + signal.name + "'");
  field.at("range").range(&signal.lower, &signal.upper);
  return signal;
}

double errorOf(const YamlField& field, double absent) {
  if (!field.has("error")) return absent;
  const double error = field.at("error").number();
  if (error < 0.0) field.at("error").fail("must be at least 0");
  return error;
}

void checkCount(const YamlField& list, std::size_t count, std::size_t greatest) {
  if (count < 1 || count > greatest)
    list.fail("must have 1 to " + std::to_string(greatest) + " entries, has " + std::to_string(count));
}

void readFilterStates(const YamlField& list, TakenNames& taken, SafetyFilterProblem& problem) {
  const std::vector<YamlField> items = list.items();
  checkCount(list, items.size(), kMaxStates);
  problem.state_errors.resize(static_cast<Eigen::Index>(items.size()));
  for (std::size_t i = 0; i < items.size(); ++i) {
    items[i].checkKeys({"name", "unit", "range"}, {"error"});
    problem.states.push_back(readRangedSignal(items[i], taken));
    problem.state_errors[static_cast<Eigen::Index>(i)] = errorOf(items[i], 0.0);
  }
}

void readFilterInputs(const YamlField& list, TakenNames& taken, SafetyFilterProblem& problem) {
  const std::vector<YamlField> items = list.items();
  checkCount(list, items.size(), kMaxInputs);
  const auto nu = static_cast<Eigen::Index>(items.size());
  problem.input_errors.resize(nu);
  problem.weights.resize(nu);
  for (Eigen::Index i = 0; i < nu; ++i) {
    const YamlField& field = items[static_cast<std::size_t>(i)];
    field.checkKeys({"name", "unit", "range"}, {"error", "weight", "wish"});
    const Signal input = readRangedSignal(field, taken);
    Signal wish = input;
    wish.name += "_wish";
    if (!taken.insert(wish.name).second) field.at("name").fail(wish.name + " is the name of the wish");
    if (!taken.insert(input.name + "_before").second)
      field.at("name").fail(input.name + "_before is the name of the input before");
    if (field.has("wish")) field.at("wish").range(&wish.lower, &wish.upper);
    problem.input_errors[i] = errorOf(field, kDefaultInputError);
    problem.weights[i] = field.has("weight") ? field.at("weight").number() : 1.0;
    if (!(problem.weights[i] > 0.0)) field.at("weight").fail("must be greater than 0");
    problem.inputs.push_back(input);
    problem.wishes.push_back(std::move(wish));
  }
}

void readFilterModel(const YamlField& model, SafetyFilterProblem& problem) {
  model.checkKeys({"states", "inputs", "A", "B"}, {"disturbances", "B_d"});
  TakenNames taken;
  readFilterStates(model.at("states"), taken, problem);
  readFilterInputs(model.at("inputs"), taken, problem);
  if (model.has("disturbances")) {
    for (const YamlField& field : model.at("disturbances").items()) {
      field.checkKeys({"name", "unit", "range"}, {});
      problem.disturbances.push_back(readRangedSignal(field, taken));
    }
  }
  const int nx = static_cast<int>(problem.states.size());
  const int nd = static_cast<int>(problem.disturbances.size());
  problem.A_c = model.at("A").matrix(nx, nx);
  problem.B_c = model.at("B").matrix(nx, static_cast<int>(problem.inputs.size()));
  problem.Bd_c = Eigen::MatrixXd::Zero(nx, nd);
  if (nd > 0) {
    problem.Bd_c = model.at("B_d").matrix(nx, nd);
  } else if (model.has("B_d")) {
    model.at("B_d").fail("must be absent when there are no disturbances");
  }
}

Eigen::VectorXd numbersOf(const YamlField& field, int size) {
  const std::vector<YamlField> items = field.items();
  if (static_cast<int>(items.size()) != size) field.fail("must have " + std::to_string(size) + " entries");
  Eigen::VectorXd values(size);
  for (int i = 0; i < size; ++i) values[i] = items[static_cast<std::size_t>(i)].number();
  return values;
}

SafeSet readSafeSet(const YamlField& field, const SafetyFilterProblem& problem) {
  field.checkKeys({"H", "k", "G", "b", "M"}, {});
  SafeSet set;
  const int n = problem.augmentedCount();
  const int facets = static_cast<int>(field.at("H").items().size());
  if (facets < 1) field.at("H").fail("must have at least one row");
  set.H = field.at("H").matrix(facets, n);
  for (int i = 0; i < facets; ++i) {
    if (set.H.row(i).isZero(0.0)) field.at("H").fail("row " + std::to_string(i) + " must not be 0");
  }
  set.k = numbersOf(field.at("k"), facets);
  set.G = field.at("G").matrix(facets, problem.inputCount());
  set.b = numbersOf(field.at("b"), facets);
  set.M = field.at("M").matrix(facets, n);
  return set;
}

}  // namespace

std::vector<Signal> SafetyFilterProblem::augmentedStates() const {
  std::vector<Signal> result = states;
  if (!(delay > 0.0)) return result;
  for (Signal input : inputs) {
    input.name += "_before";
    result.push_back(std::move(input));
  }
  return result;
}

bool isSafetyFilter(const std::string& text, const std::string& source) {
  const YamlField root = YamlField::parse(text, source);
  return root.has("type") && root.at("type").text() == "safety_filter";
}

SafetyFilterProblem parseSafetyFilter(const std::string& text, const std::string& source) {
  const YamlField root = YamlField::parse(text, source);
  root.checkKeys({"polyfly_problem", "name", "type", "model", "sampling_time"},
                 {"description", "delay", "margin", "safe_set"});
  root.at("polyfly_problem").integer(1, 1);
  SafetyFilterProblem problem;
  problem.source = source;
  problem.text = text;
  problem.name = root.at("name").name();
  if (root.has("description")) problem.description = root.at("description").text();
  if (root.at("type").text() != "safety_filter")
    root.at("type").fail("must be safety_filter here, got '" + root.at("type").text() + "'");
  readFilterModel(root.at("model"), problem);
  problem.sampling_time = root.at("sampling_time").number();
  if (!(problem.sampling_time > 0.0)) root.at("sampling_time").fail("must be greater than 0");
  if (root.has("delay")) problem.delay = root.at("delay").number();
  if (problem.delay < 0.0 || problem.delay > problem.sampling_time)
    root.at("delay").fail("must be from 0 to sampling_time");
  problem.margin = root.has("margin") ? root.at("margin").number() : kDefaultMargin;
  if (!(problem.margin >= kLeastMargin && problem.margin <= kGreatestMargin))
    root.at("margin").fail("must be from 1e-9 to 0.1");
  if (root.has("safe_set")) problem.safe_set = readSafeSet(root.at("safe_set"), problem);
  return problem;
}

}  // namespace polyfly
