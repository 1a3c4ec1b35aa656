#include "polytope_sets/invariant_set.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cone.hpp"
#include "polyfly_base/error.hpp"
#include "polytope_sets/polytope.hpp"

namespace polyfly {
namespace {

/// Adds the rows of a set of coordinates from `first` on.
void place(const ExactPolytope& set, int first, ExactPolytope& to) {
  const auto lift = [&](const std::vector<ExactHalfSpace>& rows, std::vector<ExactHalfSpace>& wider) {
    for (const ExactHalfSpace& row : rows) {
      wider.push_back({RationalVector(static_cast<std::size_t>(to.dimension)), row.b});
      std::copy(row.a.begin(), row.a.end(), wider.back().a.begin() + first);
    }
  };
  lift(set.rows, to.rows);
  lift(set.equalities, to.equalities);
}

/// (x, u) with u in U and A x + B u + c in S, whatever d does; x not yet bound to S.
ExactPolytope pairsInto(const SetModel& model, const ExactPolytope& set,
                        const std::vector<RationalVector>& corners) {
  const int nx = model.stateCount(), nu = model.inputCount();
  RationalMatrix M(nx, nx + nu);
  M << model.A, model.B;
  ExactPolytope shrunk = set;
  for (ExactHalfSpace& row : shrunk.rows) {
    const RationalVector direction = applyTransposed(model.E, row.a);
    Rational greatest = dot(direction, corners[0]);
    for (const RationalVector& corner : corners) greatest = std::max(greatest, dot(direction, corner));
    row.b -= greatest;
  }
  ExactPolytope pairs = preimage(shrunk, M, model.c);
  place(model.U, nx, pairs);
  return pairs;
}

// Equalities as pairs of rows, so that disturbances can only empty the set.
ExactPolytope asRows(ExactPolytope set) {
  for (const ExactHalfSpace& row : set.equalities) {
    set.rows.push_back(row);
    ExactHalfSpace other{row.a, Rational(-row.b)};
    for (Rational& value : other.a) value = -value;
    set.rows.push_back(std::move(other));
  }
  set.equalities.clear();
  return set;
}

std::vector<int> firstOnes(int count) {
  std::vector<int> result;
  for (int j = 0; j < count; ++j) result.push_back(j);
  return result;
}

void checkModel(const SetModel& model) {
  if (!model.parameters.empty())
    throw Error("invariant set: model " + model.name + ": parameters: only states can be there");
  if (!isBounded(model.X)) throw Error("invariant set: model " + model.name + ": X: must be bounded");
  if (!isBounded(model.U)) throw Error("invariant set: model " + model.name + ": U: must be bounded");
}

InvariantSet exactRecursion(const SetModel& model, const InvariantOptions& options) {
  InvariantSet result;
  result.set = minimal(model.X);
  while (result.iterations < options.max_iterations) {
    ExactPolytope next = predecessor(model, result.set);
    ++result.iterations;
    if (affineDimension(next) < 0) {
      result.status = InvariantSet::Status::kEmpty;
      result.set = std::move(next);
      return result;
    }
    // Pre(C) lies in C: they are equal when C lies in Pre(C).
    const bool same = contains(next, result.set);
    result.set = std::move(next);
    if (!same) continue;
    result.status = InvariantSet::Status::kMaximal;
    return result;
  }
  return result;
}

/// One step in floating point. False when nothing with interior is left.
bool floatStep(const SetModel& model, const std::vector<RationalVector>& corners, double tolerance,
               Polytope& set, bool& same) {
  ExactPolytope pairs = pairsInto(model, exactly(set), corners);
  place(exactly(set), 0, pairs);
  Polytope next = rounded(pairs);
  if (chebyshevBall(next).radius <= tolerance) return false;
  for (int j = next.dimension() - 1; j >= set.dimension(); --j) next = eliminate(next, j, tolerance);
  next = minimal(next, tolerance);
  const Ball ball = chebyshevBall(set);
  same = true;
  for (int i = 0; i < next.rowCount() && same; ++i)
    same = support(set, ball.centre, next.A.row(i).transpose()) <= next.b[i] + tolerance;
  set = std::move(next);
  return true;
}

InvariantSet floatRecursion(const SetModel& model, const InvariantOptions& options) {
  InvariantSet result;
  const std::vector<RationalVector> corners = vertices(model.D);
  Polytope set = rounded(model.X);
  const auto finish = [&](InvariantSet::Status status) {
    result.status = status;
    result.set = status == InvariantSet::Status::kEmpty
                     ? hull(model.stateCount(), std::vector<RationalVector>())
                     : exactly(set);
    return result;
  };
  if (chebyshevBall(set).radius <= options.tolerance) return finish(InvariantSet::Status::kEmpty);
  while (result.iterations < options.max_iterations) {
    bool same = false;
    ++result.iterations;
    if (!floatStep(model, corners, options.tolerance, set, same)) return finish(InvariantSet::Status::kEmpty);
    if (same) return finish(InvariantSet::Status::kMaximal);
  }
  return finish(InvariantSet::Status::kLimit);
}

}  // namespace

ExactPolytope predecessor(const SetModel& model, const ExactPolytope& set) {
  requireDimension(set, static_cast<std::size_t>(model.stateCount()), "predecessor");
  const ExactPolytope target = asRows(set);
  ExactPolytope pairs = pairsInto(model, target, vertices(model.D));
  place(model.X, 0, pairs);
  place(target, 0, pairs);
  return project(pairs, firstOnes(model.stateCount()));
}

InvariantSet maximalInvariantSet(const SetModel& model, const InvariantOptions& options) {
  checkModel(model);
  if (options.max_iterations < 1) throw Error("invariant set: max_iterations: must be at least 1");
  if (!options.exact && !(options.tolerance > 0.0)) throw Error("invariant set: tolerance: must be above 0");
  return options.exact ? exactRecursion(model, options) : floatRecursion(model, options);
}

InvarianceProof proveInvariant(const SetModel& model, const ExactPolytope& set) {
  InvarianceProof proof;
  const ExactPolytope target = asRows(set);
  const ExactPolytope pairs = pairsInto(model, target, vertices(model.D));
  for (const RationalVector& vertex : vertices(set)) {
    // Inputs that keep this vertex in the set.
    ExactPolytope inputs;
    inputs.dimension = model.inputCount();
    const auto fix = [&](const std::vector<ExactHalfSpace>& from, std::vector<ExactHalfSpace>& to) {
      for (const ExactHalfSpace& row : from) {
        ExactHalfSpace rest{RationalVector(row.a.begin() + model.stateCount(), row.a.end()), row.b};
        for (std::size_t j = 0; j < vertex.size(); ++j) rest.b -= row.a[j] * vertex[j];
        to.push_back(std::move(rest));
      }
    };
    fix(pairs.rows, inputs.rows);
    fix(pairs.equalities, inputs.equalities);
    const bool found = generators(inputs).vertices.empty() == false;
    if (found && contains(model.X, vertex)) continue;
    proof.counterexample = vertex;
    return proof;
  }
  proof.holds = true;
  return proof;
}

}  // namespace polyfly
