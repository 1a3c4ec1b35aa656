#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "mpc_core/parametric_program.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"

namespace polyfly {
namespace {

using nlohmann::json;

/// What a file may state. The last row is for people and for tests; keys that begin with _ are free as well.
constexpr const char* kKeys[] = {"name",        "H",      "f",    "F",        "A",         "b",
                                 "B",           "eq_ids", "lb",   "ub",       "out",       "A_theta",
                                 "b_theta",     "n",      "m",    "n_theta",  "period",    "parameters",
                                 "inputs",      "E",      "C",    "c",        "row_names", "slacks",
                                 "description", "tags",   "type", "expected", "samples"};

constexpr const char* kRequired[] = {"H", "f", "F", "A", "b", "B", "lb", "ub"};

constexpr std::size_t kGreatestName = 63;

/// The generic form; every complaint reads `file: field: rule`.
class JsonReader {
 public:
  JsonReader(const std::string& text, const std::string& source) : source_(source) {
    std::vector<std::set<std::string>> keys;
    const auto refuse_duplicates = [&](int, json::parse_event_t event, json& parsed) {
      if (event == json::parse_event_t::object_start) keys.emplace_back();
      if (event == json::parse_event_t::object_end) keys.pop_back();
      if (event == json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second) {
        fail(parsed.get<std::string>(), "duplicate key");
      }
      return true;
    };
    try {
      root_ = json::parse(text, refuse_duplicates);
    } catch (const json::parse_error& error) {
      // Bytes count from 1; the last one read is that which does not fit.
      const std::string read = text.substr(0, std::min(error.byte, text.size()));
      const std::size_t line = 1 + static_cast<std::size_t>(std::count(read.begin(), read.end(), '\n'));
      const std::size_t column = read.size() - (read.rfind('\n') + 1);
      throw Error(source_ + ":" + std::to_string(line) + ": file: is not valid JSON: column " +
                  std::to_string(column) +
                  (error.byte > text.size() ? " ends too early" : " has what does not belong there"));
    } catch (const json::out_of_range&) {
      fail("file", "is not valid JSON: a number is beyond the range of doubles");
    }
    if (!root_.is_object()) fail("file", "must be an object");
    for (const char* key : kRequired) at(key);
    checkKeys();
  }

  [[noreturn]] void fail(const std::string& field, const std::string& rule) const {
    throw Error(source_ + ": " + field + ": " + rule);
  }

  bool has(const std::string& key) const { return root_.contains(key); }

  const json& at(const std::string& key) const {
    if (!root_.contains(key)) fail(key, "missing");
    return root_.at(key);
  }

  std::string text(const std::string& key) const {
    if (!at(key).is_string() || at(key).get<std::string>().empty()) fail(key, "must be text");
    return at(key).get<std::string>();
  }

  double number(const std::string& key) const { return entries(json::array({at(key)}), key, 1)(0); }

  Eigen::VectorXd vector(const std::string& key, Eigen::Index size) const {
    return entries(at(key), key, size);
  }

  Eigen::MatrixXd matrix(const std::string& key, Eigen::Index rows, Eigen::Index cols) const {
    const json& value = array(at(key), key);
    if (static_cast<Eigen::Index>(value.size()) != rows) {
      fail(key, "must have " + std::to_string(rows) + " rows, got " + std::to_string(value.size()));
    }
    Eigen::MatrixXd result(rows, cols);
    for (Eigen::Index row = 0; row < rows; ++row) {
      const std::string field = key + "[" + std::to_string(row) + "]";
      result.row(row) = entries(value[static_cast<std::size_t>(row)], field, cols).transpose();
    }
    return result;
  }

  /// A 0-based index below `limit`.
  int index(const json& entry, const std::string& field, int limit) const {
    const bool valid = entry.is_number_integer() && entry.get<std::int64_t>() >= 0 &&
                       entry.get<std::int64_t>() < static_cast<std::int64_t>(limit);
    if (!valid) fail(field, "must hold whole numbers from 0 to " + std::to_string(limit - 1));
    return entry.get<int>();
  }

  /// 0-based indices below `limit`, without repetition.
  std::vector<int> indices(const std::string& key, int limit) const {
    std::vector<int> result;
    for (const json& entry : array(at(key), key)) {
      const int index = this->index(entry, key, limit);
      if (std::find(result.begin(), result.end(), index) != result.end()) {
        fail(key, "must not repeat " + std::to_string(index));
      }
      result.push_back(index);
    }
    return result;
  }

  /// The size that most of the lists have, of which one may be wrong; the first one's where all differ.
  Eigen::Index commonCount(std::initializer_list<const char*> keys, bool may_be_empty) const {
    std::vector<Eigen::Index> sizes;
    for (const char* key : keys) sizes.push_back(count(key, may_be_empty));
    for (const Eigen::Index size : sizes) {
      if (std::count(sizes.begin(), sizes.end(), size) > 1) return size;
    }
    return sizes.front();
  }

  /// Length of the list at `key`, which must not be empty unless `may_be_empty`.
  Eigen::Index count(const std::string& key, bool may_be_empty) const {
    const json& value = array(at(key), key);
    if (value.empty() && !may_be_empty) fail(key, "must not be empty");
    return static_cast<Eigen::Index>(value.size());
  }

  /// The objects of a list of `size` at `key`, each with these keys and no other; all keys but `lower`, `upper` and
  /// `floor` are required.
  std::vector<json> objects(const std::string& key, Eigen::Index size,
                            std::initializer_list<const char*> keys) const {
    std::vector<json> result;
    if (count(key, true) != size) fail(key, "must have " + std::to_string(size) + " entries");
    for (const json& entry : at(key)) {
      const std::string field = key + "[" + std::to_string(result.size()) + "]";
      if (!entry.is_object()) fail(field, "must be an object");
      for (const auto& [name, value] : entry.items())
        if (std::find(keys.begin(), keys.end(), name) == keys.end()) fail(field + "." + name, "unknown key");
      for (const std::string name : keys) {
        const bool optional = name == "lower" || name == "upper" || name == "floor";
        if (!optional && !entry.contains(name)) fail(field + "." + name, "missing");
      }
      result.push_back(entry);
    }
    return result;
  }

  /// A name, which must differ from those in `taken` unless that is nullptr, and a unit.
  void name(const json& object, const std::string& field, std::set<std::string>* taken,
            Signal* signal) const {
    for (const char* key : {"name", "unit"}) {
      const json& value = object.at(key);
      const bool valid = value.is_string() && !value.get<std::string>().empty() &&
                         value.get<std::string>().size() <= kGreatestName;
      if (!valid)
        fail(field + "." + key, "must be text of 1 to " + std::to_string(kGreatestName) + " characters");
    }
    signal->name = object.at("name").get<std::string>();
    signal->unit = object.at("unit").get<std::string>();
    if (taken != nullptr && !taken->insert(signal->name).second)
      fail(field + ".name", "duplicate name '" + signal->name + "'");
  }

  /// A bound of an object; none where it is absent or null.
  double bound(const json& object, const char* key, double none, const std::string& field) const {
    if (!object.contains(key) || object.at(key).is_null()) return none;
    return entries(json::array({object.at(key)}), field + "." + key, 1)(0);
  }

  std::vector<std::string> texts(const std::string& key, Eigen::Index size) const {
    if (count(key, true) != size) fail(key, "must have " + std::to_string(size) + " entries");
    std::vector<std::string> result;
    for (const json& entry : at(key)) {
      if (!entry.is_string()) fail(key, "must hold texts only");
      result.push_back(entry.get<std::string>());
    }
    return result;
  }

  /// `key`, where given, must state the size that the matrices have.
  void agrees(const std::string& key, Eigen::Index size) const {
    if (!has(key)) return;
    if (!at(key).is_number_integer() || at(key).get<std::int64_t>() != size) {
      fail(key, "must be " + std::to_string(size) + ", as the matrices have it");
    }
  }

 private:
  const json& array(const json& value, const std::string& field) const {
    if (!value.is_array()) fail(field, "must be a list");
    return value;
  }

  Eigen::VectorXd entries(const json& value, const std::string& field, Eigen::Index size) const {
    array(value, field);
    if (static_cast<Eigen::Index>(value.size()) != size) {
      fail(field, "must have " + std::to_string(size) + " numbers, got " + std::to_string(value.size()));
    }
    Eigen::VectorXd result(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      const json& entry = value[static_cast<std::size_t>(i)];
      if (!entry.is_number()) fail(field, "must hold finite numbers only");
      result(i) = entry.get<double>();
      if (!(std::abs(result(i)) <= kGreatestNumber)) {
        std::ostringstream rule;
        rule << "must not exceed " << kGreatestNumber << " in size, got " << result(i);
        fail(field + "[" + std::to_string(i) + "]", rule.str());
      }
    }
    return result;
  }

  /// A misspelt key would leave out what it states.
  void checkKeys() const {
    for (const auto& entry : root_.items()) {
      const std::string& key = entry.key();
      const bool known =
          std::any_of(std::begin(kKeys), std::end(kKeys), [&](const char* other) { return key == other; });
      if (known || (!key.empty() && key[0] == '_')) continue;
      std::string list;
      for (const char* other : kKeys) list += (list.empty() ? "" : ", ") + std::string(other);
      fail(key, "unknown key; known are " + list + ", and keys that begin with _");
    }
  }

  std::string source_;
  json root_;
};

void setBox(const JsonReader& reader, ParametricProgram* program) {
  const Eigen::Index p = reader.count("lb", false);
  const Eigen::VectorXd lower = reader.vector("lb", p);
  const Eigen::VectorXd upper = reader.vector("ub", p);
  for (Eigen::Index i = 0; i < p; ++i) {
    if (!(lower(i) < upper(i))) reader.fail("lb", "must be below ub, entry " + std::to_string(i));
    program->parameters.push_back({"theta_" + std::to_string(i), "1", lower(i), upper(i)});
  }
  const Eigen::Index rows = reader.has("A_theta") ? reader.count("A_theta", true) : 0;
  program->A_theta.resize(rows, p);
  program->b_theta.resize(rows);
  if (reader.has("parameters")) {
    std::set<std::string> taken;
    const std::vector<json> named = reader.objects("parameters", p, {"name", "unit"});
    for (std::size_t i = 0; i < named.size(); ++i)
      reader.name(named[i], "parameters[" + std::to_string(i) + "]", &taken, &program->parameters[i]);
  }
  if (reader.has("A_theta")) program->A_theta = reader.matrix("A_theta", rows, p);
  if (rows > 0 || reader.has("b_theta")) program->b_theta = reader.vector("b_theta", rows);
}

constexpr double kUnboundedInput = std::numeric_limits<double>::infinity();

void setInputs(const JsonReader& reader, Eigen::Index q, ParametricProgram* program) {
  if (!reader.has("inputs")) {
    for (Eigen::Index i = 0; i < q; ++i)
      program->inputs.push_back({"u_" + std::to_string(i), "1", -kUnboundedInput, kUnboundedInput});
    return;
  }
  std::set<std::string> taken;
  for (const json& object : reader.objects("inputs", q, {"name", "unit", "lower", "upper"})) {
    const std::string field = "inputs[" + std::to_string(program->inputs.size()) + "]";
    Signal input;
    reader.name(object, field, &taken, &input);
    input.lower = reader.bound(object, "lower", -kUnboundedInput, field);
    input.upper = reader.bound(object, "upper", kUnboundedInput, field);
    program->inputs.push_back(input);
  }
}

/// `E`, `C`, `c` of u = E z + C theta + c, or `out`, the entries of z that are u.
void setOutput(const JsonReader& reader, ParametricProgram* program) {
  const int n = program->variableCount();
  if (reader.has("E")) {
    if (reader.has("out")) reader.fail("out", "E says the same: only one of them may be given");
    const Eigen::Index q = reader.count("E", false);
    program->E = reader.matrix("E", q, n);
    program->C = reader.matrix("C", q, program->parameterCount());
    program->c = reader.vector("c", q);
    setInputs(reader, q, program);
    return;
  }
  for (const char* key : {"C", "c"})
    if (reader.has(key)) reader.fail(key, "needs E");
  std::vector<int> out;
  if (reader.has("out")) {
    out = reader.indices("out", n);
    if (out.empty()) reader.fail("out", "must not be empty");
  } else {
    for (int i = 0; i < n; ++i) out.push_back(i);
  }
  const auto q = static_cast<Eigen::Index>(out.size());
  program->E = Eigen::MatrixXd::Zero(q, n);
  program->C = Eigen::MatrixXd::Zero(q, program->parameterCount());
  program->c = Eigen::VectorXd::Zero(q);
  for (Eigen::Index i = 0; i < q; ++i) program->E(i, out[static_cast<std::size_t>(i)]) = 1.0;
  setInputs(reader, q, program);
}

/// Names of rows, and the variables that are slacks.
void setRowMeanings(const JsonReader& reader, ParametricProgram* program) {
  if (reader.has("row_names")) program->row_names = reader.texts("row_names", program->rowCount());
  if (!reader.has("slacks")) return;
  const Eigen::Index count = reader.count("slacks", true);
  for (const json& object : reader.objects("slacks", count, {"name", "unit", "variable", "rows", "floor"})) {
    const std::string field = "slacks[" + std::to_string(program->slacks.size()) + "]";
    Signal named;
    reader.name(object, field, nullptr, &named);
    SlackVariable slack;
    slack.name = named.name;
    slack.unit = named.unit;
    slack.variable = reader.index(object.at("variable"), field + ".variable", program->variableCount());
    if (!object.at("rows").is_array()) reader.fail(field + ".rows", "must be a list");
    for (const json& row : object.at("rows"))
      slack.rows.push_back(reader.index(row, field + ".rows", program->rowCount()));
    if (object.contains("floor") && object.at("floor") != -1)
      slack.floor = reader.index(object.at("floor"), field + ".floor", program->rowCount());
    program->slacks.push_back(slack);
  }
}

/// File name without folder and ending.
std::string stem(const std::string& source) {
  const std::size_t slash = source.find_last_of('/');
  const std::string file = slash == std::string::npos ? source : source.substr(slash + 1);
  return file.substr(0, file.find_last_of('.'));
}

}  // namespace

ParametricProgram parseProgramJson(const std::string& text, const std::string& source) {
  const JsonReader reader(text, source);
  ParametricProgram program;
  program.name = reader.has("name") ? reader.text("name") : stem(source);
  program.text = text;
  program.text_kind = "json";
  setBox(reader, &program);
  const Eigen::Index n = reader.commonCount({"H", "f", "F"}, false);
  const Eigen::Index m = reader.commonCount({"A", "b", "B"}, true);
  const Eigen::Index p = program.parameterCount();
  program.H = reader.matrix("H", n, n);
  program.f = reader.vector("f", n);
  program.F = reader.matrix("F", n, p);
  program.A = reader.matrix("A", m, n);
  program.b = reader.vector("b", m);
  program.S = reader.matrix("B", m, p);
  if (reader.has("eq_ids")) program.equalities = reader.indices("eq_ids", static_cast<int>(m));
  reader.agrees("n", n);
  reader.agrees("m", m);
  reader.agrees("n_theta", p);
  setOutput(reader, &program);
  setRowMeanings(reader, &program);
  if (reader.has("period")) program.period = reader.number("period");
  checkProgram(program, source);
  return program;
}

ParametricProgram loadProgramJson(const std::string& path) { return parseProgramJson(readText(path), path); }

}  // namespace polyfly
