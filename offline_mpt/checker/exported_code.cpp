#include <cmath>
#include <cstdlib>

#include "integer_tables.hpp"
#include "lookup_tables.hpp"

namespace checker {
namespace {

/// The numbers of the tables and macros of one file of C code.
class CodeText {
 public:
  explicit CodeText(const std::string& text) : text_(text) {
    const std::size_t end = text.find("_tolerance = ");
    require(end != std::string::npos, "the code has no tolerance");
    const std::size_t first = text.rfind(' ', end) + 1;
    name_ = text.substr(first, end - first);
    const auto follows = [&](const std::string& word) {
      return first >= word.size() && text.compare(first - word.size(), word.size(), word) == 0;
    };
    require(follows("double ") || follows("float ") || follows("int32_t "),
            "the code is none of double, float and int16");
    type_ = follows("double ") ? CodeType::kDouble : follows("float ") ? CodeType::kFloat : CodeType::kInt16;
  }

  const std::string& name() const { return name_; }
  CodeType type() const { return type_; }

  bool has(const std::string& table) const { return place(table) != std::string::npos; }

  /// All numbers of a table, which must be there once.
  std::vector<double> reals(const std::string& table) const {
    const std::size_t first = place(table);
    require(first != std::string::npos, "the code has no table " + table);
    require(text_.find(" " + name_ + "_" + table + "[", first + 1) == std::string::npos,
            "the table " + table + " is there twice");
    const std::size_t begin = text_.find("= {", first);
    const std::size_t end = text_.find(";", first);
    require(begin < end && end != std::string::npos, "the table " + table + " has no numbers");
    std::vector<double> values;
    for (const char* at = text_.c_str() + begin + 3; at < text_.c_str() + end;) {
      const bool starts = (*at >= '0' && *at <= '9') || *at == '-' || *at == '.';
      if (!starts) {
        require(
            *at == '{' || *at == '}' || *at == ',' || *at == ' ' || *at == '\n' || *at == 'f' || *at == 'u',
            "the table " + table + " has what is no number");
        ++at;
        continue;
      }
      char* rest = nullptr;
      values.push_back(number(at, &rest));
      require(rest != at && std::isfinite(values.back()),
              "the table " + table + " has a number that is not finite");
      at = rest;
    }
    return values;
  }

  std::vector<std::uint32_t> indices(const std::string& table) const {
    std::vector<std::uint32_t> result;
    for (const double value : reals(table)) {
      require(value >= 0.0 && value <= 4294967295.0 && value == std::floor(value),
              "the table " + table + " has no indices");
      result.push_back(static_cast<std::uint32_t>(value));
    }
    return result;
  }

  double scalar(const std::string& table) const {
    const std::string key = " " + name_ + "_" + table + " = ";
    const std::size_t first = text_.find(key);
    require(first != std::string::npos, "the code has no " + table);
    char* rest = nullptr;
    return number(text_.c_str() + first + key.size(), &rest);
  }

  /// The exponent of a signal that the code compares with its header.
  int exponent(const std::string& signal, std::size_t i) const {
    const std::string key = "_" + signal + "_" + std::to_string(i) + "_EXPONENT != ";
    const std::size_t first = text_.find(key);
    require(first != std::string::npos && text_.find(key, first + 1) == std::string::npos,
            "the code must have the exponent of " + signal + " " + std::to_string(i) + " once");
    const long value = std::strtol(text_.c_str() + first + key.size(), nullptr, 10);
    require(value >= -200 && value <= 200, "an exponent of the code is out of range");
    return static_cast<int>(value);
  }

  /// A macro of a whole number.
  std::uint32_t macro(const std::string& key) const {
    const std::string define = "#define " + key + " ";
    const std::size_t first = text_.find(define);
    require(first != std::string::npos, "the code has no " + key);
    return static_cast<std::uint32_t>(std::strtoul(text_.c_str() + first + define.size(), nullptr, 10));
  }

 private:
  std::size_t place(const std::string& table) const { return text_.find(" " + name_ + "_" + table + "["); }

  /// As a compiler reads the constant: of a float, to the nearest float.
  double number(const char* at, char** rest) const {
    return type_ == CodeType::kFloat ? static_cast<double>(std::strtof(at, rest)) : std::strtod(at, rest);
  }

  const std::string& text_;
  std::string name_;
  CodeType type_ = CodeType::kDouble;
};

void readTree(const CodeText& code, LookupTables& tables) {
  tables.root_leaf = code.macro("ROOT");
  if (!code.has("node_plane")) return;
  tables.node_plane = code.indices("node_plane");
  const std::vector<std::uint32_t> children = code.indices("node_child");
  require(children.size() == 2 * tables.node_plane.size() &&
              code.macro("NODE_COUNT") == tables.node_plane.size() && tables.root_leaf == 0,
          "the code's search tree has wrong sizes");
  for (std::size_t i = 0; i < tables.node_plane.size(); ++i)
    tables.children.push_back({children[2 * i], children[2 * i + 1]});
}

void readLeaves(const CodeText& code, LookupTables& tables) {
  const std::vector<std::uint32_t> leaf_first = code.indices("leaf_first"),
                                   region = code.indices("candidate_region"),
                                   first = code.indices("candidate_first"), rows = code.indices("row"),
                                   law = code.indices("region_law");
  const std::uint32_t first_fallback = code.macro("FIRST_FALLBACK");
  require(!leaf_first.empty() && !first.empty(), "the code has no leaves");
  for (std::size_t i = 0; i + 1 < leaf_first.size(); ++i) {
    require(leaf_first[i] <= leaf_first[i + 1] && leaf_first[i + 1] < first.size() &&
                leaf_first[i + 1] <= region.size(),
            "a leaf of the code reaches beyond its tables");
    tables.leaves.emplace_back();
    for (std::uint32_t c = leaf_first[i]; c < leaf_first[i + 1]; ++c) {
      require(first[c] <= first[c + 1] && first[c + 1] <= rows.size() && region[c] < law.size(),
              "a candidate of the code reaches beyond its tables");
      LookupTables::Candidate candidate;
      candidate.region = region[c];
      candidate.law = law[region[c]];
      candidate.is_fallback = region[c] >= first_fallback;
      candidate.rows.assign(rows.begin() + first[c], rows.begin() + first[c + 1]);
      tables.leaves.back().push_back(candidate);
    }
  }
}

void checkIndices(const LookupTables& tables) {
  const std::size_t planes = tables.planes.size() / (tables.p + 1), nodes = tables.node_plane.size();
  require(tables.root() < nodes + tables.leaves.size(), "the code's root is none of its leaves");
  for (std::size_t i = 0; i < nodes; ++i) {
    require(tables.node_plane[i] < planes, "a node of the code names no plane");
    for (const std::uint32_t child : tables.children[i])
      require(child > i && child < nodes + tables.leaves.size(), "a node of the code has no such child");
  }
  for (const std::vector<LookupTables::Candidate>& leaf : tables.leaves) {
    for (const LookupTables::Candidate& candidate : leaf) {
      require((std::size_t{candidate.law} + 1) * tables.q * (tables.p + 1) <= tables.laws.size(),
              "a region of the code names no law");
      for (const std::uint32_t row : candidate.rows)
        require(row / 2 < planes, "a row of the code names no plane");
    }
  }
}

/// What the integers of the tables stand for.
IntegerScales integerScales(const CodeText& code, const LookupTables& tables) {
  IntegerScales scales;
  for (std::size_t i = 0; i < tables.p; ++i) scales.theta.push_back(code.exponent("THETA", i));
  for (std::size_t j = 0; j < tables.q; ++j) scales.u.push_back(code.exponent("U", j));
  scales.plane = static_cast<int>(code.macro("PLANE_EXPONENT"));
  scales.plane_unit = code.macro("PLANE_UNIT");
  scales.law_unit = code.macro("LAW_UNIT");
  scales.greatest_input = code.macro("GREATEST_INPUT");
  scales.law_shift = code.indices("law_shift");
  return scales;
}

}  // namespace

const char* nameOf(CodeType type) {
  switch (type) {
    case CodeType::kDouble:
      return "double";
    case CodeType::kFloat:
      return "float";
    case CodeType::kInt16:
      return "int16";
  }
  return "";
}

ExportedCode readCode(const std::string& text) {
  const CodeText code(text);
  ExportedCode result;
  result.name = code.name();
  result.type = code.type();
  LookupTables& tables = result.tables;
  const std::vector<double> box = code.reals("box");
  require(!box.empty() && box.size() % 2 == 0, "the code's box has wrong sizes");
  tables.p = box.size() / 2;
  for (std::size_t i = 0; i < tables.p; ++i) {
    tables.box.lower.push_back(box[2 * i]);
    tables.box.upper.push_back(box[2 * i + 1]);
  }
  tables.planes = code.reals("plane");
  tables.laws = code.reals("law");
  tables.q = code.macro("INPUT_COUNT");
  require(tables.q >= 1 && !tables.laws.empty() && tables.laws.size() % (tables.q * (tables.p + 1)) == 0 &&
              tables.planes.size() % (tables.p + 1) == 0,
          "the code's planes or laws have wrong sizes");
  tables.tolerance = code.scalar("tolerance");
  readTree(code, tables);
  readLeaves(code, tables);
  tables.takes_first = result.type != CodeType::kDouble;
  const bool tests_whether_held = text.find(result.name + "_holds(") != std::string::npos;
  require(tests_whether_held == tables.takes_first,
          "the code searches a leaf in another way than its type does now; export it again");
  const bool has_handicap = !tables.takes_first && code.macro("FIRST_FALLBACK") != code.macro("REGION_COUNT");
  tables.handicap = has_handicap ? code.scalar("handicap") : 0.0;
  checkIndices(tables);
  if (result.type == CodeType::kInt16) {
    scaleIntegers(integerScales(code, tables), tables);
  } else {
    boundRounding(tables, result.type == CodeType::kFloat ? kFloats : kDoubles);
  }
  return result;
}

}  // namespace checker
