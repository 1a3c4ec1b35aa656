#include "safety_filter/prove_filter.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "polyfly_base/error.hpp"
#include "polytope_sets/exact_polytope.hpp"
#include "safety_filter/uncertain_model.hpp"

namespace polyfly {
namespace {

Rational product(const Eigen::MatrixXd& matrix, Eigen::Index row, const RationalVector& x) {
  Rational sum = 0;
  for (std::size_t j = 0; j < x.size(); ++j)
    sum += Rational(matrix(row, static_cast<Eigen::Index>(j))) * x[j];
  return sum;
}

std::string pointText(const RationalVector& point) {
  std::string text = "(";
  for (std::size_t j = 0; j < point.size(); ++j)
    text += (j > 0 ? ", " : "") + std::to_string(point[j].get_d());
  return text + ")";
}

/// Rule 2.
bool proveInside(const UncertainModel& model, const std::vector<RationalVector>& vertices,
                 FilterProof& proof) {
  for (const RationalVector& vertex : vertices) {
    for (std::size_t i = 0; i < vertex.size(); ++i) {
      if (vertex[i] >= model.lower[i] && vertex[i] <= model.upper[i]) continue;
      proof.failure = "the vertex " + pointText(vertex) + " is outside of the ranges less their insets";
      proof.counterexample = vertex;
      return false;
    }
  }
  return true;
}

Rational greatestProduct(const Rational& factor, const Rational& lower, const Rational& upper) {
  return std::max<Rational>(factor * lower, factor * upper);
}

// Rule 3, of half-space `row`. Let the exact condition be p xi + q u <= r, and the row of doubles
// G u - M xi <= b. Then p xi + q u = (G u - M xi) + (p + M) xi + (q - G) u, which is at most b plus the greatest
// value of the last two terms.
bool staysBehind(const UncertainModel& model, const SafeSet& set, Eigen::Index row) {
  RationalVector h;
  for (Eigen::Index j = 0; j < set.H.cols(); ++j) h.emplace_back(set.H(row, j));
  const RationalVector p = applyTransposed(model.A, h), q = applyTransposed(model.B, h);
  Rational successor = Rational(set.b[row]) + dot(h, model.c);
  for (std::size_t j = 0; j < p.size(); ++j) {
    const Rational rest = p[j] + Rational(set.M(row, static_cast<Eigen::Index>(j)));
    successor +=
        greatestProduct(rest, model.lower[j], model.upper[j]) + abs(h[j]) * (model.W[j] + model.slack[j]);
  }
  for (std::size_t j = 0; j < q.size(); ++j) {
    const Rational rest = q[j] - Rational(set.G(row, static_cast<Eigen::Index>(j)));
    successor += greatestProduct(rest, model.u_lower[j], model.u_upper[j]);
  }
  return successor <= Rational(set.k[row]);
}

bool proveStays(const UncertainModel& model, const SafeSet& set, FilterProof& proof) {
  if (set.G.rows() != set.H.rows()) {
    proof.failure = "H has " + std::to_string(set.H.rows()) + " rows, G " + std::to_string(set.G.rows()) +
                    "; row i of G must keep row i of H";
    return false;
  }
  for (Eigen::Index row = 0; row < set.H.rows(); ++row) {
    if (staysBehind(model, set, row)) continue;
    proof.failure = "row " + std::to_string(row) + " of G, b, M does not keep row " + std::to_string(row) +
                    " of H, k in every case";
    return false;
  }
  return true;
}

/// Rule 4.
bool proveAnswered(const UncertainModel& model, const SafeSet& set,
                   const std::vector<RationalVector>& vertices, FilterProof& proof) {
  for (const RationalVector& vertex : vertices) {
    ExactPolytope inputs = ExactPolytope::box(model.u_lower, model.u_upper);
    for (Eigen::Index row = 0; row < set.G.rows(); ++row) {
      ExactHalfSpace half_space{{}, Rational(set.b[row]) + product(set.M, row, vertex)};
      for (Eigen::Index j = 0; j < set.G.cols(); ++j) half_space.a.emplace_back(set.G(row, j));
      inputs.rows.push_back(std::move(half_space));
    }
    if (!generators(inputs).vertices.empty()) continue;
    proof.failure = "no input is admissible at the vertex " + pointText(vertex);
    proof.counterexample = vertex;
    return false;
  }
  return true;
}

}  // namespace

ExactPolytope exactSet(const SafeSet& set) {
  ExactPolytope result;
  result.dimension = static_cast<int>(set.H.cols());
  for (Eigen::Index i = 0; i < set.H.rows(); ++i) {
    ExactHalfSpace row{{}, Rational(set.k[i])};
    for (Eigen::Index j = 0; j < set.H.cols(); ++j) row.a.emplace_back(set.H(i, j));
    result.rows.push_back(std::move(row));
  }
  return result;
}

FilterProof proveFilter(const SafetyFilterProblem& problem) {
  if (!problem.safe_set) throw Error(problem.source + ": safe_set: missing");
  const SafeSet& set = *problem.safe_set;
  const UncertainModel model = uncertainModel(problem);
  FilterProof proof;
  proof.facets = static_cast<std::size_t>(set.H.rows());
  const ExactPolytope exact = exactSet(set);
  const Generators corners = generators(exact);
  proof.vertices = corners.vertices.size();
  proof.bounded = proof.vertices > 0 && corners.rays.empty() && corners.lines.empty();
  if (!proof.bounded) {
    proof.failure = proof.vertices == 0 ? "the set is empty" : "the set is unbounded";
    return proof;
  }
  proof.inside = proveInside(model, corners.vertices, proof);
  proof.stays = proof.inside && proveStays(model, set, proof);
  proof.answered = proof.stays && proveAnswered(model, set, corners.vertices, proof);
  return proof;
}

std::string filterProofText(const SafetyFilterProblem& problem, const FilterProof& proof) {
  if (!proof.holds()) return "safe set: NOT PROVEN: " + proof.failure + "\n";
  const UncertainModel model = uncertainModel(problem);
  std::string text = "safe set: PROVEN in fractions\n  " + std::to_string(proof.facets) + " facets, " +
                     std::to_string(proof.vertices) +
                     " vertices; an input is admissible at each, so in all of the set\n  every admissible "
                     "input leads into the set, for all disturbances and errors\n  between samples, less "
                     "than:";
  for (int i = 0; i < problem.stateCount(); ++i) {
    const Signal& state = problem.states[static_cast<std::size_t>(i)];
    char number[32];
    std::snprintf(number, sizeof number, "%.3g", model.excursion[static_cast<std::size_t>(i)].get_d());
    text += std::string(i > 0 ? ", " : " ") + state.name + " " + number + " " + state.unit;
  }
  return text + " beyond the line from sample to sample, which the ranges allow\n";
}

std::string filterProofJson(const SafetyFilterProblem& problem, const FilterProof& proof,
                            const FilterAnswers& answers) {
  const UncertainModel model = uncertainModel(problem);
  nlohmann::ordered_json json;
  json["result"] = proof.holds() ? "PROVEN" : "NOT PROVEN";
  json["bounded"] = proof.bounded;
  json["inside_ranges"] = proof.inside;
  json["stays"] = proof.stays;
  json["answered"] = proof.answered;
  json["facets"] = proof.facets;
  json["vertices"] = proof.vertices;
  if (!proof.failure.empty()) json["failure"] = proof.failure;
  const std::vector<Signal> states = problem.augmentedStates();
  for (std::size_t i = 0; i < states.size(); ++i) {
    json["states"].push_back({{"name", states[i].name},
                              {"unit", states[i].unit},
                              {"uncertainty", model.W[i].get_d()},
                              {"excursion", model.excursion[i].get_d()}});
  }
  json["passes_wishes"] = answers.passes_wishes;
  json["answers_within_margin"] = answers.within_slack;
  json["part_of_margin"] = answers.used;
  return json.dump();
}

}  // namespace polyfly
