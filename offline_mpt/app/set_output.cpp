#include "set_output.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "polyfly_base/error.hpp"
#include "polytope_sets/polytope.hpp"

namespace polyfly {
namespace {

using Json = nlohmann::ordered_json;

void show(const Json& json) { std::printf("%s\n", json.dump(2).c_str()); }

Json exactJson(const RationalVector& values) {
  Json list = Json::array();
  for (const Rational& value : values) list.push_back(value.get_str());
  return list;
}

Json roundedJson(const RationalVector& values) {
  Json list = Json::array();
  for (const Rational& value : values) list.push_back(nearestDouble(value));
  return list;
}

Json numberJson(const Rational& value) {
  return {{"exact", value.get_str()}, {"rounded", nearestDouble(value)}};
}

Json vectorJson(const RationalVector& values) {
  return {{"exact", exactJson(values)}, {"rounded", roundedJson(values)}};
}

Json setJson(const ExactPolytope& set) {
  Json json;
  json["dimension"] = set.dimension;
  json["half_spaces"] = set.rows.size();
  json["equalities"] = set.equalities.size();
  json["set"] = Json::parse(setText(set));
  return json;
}

std::string row(const RationalVector& values) {
  std::string text;
  char number[40];
  for (const Rational& value : values) {
    std::snprintf(number, sizeof number, "%s%.10g", text.empty() ? "" : "  ", nearestDouble(value));
    text += number;
  }
  return text;
}

// Rows scaled so that the greatest entry is 1.
void printRows(const std::vector<ExactHalfSpace>& rows, const char* relation) {
  for (const ExactHalfSpace& half_space : rows) {
    Rational greatest;
    for (const Rational& value : half_space.a) greatest = std::max(greatest, Rational(abs(value)));
    if (greatest == 0) greatest = 1;
    RationalVector a = half_space.a;
    for (Rational& value : a) value /= greatest;
    std::printf("  %s  %s  %.10g\n", row(a).c_str(), relation,
                nearestDouble(Rational(half_space.b / greatest)));
  }
}

void printRowsOf(const ExactPolytope& set) {
  std::printf("%zu half-spaces, %zu equalities in %d dimensions\n", set.rows.size(), set.equalities.size(),
              set.dimension);
  printRows(set.rows, "<=");
  printRows(set.equalities, "= ");
}

const char* name(InvariantSet::Status status) {
  switch (status) {
    case InvariantSet::Status::kMaximal:
      return "maximal";
    case InvariantSet::Status::kEmpty:
      return "empty";
    case InvariantSet::Status::kLimit:
      return "limit";
    case InvariantSet::Status::kInterrupted:
      return "interrupted";
  }
  return "unknown";
}

}  // namespace

RationalVector parseNumbers(const std::string& text) {
  RationalVector values;
  std::size_t start = 0;
  while (true) {
    const std::size_t comma = text.find(',', start);
    std::string word = text.substr(start, comma - start);
    word.erase(0, word.find_first_not_of(' '));
    word.erase(word.find_last_not_of(' ') + 1);
    values.emplace_back();
    if (!parseRational(word, values.back()))
      throw Error("'" + text + "': must be numbers separated by commas, got '" + word + "'");
    if (comma == std::string::npos) return values;
    start = comma + 1;
  }
}

RationalMatrix parseMatrix(const std::string& text) {
  std::vector<RationalVector> rows;
  std::size_t start = 0, semicolon = 0;
  while (semicolon != std::string::npos) {
    semicolon = text.find(';', start);
    rows.push_back(parseNumbers(text.substr(start, semicolon - start)));
    if (rows.back().size() != rows.front().size()) throw Error("'" + text + "': rows must have one length");
    start = semicolon + 1;
  }
  RationalMatrix matrix(static_cast<int>(rows.size()), static_cast<int>(rows[0].size()));
  for (int i = 0; i < matrix.rows(); ++i) {
    for (int j = 0; j < matrix.columns(); ++j)
      matrix(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  }
  return matrix;
}

void SetOutput::printAnswer(bool answer) const {
  if (json) {
    show({{"answer", answer}});
  } else {
    std::printf("%s\n", answer ? "yes" : "no");
  }
}

void SetOutput::printSet(const ExactPolytope& set) const {
  if (!file.empty()) writeText(file, setText(set));
  if (json) {
    show(setJson(set));
  } else {
    printRowsOf(set);
  }
}

void SetOutput::printInfo(const ExactPolytope& set) const {
  const ExactPolytope smallest = minimal(set);
  const Generators all = generators(smallest);
  const int dimension = affineDimension(smallest);
  const bool bounded = all.rays.empty() && all.lines.empty();
  Json info;
  info["dimension"] = set.dimension;
  info["affine_dimension"] = dimension;
  info["empty"] = dimension < 0;
  info["bounded"] = bounded;
  info["rows"] = set.rows.size() + set.equalities.size();
  info["facets"] = dimension < 0 ? 0 : smallest.rows.size();
  info["equalities"] = smallest.equalities.size();
  info["vertices"] = all.vertices.size();
  if (bounded && dimension >= 0) {
    const ExactBox box = boundingBox(smallest);
    info["lower"] = vectorJson(box.lower);
    info["upper"] = vectorJson(box.upper);
    info["volume"] = numberJson(volume(smallest));
    if (dimension == set.dimension) {
      const Ball ball = chebyshevBall(rounded(smallest));
      info["ball_radius"] = ball.radius;
      info["ball_centre"] = std::vector<double>(ball.centre.data(), ball.centre.data() + ball.centre.size());
    }
  }
  if (json) return show(info);
  std::printf("dimension   %d, of the set itself %d%s\n", set.dimension, dimension,
              dimension < 0 ? " (empty)" : "");
  std::printf("bounded     %s\nrows        %zu, needed: %zu facets, %zu equalities\nvertices    %zu\n",
              bounded ? "yes" : "no", set.rows.size() + set.equalities.size(),
              info["facets"].get<std::size_t>(), smallest.equalities.size(), all.vertices.size());
  if (!info.contains("volume")) return;
  const ExactBox box = boundingBox(smallest);
  std::printf("lower       %s\nupper       %s\n", row(box.lower).c_str(), row(box.upper).c_str());
  std::printf("volume      %.10g\n", info["volume"]["rounded"].get<double>());
  if (info.contains("ball_radius"))
    std::printf("ball        radius %.10g (floating point)\n", info["ball_radius"].get<double>());
}

void SetOutput::printGenerators(const Generators& all) const {
  const std::pair<const char*, const std::vector<RationalVector>*> lists[] = {
      {"vertices", &all.vertices}, {"rays", &all.rays}, {"lines", &all.lines}};
  Json result;
  for (const auto& [title, list] : lists) {
    result[title] = Json::array();
    for (const RationalVector& entry : *list) result[title].push_back(vectorJson(entry));
    if (json || (list->empty() && list != &all.vertices)) continue;
    std::printf("%zu %s\n", list->size(), title);
    for (const RationalVector& entry : *list) std::printf("  %s\n", row(entry).c_str());
  }
  if (json) show(result);
}

void SetOutput::printVolume(const Rational& volume) const {
  if (json) return show({{"volume", numberJson(volume)}});
  std::printf("%.17g\n", nearestDouble(volume));
  if (volume.get_den() != 1 && volume.get_str().size() <= 60) std::printf("= %s\n", volume.get_str().c_str());
}

void SetOutput::printVolume(double volume) const {
  if (json) return show({{"volume", {{"rounded", volume}}}});
  std::printf("%.17g\n", volume);
}

void SetOutput::printSupport(const ExactSupport& support) const {
  const char* status = support.status == ExactSupport::Status::kOptimal     ? "optimal"
                       : support.status == ExactSupport::Status::kUnbounded ? "unbounded"
                                                                            : "empty";
  const bool found = support.status == ExactSupport::Status::kOptimal;
  if (json) {
    Json result = {{"status", status}};
    if (found) {
      result["value"] = numberJson(support.value);
      result["point"] = vectorJson(support.point);
    }
    return show(result);
  }
  if (!found) {
    std::printf("%s\n", status);
  } else {
    std::printf("%.17g\nat  %s\n", nearestDouble(support.value), row(support.point).c_str());
  }
}

void SetOutput::printInvariant(const InvariantSet& result, const InvariantOptions& options,
                               bool proven) const {
  if (!file.empty() && result.status != InvariantSet::Status::kInterrupted)
    writeText(file, setText(result.set));
  if (json) {
    Json summary = {{"status", name(result.status)}, {"iterations", result.iterations}};
    summary["arithmetic"] = options.exact ? "exact" : "float";
    summary["tolerance"] = options.exact ? 0.0 : options.tolerance;
    summary["proven_invariant"] = proven;
    summary.update(setJson(result.set));
    return show(summary);
  }
  std::printf("%s after %d iterations, %s", name(result.status), result.iterations,
              options.exact ? "exact" : "floating point");
  if (!options.exact) std::printf(" with tolerance %.3g", options.tolerance);
  std::printf("; invariance %s\n", proven ? "proven" : "not proven");
  printRowsOf(result.set);
}

void SetOutput::printProof(const InvarianceProof& proof) const {
  if (json) {
    Json result = {{"invariant", proof.holds}};
    result["counterexample"] = proof.counterexample ? vectorJson(*proof.counterexample) : Json();
    return show(result);
  }
  std::printf("%s\n", proof.holds ? "invariant: proven" : "not invariant");
  if (proof.counterexample)
    std::printf("no input keeps this state in the set: %s\n", row(*proof.counterexample).c_str());
}

}  // namespace polyfly
