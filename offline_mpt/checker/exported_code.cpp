#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>

#include "checksum.hpp"
#include "code_match.hpp"
#include "code_template.hpp"
#include "lookup_tables.hpp"

namespace checker {

const char* nameOf(CodeType type) { return type == CodeType::kDouble ? "double" : "float"; }

namespace {

/// A whole number of the code: decimal, because a leading zero makes it octal.
std::uint32_t wholeOf(const std::string& text, const std::string& suffix) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  require(digits > 0 && digits <= 10 && (digits == 1 || text[0] != '0') && text.substr(digits) == suffix,
          text + " is no whole number of the code");
  const unsigned long long value = std::stoull(text.substr(0, digits));
  require(value <= UINT32_MAX, text + " is no whole number of the code");
  return static_cast<std::uint32_t>(value);
}

/// As a compiler reads the constant: of a float, to the nearest float.
double realOf(const std::string& text, CodeType type) {
  const bool is_float = text.back() == 'f';
  const std::string number = is_float ? text.substr(0, text.size() - 1) : text;
  require(isDecimal(number) && number.find_first_of(".eE") != std::string::npos &&
              is_float == (type == CodeType::kFloat),
          text + " is no number of the code's type");
  const double value =
      is_float ? static_cast<double>(std::strtof(text.c_str(), nullptr)) : std::strtod(text.c_str(), nullptr);
  require(std::isfinite(value), text + " is no number of the code's type");
  return value;
}

/// The digits behind a text.
std::string digitsBehind(const std::string& code, const std::string& text) {
  const std::size_t found = code.find(text);
  require(found != std::string::npos, "the code has no " + text);
  const std::size_t first = found + text.size();
  return code.substr(first, std::min(code.find_first_not_of("0123456789", first), code.size()) - first);
}

/// a . theta - c, added by halves up to eight parameters.
std::string sumText(std::size_t first, std::size_t end, std::size_t p) {
  const auto entry = [](std::size_t i) { return "@N@_REAL(@n@_plane[plane][" + std::to_string(i) + "])"; };
  if (end - first == 1) return "(" + entry(first) + " * theta[" + std::to_string(first) + "])";
  const std::size_t middle = (first + end + 1) / 2;
  const std::string left = "(" + sumText(first, middle, p);
  if (middle == p) return left + " - " + entry(p) + ")";
  return left + " + " + sumText(middle, end, p) + ")";
}

/// One file of C code: its text is that of an exported map, but for the numbers.
class CodeText {
 public:
  explicit CodeText(const std::string& text) : text_(text) {
    const std::size_t end = text.find("_tolerance = ");
    require(end != std::string::npos, "the code has no tolerance");
    const std::size_t first = text.rfind(' ', end) + 1;
    name_ = text.substr(first, end - first);
    require(std::all_of(name_.begin(), name_.end(),
                        [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; }),
            "the code's name is no identifier");
    const auto follows = [&](const std::string& word) {
      return first >= word.size() && text.compare(first - word.size(), word.size(), word) == 0;
    };
    require(follows("double ") || follows("float "), "the code is neither of double nor of float");
    type_ = follows("double ") ? CodeType::kDouble : CodeType::kFloat;
    p_ = wholeOf(digitsBehind(text, " " + name_ + "_box["), "");
    q_ = wholeOf(digitsBehind(text, "#define INPUT_COUNT "), "");
    require(p_ >= 1 && p_ <= kMostSignals && q_ >= 1 && q_ <= kMostSignals,
            "the code's sizes are out of range");
    match_ = matchCode(text, filledIn(kSourceText, keys()));
    checkIndexType();
  }

  const std::string& name() const { return name_; }
  CodeType type() const { return type_; }
  std::size_t parameters() const { return p_; }
  std::size_t inputs() const { return q_; }

  bool has(const std::string& table) const {
    return text_.find(" " + name_ + "_" + table + "[") != std::string::npos;
  }

  /// All numbers of a table with rows of `width`.
  std::vector<double> reals(const std::string& table, std::size_t width) const {
    std::vector<double> values;
    for (const std::string& text : numbers(table, width)) values.push_back(realOf(text, type_));
    return values;
  }

  /// With one dimension the width is 0.
  std::vector<std::uint32_t> indices(const std::string& table, std::size_t width = 0) const {
    std::vector<std::uint32_t> values;
    const std::uint64_t limit = std::uint64_t{1} << std::stoul(bitsOf(table));
    for (const std::string& text : numbers(table, width)) {
      values.push_back(wholeOf(text, "u"));
      require(values.back() < limit, "the table " + table + " has a number beyond its type");
    }
    return values;
  }

  double scalar(const std::string& key) const { return realOf(single(key), type_); }
  std::uint32_t macro(const std::string& key) const { return wholeOf(single(key), "u"); }

 private:
  static constexpr std::uint32_t kMostSignals = 256;
  static constexpr std::uint32_t kMostByHalves = 8;

  const std::string& single(const std::string& key) const {
    const CodeNumbers& found = match_.at(key);
    require(found.texts.size() == 1 && found.width == 0, key + " of the code is no number");
    return found.texts[0];
  }

  const std::vector<std::string>& numbers(const std::string& table, std::size_t width) const {
    const CodeNumbers& found = match_.at(table);
    require(found.width == width, "the table " + table + " has rows of another length");
    const std::size_t rows = found.texts.size() / (width == 0 ? 1 : width);
    require(table == "box" ? rows == p_ : rows == wholeOf(single(table + "_rows"), ""),
            "the table " + table + " has another number of rows than it says");
    return found.texts;
  }

  /// The bits of a table's numbers.
  std::string bitsOf(const std::string& table) const {
    const std::string key = "_t " + name_ + "_" + table + "[";
    const std::size_t end = text_.find(key);
    const std::size_t first = end == std::string::npos ? end : text_.rfind("uint", end);
    const std::string bits = first == std::string::npos ? "" : text_.substr(first + 4, end - first - 4);
    require(bits == "8" || bits == "16" || bits == "32", "the code has no table " + table);
    return bits;
  }

  std::map<std::string, std::string> keys() const {
    const bool is_double = type_ == CodeType::kDouble, has_nodes = has("node_plane");
    std::string upper = name_;
    for (char& letter : upper) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    const std::string suffix = is_double ? "" : "f", most = is_double ? "DBL_MAX" : "FLT_MAX";
    std::map<std::string, std::string> result = {
        {"n", name_},
        {"N", upper},
        {"p", std::to_string(p_)},
        {"p1", std::to_string(p_ + 1)},
        {"q", std::to_string(q_)},
        {"real", nameOf(type_)},
        {"zero", "0.0" + suffix},
        {"constants",
         is_double ? "typedef char @n@_constants[(sizeof(1.0) == sizeof(double)) ? 1 : -1];" : ""},
        {"prefix", is_double ? "DBL" : "FLT"},
        {"digits", is_double ? "53" : "24"},
        {"index", indexType()},
        {"node_count", has_nodes ? "\n#define NODE_COUNT $NODE_COUNT\n" : ""},
        {"tree", has_nodes ? kTreeText : ""},
        {"descent", has_nodes ? kDescentText : ""},
        {"distance", p_ > kMostByHalves ? kDistanceLoopText : "return " + sumText(0, p_ + 1, p_) + ";"},
        {"test", kTestText},
        {"tests", is_double ? "violation" : "holds"},
        {"result", is_double ? "double" : "int"},
        {"start", is_double ? "double greatest = -" + most + ";" : "int holds = 1;"},
        {"violated", is_double ? "greatest = " + most + ";" : "holds = 0;"},
        {"held", is_double ? "if (violation > greatest) { greatest = violation; }" : ""},
        {"finish", is_double ? "return greatest;" : "return holds;"},
        {"least", is_double ? "double least = " + most + ";" : ""},
        {"search", is_double ? kLeastSearchText : kFirstSearchText}};
    for (const char* const table : {"node_plane", "node_child", "leaf_first", "candidate_region",
                                    "candidate_first", "row", "region_law"}) {
      const bool is_there = has_nodes || std::string(table).compare(0, 4, "node") != 0;
      result[table] = is_there ? bitsOf(table) : "";
    }
    return result;
  }

  std::string indexType() const {
    return text_.find("uint32_t child = ROOT") != std::string::npos ? "uint32_t" : "unsigned int";
  }

  /// unsigned int has 16 bits on some processors: it must hold each index and each product of them.
  void checkIndexType() const {
    if (indexType() == "uint32_t") return;
    std::uint64_t greatest = std::uint64_t{macro("REGION_COUNT")} + 1;
    for (const auto& [key, found] : match_) {
      const std::size_t rows = found.texts.size() / std::max<std::size_t>(found.width, 1);
      greatest = std::max<std::uint64_t>(greatest, key == "plane" ? 2 * rows : rows);
      if (key == "node_child")
        for (const std::string& text : found.texts)
          greatest = std::max<std::uint64_t>(greatest, wholeOf(text, "u"));
    }
    require(greatest <= UINT16_MAX, "an index of the code is beyond 16 bits");
  }

  const std::string& text_;
  std::string name_;
  CodeType type_ = CodeType::kDouble;
  std::uint32_t p_ = 0, q_ = 0;
  CodeMatch match_;
};

void readTree(const CodeText& code, LookupTables& tables) {
  tables.root_leaf = code.macro("ROOT");
  if (!code.has("node_plane")) return;
  tables.node_plane = code.indices("node_plane");
  const std::vector<std::uint32_t> children = code.indices("node_child", 2);
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
  require(!leaf_first.empty() && !first.empty(), "the code has no leaves");
  require(law.size() == code.macro("REGION_COUNT"), "the code has another number of regions than it says");
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

}  // namespace

ExportedCode readCode(const std::string& text) {
  const CodeText code(text);
  ExportedCode result;
  result.name = code.name();
  result.type = code.type();
  LookupTables& tables = result.tables;
  tables.p = code.parameters();
  tables.q = code.inputs();
  const std::vector<double> box = code.reals("box", 2);
  for (std::size_t i = 0; i < tables.p; ++i) {
    tables.box.lower.push_back(box[2 * i]);
    tables.box.upper.push_back(box[2 * i + 1]);
  }
  tables.planes = code.reals("plane", tables.p + 1);
  tables.laws = code.reals("law", tables.p + 1);
  require(!tables.laws.empty() && tables.laws.size() % (tables.q * (tables.p + 1)) == 0,
          "the code's laws have wrong sizes");
  tables.tolerance = code.scalar("tolerance");
  readTree(code, tables);
  readLeaves(code, tables);
  tables.takes_first = result.type != CodeType::kDouble;
  checkIndices(tables);
  boundRounding(tables, result.type == CodeType::kFloat ? kFloats : kDoubles);
  return result;
}

void requireHeader(const std::string& header, const ExportedCode& code, const Map& map) {
  std::string upper = code.name;
  for (char& letter : upper) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  const std::string key = "_VERSION \"";
  const std::size_t found = header.find(key);
  require(found != std::string::npos, "the header has no version");
  const std::size_t first = found + key.size();
  const std::string version = header.substr(first, header.find_first_of("\"\n@", first) - first);
  matchCode(header, filledIn(kHeaderText, {{"n", code.name},
                                           {"N", upper},
                                           {"version", version},
                                           {"map", "xxh64:" + hexText(map.checksum)},
                                           {"problem", "xxh64:" + hexText(xxh64(map.problem))},
                                           {"p", std::to_string(code.tables.p)},
                                           {"q", std::to_string(code.tables.q)},
                                           {"regions", std::to_string(map.regions.size())},
                                           {"real", nameOf(code.type)}}));
}

}  // namespace checker
