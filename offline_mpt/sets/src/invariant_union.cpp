#include <algorithm>
#include <utility>

#include "polyfly_base/error.hpp"
#include "polytope_sets/invariant_set.hpp"

namespace polyfly {
namespace {

struct Part {
  std::size_t mode;
  ExactPolytope set;
};

ExactHalfSpace negated(const ExactHalfSpace& row) {
  ExactHalfSpace result{row.a, Rational(-row.b)};
  for (Rational& value : result.a) value = -value;
  return result;
}

/// x of a part from which some d leads into `target`.
ExactPolytope sourcesOf(const ExactPolytope& target, const Part& part, const AffineMode& mode,
                        const RationalMatrix& E, const ExactPolytope& D) {
  const int nx = mode.A.rows(), nd = E.columns();
  RationalMatrix M(nx, nx + nd);
  for (int i = 0; i < nx; ++i) {
    for (int j = 0; j < nx; ++j) M(i, j) = mode.A(i, j);
    for (int j = 0; j < nd; ++j) M(i, nx + j) = E(i, j);
  }
  ExactPolytope pairs = preimage(target, M, mode.c);
  const auto lift = [&](const std::vector<ExactHalfSpace>& from, std::vector<ExactHalfSpace>& to, int first) {
    for (const ExactHalfSpace& row : from) {
      ExactHalfSpace wide{RationalVector(static_cast<std::size_t>(nx + nd)), row.b};
      std::copy(row.a.begin(), row.a.end(), wide.a.begin() + first);
      to.push_back(std::move(wide));
    }
  };
  lift(part.set.rows, pairs.rows, 0);
  lift(part.set.equalities, pairs.equalities, 0);
  lift(D.rows, pairs.rows, nx);
  lift(D.equalities, pairs.equalities, nx);
  std::vector<int> states;
  for (int j = 0; j < nx; ++j) states.push_back(j);
  return project(pairs, states, ProjectionMethod::kElimination);
}

}  // namespace

InvariantUnion maximalInvariantUnion(const std::vector<AffineMode>& modes, const ExactPolytope& domain,
                                     const RationalMatrix& E, const ExactPolytope& D,
                                     const UnionOptions& options) {
  InvariantUnion result;
  std::vector<Part> parts;
  for (std::size_t k = 0; k < modes.size(); ++k) {
    if (!isBounded(modes[k].region)) throw Error("invariant set: regions: must be bounded");
    if (affineDimension(modes[k].region) == domain.dimension) parts.push_back({k, minimal(modes[k].region)});
  }
  // Polytopes that were removed last. At first, the outside of the domain.
  std::vector<ExactPolytope> forbidden;
  for (const ExactHalfSpace& row : minimal(domain).rows) {
    ExactPolytope outside;
    outside.dimension = domain.dimension;
    outside.rows.push_back(negated(row));
    forbidden.push_back(std::move(outside));
  }
  while (!forbidden.empty() && !parts.empty()) {
    const bool interrupted = options.stop != nullptr && options.stop->load();
    if (interrupted) result.status = InvariantSet::Status::kInterrupted;
    if (interrupted || result.iterations == options.max_iterations || parts.size() > options.max_parts) break;
    ++result.iterations;
    std::vector<ExactPolytope> removed;
    for (const ExactPolytope& target : forbidden) {
      std::vector<Part> left;
      for (Part& part : parts) {
        ExactPolytope sources = sourcesOf(target, part, modes[part.mode], E, D);
        if (affineDimension(sources) < domain.dimension) {
          left.push_back(std::move(part));
          continue;
        }
        for (ExactPolytope& rest : subtract(part.set, sources)) left.push_back({part.mode, std::move(rest)});
        removed.push_back(std::move(sources));
      }
      parts = std::move(left);
    }
    forbidden = std::move(removed);
  }
  if (forbidden.empty()) result.status = InvariantSet::Status::kMaximal;
  if (parts.empty()) result.status = InvariantSet::Status::kEmpty;
  for (Part& part : parts) result.parts.push_back(std::move(part.set));
  return result;
}

}  // namespace polyfly
