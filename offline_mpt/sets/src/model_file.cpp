#include <Eigen/Core>
#include <algorithm>
#include <set>
#include <utility>

#include "mpc_core/mpc_problem.hpp"
#include "polyfly_base/read_text.hpp"
#include "polytope_sets/exact_fields.hpp"
#include "polytope_sets/set_model.hpp"

namespace polyfly {
namespace {

struct SignalList {
  std::vector<Signal> signals;
  // Ranges of the signals that have one.
  ExactPolytope ranges;
};

SignalList signalsOf(const YamlField& file, const char* key, bool must_have_range,
                     std::set<std::string>& names) {
  SignalList list;
  if (!file.has(key)) return list;
  const std::vector<YamlField> entries = file.at(key).items();
  list.ranges.dimension = static_cast<int>(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const YamlField& entry = entries[i];
    if (must_have_range) {
      entry.checkKeys({"name", "unit", "range"}, {});
    } else {
      entry.checkKeys({"name", "unit"}, {"range"});
    }
    list.signals.push_back(signalOf(entry, names));
    if (!entry.has("range")) continue;
    const RationalVector ends = vectorOf(entry.at("range"), 2);
    if (ends[0] > ends[1]) entry.at("range").fail("lower end must not exceed the upper end");
    ExactHalfSpace row{RationalVector(entries.size()), ends[1]};
    row.a[i] = 1;
    list.ranges.rows.push_back(row);
    row.a[i] = -1;
    row.b = -ends[0];
    list.ranges.rows.push_back(std::move(row));
  }
  return list;
}

void readParameters(const YamlField& file, SetModel& model, std::set<std::string>& names) {
  if (!file.has("parameters")) return;
  for (const YamlField& entry : file.at("parameters").items()) {
    entry.checkKeys({"name", "unit", "next"}, {});
    ModelParameter parameter;
    parameter.signal = signalOf(entry, names);
    const std::string next = entry.at("next").name();
    if (next != "constant") {
      const auto found = std::find_if(model.inputs.begin(), model.inputs.end(),
                                      [&](const Signal& input) { return input.name == next; });
      if (found == model.inputs.end())
        entry.at("next").fail("must be 'constant' or the name of an input, got '" + next + "'");
      if (found->unit != parameter.signal.unit)
        entry.at("unit").fail("must be that of input '" + next + "', " + found->unit);
      parameter.input = static_cast<int>(found - model.inputs.begin());
    }
    model.parameters.push_back(std::move(parameter));
  }
}

RationalMatrix matrixAt(const YamlField& file, const char* key, int rows, int columns) {
  if (!file.has(key)) {
    if (columns > 0) file.failAt(key, "missing");
    return RationalMatrix(rows, columns);
  }
  return matrixOf(file.at(key), rows, columns);
}

// x' = A x + ... to x+ = A x + ..., with everything but x constant over a period. In double precision; the
// doubles are the model from then on.
void discretiseModel(SetModel& model, double period) {
  const int nx = model.stateCount(), nq = static_cast<int>(model.A_p.cols()), nd = model.disturbanceCount();
  MpcProblem continuous;
  continuous.A_c = toDoubles(model.A);
  continuous.B_c = toDoubles(model.B);
  continuous.Bd_c = Eigen::MatrixXd::Zero(nx, nq + nd + 1);
  continuous.Bd_c.leftCols(nq) = toDoubles(model.A_p);
  continuous.Bd_c.middleCols(nq, nd) = toDoubles(model.E);
  for (int i = 0; i < nx; ++i)
    continuous.Bd_c(i, nq + nd) = nearestDouble(model.c[static_cast<std::size_t>(i)]);
  const DiscreteModel discrete = discretise(continuous, period);
  model.A = exactly(discrete.A);
  model.B = exactly(discrete.B);
  model.A_p = exactly(discrete.Bd.leftCols(nq));
  model.E = exactly(discrete.Bd.middleCols(nq, nd));
  for (int i = 0; i < nx; ++i) model.c[static_cast<std::size_t>(i)] = Rational(discrete.Bd(i, nq + nd));
}

ExactPolytope setAt(const YamlField& file, const char* key, ExactPolytope ranges, int dimension) {
  ranges.dimension = dimension;
  if (!file.has(key)) return ranges;
  const YamlField field = file.at(key);
  field.checkKeys({}, {"A", "b", "A_eq", "b_eq", "box", "vertices"});
  return intersect(ranges, setOf(field, dimension));
}

}  // namespace

SetModel parseModel(const std::string& text, const std::string& source) {
  const YamlField file = YamlField::parse(text, source);
  file.checkKeys({"polyfly_model", "name", "states", "A"},
                 {"description", "inputs", "disturbances", "parameters", "B", "A_p", "E", "c",
                  "sampling_time", "X", "U", "D"});
  file.at("polyfly_model").integer(1, 1);
  SetModel model;
  model.name = file.at("name").name();
  std::set<std::string> names;
  SignalList states = signalsOf(file, "states", false, names);
  SignalList inputs = signalsOf(file, "inputs", false, names);
  SignalList disturbances = signalsOf(file, "disturbances", !file.has("D"), names);
  model.states = std::move(states.signals);
  model.inputs = std::move(inputs.signals);
  model.disturbances = std::move(disturbances.signals);
  const int nx = static_cast<int>(model.states.size());
  if (nx < 1 || nx > kMaxSetDimension)
    file.at("states").fail("must have 1 to " + std::to_string(kMaxSetDimension) + " entries");
  readParameters(file, model, names);
  const int nu = static_cast<int>(model.inputs.size()), nd = static_cast<int>(model.disturbances.size());
  model.A = matrixAt(file, "A", nx, nx);
  model.B = matrixAt(file, "B", nx, nu);
  model.A_p = RationalMatrix(nx, static_cast<int>(model.parameters.size()));
  if (file.has("A_p")) model.A_p = matrixOf(file.at("A_p"), nx, static_cast<int>(model.parameters.size()));
  model.E = matrixAt(file, "E", nx, nd);
  model.c = file.has("c") ? vectorOf(file.at("c"), nx) : RationalVector(static_cast<std::size_t>(nx));
  if (file.has("sampling_time")) {
    const double period = file.at("sampling_time").number();
    if (!(period > 0.0)) file.at("sampling_time").fail("must be above 0");
    discretiseModel(model, period);
  }
  model.X = setAt(file, "X", std::move(states.ranges), nx);
  model.U = setAt(file, "U", std::move(inputs.ranges), nu);
  model.D = setAt(file, "D", std::move(disturbances.ranges), nd);
  const Generators corners = generators(model.D);
  if (corners.vertices.empty()) file.fail("the set of disturbances is empty");
  if (!corners.rays.empty() || !corners.lines.empty()) file.fail("the set of disturbances is unbounded");
  return model;
}

SetModel loadModel(const std::string& path) { return parseModel(readText(path), path); }

}  // namespace polyfly
