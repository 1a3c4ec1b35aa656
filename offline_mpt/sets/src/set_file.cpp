#include <nlohmann/json.hpp>
#include <utility>

#include "polyfly_base/read_text.hpp"
#include "polytope_sets/exact_fields.hpp"
#include "polytope_sets/set_model.hpp"

namespace polyfly {
namespace {

std::vector<ExactHalfSpace> rowsOf(const RationalMatrix& A, const RationalVector& b) {
  std::vector<ExactHalfSpace> rows;
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    rows.push_back({{}, b[static_cast<std::size_t>(i)]});
    for (Eigen::Index j = 0; j < A.cols(); ++j) rows.back().a.push_back(A(i, j));
  }
  return rows;
}

void append(std::vector<ExactHalfSpace>& to, std::vector<ExactHalfSpace> rows) {
  to.insert(to.end(), std::make_move_iterator(rows.begin()), std::make_move_iterator(rows.end()));
}

// Dimension that the first entry of the first key present shows.
int dimensionOf(const YamlField& field) {
  for (const char* key : {"A", "A_eq", "vertices"}) {
    if (!field.has(key)) continue;
    const std::vector<YamlField> rows = field.at(key).items();
    if (!rows.empty()) return static_cast<int>(rows[0].items().size());
  }
  return field.has("box") ? static_cast<int>(field.at("box").items().size()) : 0;
}

ExactPolytope boxOf(const YamlField& field, int dimension) {
  const RationalMatrix ends = matrixOf(field, dimension, 2);
  RationalVector lower, upper;
  for (int j = 0; j < dimension; ++j) {
    if (ends(j, 0) > ends(j, 1)) field.fail("lower end must not exceed the upper end");
    lower.push_back(ends(j, 0));
    upper.push_back(ends(j, 1));
  }
  return ExactPolytope::box(lower, upper);
}

nlohmann::ordered_json numbers(const RationalVector& values) {
  auto list = nlohmann::ordered_json::array();
  for (const Rational& value : values) list.push_back(value.get_str());
  return list;
}

}  // namespace

Rational rationalOf(const YamlField& field) {
  Rational value;
  const std::string text = field.text();
  if (!parseRational(text, value)) field.fail("must be a decimal number or a fraction, got '" + text + "'");
  return value;
}

Signal signalOf(const YamlField& field, std::set<std::string>& taken) {
  Signal signal{field.at("name").name(), field.at("unit").unit(), 0.0, 0.0};
  if (!taken.insert(signal.name).second) field.at("name").fail("duplicate name '" + signal.name + "'");
  return signal;
}

RationalVector vectorOf(const YamlField& field, int size) {
  RationalVector values;
  for (const YamlField& entry : field.items()) values.push_back(rationalOf(entry));
  if (static_cast<int>(values.size()) != size) {
    field.fail("must have " + std::to_string(size) + " entries, got " + std::to_string(values.size()));
  }
  return values;
}

RationalMatrix matrixOf(const YamlField& field, int rows, int columns) {
  const std::vector<YamlField> lines = field.items();
  if (rows >= 0 && static_cast<int>(lines.size()) != rows) {
    field.fail("must have " + std::to_string(rows) + " rows, got " + std::to_string(lines.size()));
  }
  RationalMatrix matrix(static_cast<int>(lines.size()), columns);
  for (int i = 0; i < matrix.rows(); ++i) {
    const RationalVector row = vectorOf(lines[static_cast<std::size_t>(i)], columns);
    for (int j = 0; j < columns; ++j) matrix(i, j) = row[static_cast<std::size_t>(j)];
  }
  return matrix;
}

ExactPolytope setOf(const YamlField& field, int dimension) {
  if (dimension < 0) {
    dimension = dimensionOf(field);
    if (dimension < 1 || dimension > kMaxSetDimension) {
      field.fail("must give a set of 1 to " + std::to_string(kMaxSetDimension) +
                 " dimensions by A and b, A_eq and b_eq, box, or vertices");
    }
  }
  ExactPolytope set;
  set.dimension = dimension;
  for (const bool equality : {false, true}) {
    const std::string A = equality ? "A_eq" : "A", b = equality ? "b_eq" : "b";
    if (!field.has(A) && !field.has(b)) continue;
    const RationalMatrix rows = matrixOf(field.at(A), -1, dimension);
    append(equality ? set.equalities : set.rows,
           rowsOf(rows, vectorOf(field.at(b), static_cast<int>(rows.rows()))));
  }
  if (field.has("box")) set = intersect(set, boxOf(field.at("box"), dimension));
  if (field.has("vertices")) {
    const RationalMatrix points = matrixOf(field.at("vertices"), -1, dimension);
    std::vector<RationalVector> list;
    for (const ExactHalfSpace& row : rowsOf(points, RationalVector(static_cast<std::size_t>(points.rows()))))
      list.push_back(row.a);
    set = intersect(set, hull(dimension, list));
  }
  return set;
}

ExactPolytope parseSet(const std::string& text, const std::string& source) {
  const YamlField file = YamlField::parse(text, source);
  file.checkKeys({"polyfly_set"}, {"name", "description", "A", "b", "A_eq", "b_eq", "box", "vertices"});
  file.at("polyfly_set").integer(1, 1);
  return setOf(file, -1);
}

ExactPolytope loadSet(const std::string& path) { return parseSet(readText(path), path); }

std::string setText(const ExactPolytope& set) {
  nlohmann::ordered_json json = {{"polyfly_set", 1}};
  const auto put = [&](const char* A, const char* b, const std::vector<ExactHalfSpace>& rows) {
    auto matrix = nlohmann::ordered_json::array();
    RationalVector bounds;
    for (const ExactHalfSpace& row : rows) {
      matrix.push_back(numbers(row.a));
      bounds.push_back(row.b);
    }
    json[A] = matrix;
    json[b] = numbers(bounds);
  };
  if (!set.rows.empty() || set.equalities.empty()) put("A", "b", set.rows);
  if (!set.equalities.empty()) put("A_eq", "b_eq", set.equalities);
  return json.dump() + "\n";
}

}  // namespace polyfly
