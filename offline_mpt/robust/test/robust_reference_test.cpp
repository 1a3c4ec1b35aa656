// The exact reference laws that are not part of the project: tau and the first move at all their vertices,
// and at random states.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../../test/map_in_memory.hpp"
#include "../../test/random.hpp"
#include "../../test/reference_problems.hpp"
#include "offline_mpt/encode.hpp"
#include "robust_mpc/online_lp.hpp"
#include "robust_mpc/robust_law.hpp"

namespace polyfly {
namespace {

using nlohmann::json;

constexpr double kSame = 1e-9;

std::filesystem::path folder() {
  const std::filesystem::path problems = referenceProblems();
  return problems.empty() ? problems : problems.parent_path() / "rmpc";
}

Rational number(const json& text) { return Rational(text.get<std::string>()); }

std::string row(const std::vector<std::string>& entries) {
  std::string text = "[";
  for (const std::string& entry : entries) text += (text.size() > 1 ? ", \"" : "\"") + entry + "\"";
  return text + "]";
}

std::string matrix(const json& numerators, const std::string& denominator) {
  std::string text = "[";
  for (const json& line : numerators) {
    std::vector<std::string> entries;
    for (const json& entry : line) entries.push_back(std::to_string(entry.get<long>()) + "/" + denominator);
    text += (text.size() > 1 ? ", " : "") + row(entries);
  }
  return text + "]";
}

/// The problem of a reference law, with its rational model and gain.
RobustProblem problemOf(const json& program, const json& law) {
  static const char* const kNames[] = {"p", "v", "phi", "rate"};
  const int states = law["ns"].get<int>();
  const std::string denominator = std::to_string(program["model"]["rational_den"].get<long>());
  std::string text =
      "polyfly_problem: 1\nname: reference\ntype: robust_mpc\nmodel:\n  time: discrete\n  states: [";
  for (int i = 0; i < states; ++i) {
    text += std::string(i > 0 ? ", " : "") + "{name: " + kNames[i] + ", unit: m";
    if (i == 1) text += ", range: [-1.5, 1.5]";
    if (i == 2) text += ", range: [-0.35, 0.35]";
    text += "}";
  }
  text += "]\n  inputs: [{name: u, unit: rad, range: [-0.35, 0.35]}]\n";
  text += "  disturbances: [{name: w, unit: m/s^2, range: [-1, 1]}]\n";
  for (const char* name : {"A", "B", "G"})
    text += std::string("  ") + name + ": " +
            matrix(program["model"][std::string(name) + "_num"], denominator) + "\n";
  text += std::string("  C: [[1") + (states == 4 ? ", 0, 0, 0]]" : ", 0, 0]]") +
          "\nsampling_time: 0.08\nhorizon: " + std::to_string(law["N"].get<int>()) +
          "\nstack: " + law["stack"].get<std::string>() + "\npeak_in_map: true\ntie_break: {gain: [" +
          row(law["K"].get<std::vector<std::string>>()) + "]}\nparameters:\n";
  for (int i = 0; i < states; ++i) {
    const std::string half =
        std::to_string(program["explore_box"][static_cast<std::size_t>(i)].get<double>());
    text += std::string("  - {name: e_") + kNames[i] + ", role: error, of: " + kNames[i] +
            ", unit: m, range: [-" + half + ", " + half + "]}\n";
  }
  return parseRobustProblem(text, "reference.yaml");
}

struct Reference {
  const char* name;
  std::size_t regions;
};

class RobustReference : public ::testing::TestWithParam<Reference> {
 protected:
  void SetUp() override {
    if (folder().empty() || !std::filesystem::is_directory(folder()))
      GTEST_SKIP() << "the reference data are absent: set POLYFLY_DATA";
    const std::string name = GetParam().name;
    law_ = readJson(folder() / ("exact_law_" + name + ".json"));
    problem_ = problemOf(readJson(folder() / ("rmpc_" + name + ".json")), law_);
    const RobustProgram program = buildRobustProgram(problem_);
    set_ = projectFeasibleSet(program);
    mine_ = explicitLaw(problem_, set_);
  }

  json law_;
  RobustProblem problem_;
  FeasibleSet set_;
  RobustLaw mine_;
};

RationalVector vectorOf(const json& texts) {
  RationalVector result;
  for (const json& text : texts) result.push_back(number(text));
  return result;
}

TEST_P(RobustReference, HasTheSameRegionsAndTheSameLawExactly) {
  EXPECT_EQ(mine_.regions.size(), GetParam().regions);
  ASSERT_EQ(law_["regions"].size(), mine_.regions.size());
  // by a region's vertices, which do not depend on the numbering of facets
  std::map<std::vector<RationalVector>, const RobustLaw::Region*> by_vertices;
  for (const RobustLaw::Region& region : mine_.regions) by_vertices[region.vertices] = &region;
  for (const json& reference : law_["regions"]) {
    std::vector<RationalVector> vertices;
    for (const json& vertex : reference["vertices"]) vertices.push_back(vectorOf(vertex));
    std::sort(vertices.begin(), vertices.end());
    const auto found = by_vertices.find(vertices);
    ASSERT_NE(found, by_vertices.end());
    EXPECT_EQ(found->second->input_gain, vectorOf(reference["F"]));
    EXPECT_EQ(found->second->input_offset, number(reference["Z"]));
    EXPECT_EQ(found->second->peak_gain, vectorOf(reference["tauF"]));
    EXPECT_EQ(found->second->peak_offset, number(reference["tauZ"]));
  }
}

/// The reference in doubles: its region is the one that is violated least.
class RoundedReference {
 public:
  explicit RoundedReference(const json& law) {
    for (const json& region : law["regions"]) {
      ConvexCell piece;
      for (const json& half_space : region["H"]) piece.H.push_back(rounded(half_space, true));
      for (const char* gain : {"F", "tauF"}) piece.laws.push_back(rounded(region[gain], false));
      piece.offsets = {number(region["Z"]).get_d(), number(region["tauZ"]).get_d()};
      pieces_.push_back(std::move(piece));
    }
  }

  /// Greatest violation at theta (below 0: inside), and the law there.
  double evaluate(const std::vector<double>& theta, double* output) const {
    double least = INFINITY;
    for (const ConvexCell& piece : pieces_) {
      double violation = -INFINITY;
      for (const std::vector<double>& row : piece.H)
        violation = std::max(violation, dotWith(row, theta) - row.back());
      if (violation >= least) continue;
      least = violation;
      for (std::size_t k = 0; k < 2; ++k) output[k] = dotWith(piece.laws[k], theta) + piece.offsets[k];
    }
    return least;
  }

 private:
  struct ConvexCell {
    std::vector<std::vector<double>> H;
    std::vector<std::vector<double>> laws;
    std::vector<double> offsets;
  };

  static double dotWith(const std::vector<double>& row, const std::vector<double>& theta) {
    double sum = 0.0;
    for (std::size_t j = 0; j < theta.size(); ++j) sum += row[j] * theta[j];
    return sum;
  }

  // half-spaces are scaled to a greatest entry of 1 first: their whole numbers exceed a double's range
  static std::vector<double> rounded(const json& texts, bool scaled) {
    RationalVector exact = vectorOf(texts);
    Rational greatest = 1;
    if (scaled) {
      greatest = 0;
      for (std::size_t j = 0; j + 1 < exact.size(); ++j)
        greatest = std::max(greatest, Rational(abs(exact[j])));
    }
    std::vector<double> result;
    for (const Rational& value : exact) result.push_back(nearestDouble(value / greatest));
    return result;
  }

  std::vector<ConvexCell> pieces_;
};

TEST_P(RobustReference, MapIsWithinANanoradianAtVerticesAndRandomStates) {
  const RoundedLaw rounded = roundLaw(problem_, mine_, ExploreStatus::kComplete);
  const MapInMemory memory(encode(rounded.program, rounded.partition));
  double output[2], expected[2];
  for (const json& region : law_["regions"]) {
    for (const json& vertex : region["vertices"]) {
      const RationalVector exact = vectorOf(vertex);
      std::vector<double> theta;
      for (const Rational& value : exact) theta.push_back(nearestDouble(value));
      ASSERT_EQ(memory.map().evaluate(theta.data(), output).status, LookupStatus::kInside);
      const Rational u = dot(vectorOf(region["F"]), exact) + number(region["Z"]);
      const Rational tau = dot(vectorOf(region["tauF"]), exact) + number(region["tauZ"]);
      ASSERT_NEAR(output[0], u.get_d(), kSame);
      ASSERT_NEAR(output[1], tau.get_d(), kSame);
    }
  }
  const RoundedReference reference(law_);
  Random random(7);
  int inside = 0;
  for (int k = 0; k < 10000; ++k) {
    std::vector<double> theta;
    for (const RobustProblem::Parameter& parameter : problem_.parameters)
      theta.push_back(random.uniform(parameter.signal.lower, parameter.signal.upper));
    const bool feasible = reference.evaluate(theta, expected) <= 1e-13;
    const Lookup found = memory.map().evaluate(theta.data(), output);
    ASSERT_EQ(found.status == LookupStatus::kInside, feasible);
    if (!feasible) continue;
    ++inside;
    ASSERT_NEAR(output[0], expected[0], kSame);
    ASSERT_NEAR(output[1], expected[1], kSame);
  }
  EXPECT_GT(inside, 5000);
}

std::string decimals(const json& matrix) {
  std::string text = "[";
  for (const json& line : matrix) text += (text.size() > 1 ? ", " : "") + line.dump();
  return text + "]";
}

// References as parameters: the projected set of the reference data, in floating point, facet by facet.
TEST(RobustReferences, FeasibleSetIsThatOfTheData) {
  if (folder().empty() || !std::filesystem::is_directory(folder()))
    GTEST_SKIP() << "the reference data are absent: set POLYFLY_DATA";
  const json model = readJson(folder() / "rmpc_3d_paper_N6.json")["model"];
  const json data = readJson(folder() / "rmpc_3d_paper_N6_vref_phiref.json");
  const std::string text =
      "polyfly_problem: 1\nname: references\ntype: robust_mpc\nmodel:\n  time: discrete\n"
      "  states: [{name: p, unit: m}, {name: v, unit: m/s, range: [-1.5, 1.5]}, {name: phi, unit: rad, "
      "range: "
      "[-0.35, 0.35]}]\n  inputs: [{name: u, unit: rad, range: [-0.35, 0.35]}]\n"
      "  disturbances: [{name: w, unit: m/s^2, range: [-1, 1]}]\n  A: " +
      decimals(model["A"]) + "\n  B: " + decimals(model["B"]) + "\n  G: " + decimals(model["G"]) +
      "\n  C: [[1, 0, 0]]\nsampling_time: 0.08\nhorizon: 6\ntie_break: {Q: [40, 20, 10], R: "
      "[35]}\nparameters:\n"
      "  - {name: e_p, role: error, of: p, unit: m, range: [-1.5, 1.5]}\n"
      "  - {name: e_v, role: error, of: v, unit: m/s, range: [-2.3, 2.3]}\n"
      "  - {name: e_phi, role: error, of: phi, unit: rad, range: [-0.5, 0.5]}\n"
      "  - {name: v_ref, role: reference, unit: m/s, range: [-0.8, 0.8], state: [0, 1, 0], input: [0]}\n"
      "  - {name: phi_ref, role: reference, unit: rad, range: [-0.15, 0.15], state: [0, 0, 1], input: "
      "[\"10/9\"]}\n";
  const FeasibleSet set = projectFeasibleSet(buildRobustProgram(parseRobustProblem(text, "references.yaml")));
  // the data leave out the bounds on the present state, which Eq. 10 has: the set is theirs, cut by those
  std::vector<std::vector<double>> known;
  for (std::size_t k = 0; k < data["a"].size(); ++k) {
    known.push_back(data["a"][k].get<std::vector<double>>());
    known.back().push_back(data["b"][k].get<double>());
  }
  const double half = std::sqrt(0.5);
  for (const double sign : {1.0, -1.0}) {
    known.push_back({0.0, sign * half, 0.0, sign * half, 0.0, 0.0, 0.0, 1.5 * half});
    known.push_back({0.0, 0.0, sign * half, 0.0, sign * half, 0.0, 0.0, 0.35 * half});
  }
  std::vector<char> met(known.size(), 0);
  for (const FeasibleSet::Facet& facet : set.facets) {
    double length = 0.0;
    for (const Rational& entry : facet.half_space.a) length = std::hypot(length, entry.get_d());
    double least = INFINITY;
    std::size_t nearest = 0;
    for (std::size_t k = 0; k < known.size(); ++k) {
      double difference = std::abs(facet.half_space.b.get_d() / length - known[k].back());
      for (std::size_t j = 0; j + 1 < known[k].size(); ++j)
        difference = std::max(difference, std::abs(facet.half_space.a[j].get_d() / length - known[k][j]));
      if (difference >= least) continue;
      least = difference;
      nearest = k;
    }
    // The linear programs that projected the data had this tolerance.
    EXPECT_LT(least, 1e-7);
    met[nearest] = 1;
  }
  for (std::size_t k = 0; k < known.size(); ++k) {
    // Upper bounds of tau are left out, since the data end at some tau.
    if (met[k] != 0 || known[k][6] == 1.0) continue;
    double greatest = -INFINITY;
    for (const FeasibleSet::Vertex& vertex : set.vertices) {
      double value = -known[k].back();
      for (std::size_t j = 0; j < vertex.y.size(); ++j) value += known[k][j] * vertex.y[j].get_d();
      greatest = std::max(greatest, value);
    }
    // The half-space is redundant.
    EXPECT_LT(greatest, 1e-7) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(ExactLaws, RobustReference,
                         ::testing::Values(Reference{"3d_paper_N3", 25}, Reference{"3d_paper_N6", 93},
                                           Reference{"3d_shift_N6", 126}, Reference{"4d_paper_N6", 141}),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace polyfly
