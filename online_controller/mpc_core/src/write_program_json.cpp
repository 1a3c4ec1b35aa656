#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mpc_core/program_json.hpp"

namespace polyfly {
namespace {

using nlohmann::ordered_json;

ordered_json listOf(const Eigen::VectorXd& vector) {
  ordered_json list = ordered_json::array();
  for (Eigen::Index i = 0; i < vector.size(); ++i) list.push_back(vector(i));
  return list;
}

ordered_json listOf(const Eigen::MatrixXd& matrix) {
  ordered_json list = ordered_json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) list.push_back(listOf(Eigen::VectorXd(matrix.row(i))));
  return list;
}

ordered_json boundOf(double bound) {
  return std::isfinite(bound) ? ordered_json(bound) : ordered_json(nullptr);
}

/// A key to a line: texts of some thousand lines can be read, and compared line by line.
std::string textOf(const ordered_json& root) {
  std::string text = "{";
  for (const auto& [key, value] : root.items())
    text += (text.size() > 1 ? ",\n " : "\n ") + ordered_json(key).dump() + ": " + value.dump();
  return text + "\n}\n";
}

}  // namespace

std::string programJson(const ParametricProgram& program) {
  ordered_json root;
  root["name"] = program.name;
  if (program.period > 0.0) root["period"] = program.period;
  ordered_json lower = ordered_json::array(), upper = ordered_json::array();
  root["parameters"] = ordered_json::array();
  for (const Signal& signal : program.parameters) {
    root["parameters"].push_back({{"name", signal.name}, {"unit", signal.unit}});
    lower.push_back(signal.lower);
    upper.push_back(signal.upper);
  }
  root["lb"] = lower;
  root["ub"] = upper;
  root["A_theta"] = listOf(program.A_theta);
  root["b_theta"] = listOf(program.b_theta);
  root["H"] = listOf(program.H);
  root["f"] = listOf(program.f);
  root["F"] = listOf(program.F);
  root["A"] = listOf(program.A);
  root["b"] = listOf(program.b);
  root["B"] = listOf(program.S);
  if (!program.equalities.empty()) root["eq_ids"] = program.equalities;
  if (!program.row_names.empty()) root["row_names"] = program.row_names;
  root["inputs"] = ordered_json::array();
  for (const Signal& signal : program.inputs) {
    root["inputs"].push_back({{"name", signal.name},
                              {"unit", signal.unit},
                              {"lower", boundOf(signal.lower)},
                              {"upper", boundOf(signal.upper)}});
  }
  root["E"] = listOf(program.E);
  root["C"] = listOf(program.C);
  root["c"] = listOf(program.c);
  for (const SlackVariable& slack : program.slacks) {
    root["slacks"].push_back({{"name", slack.name},
                              {"unit", slack.unit},
                              {"variable", slack.variable},
                              {"rows", slack.rows},
                              {"floor", slack.floor}});
  }
  return textOf(root);
}

}  // namespace polyfly
