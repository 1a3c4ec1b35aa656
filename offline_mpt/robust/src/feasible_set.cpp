#include "robust_mpc/feasible_set.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "integer_program.hpp"
#include "polyfly_base/error.hpp"
#include "rational_parts.hpp"
#include "support/in_parallel.hpp"
#include "tolerances.hpp"

namespace polyfly {
namespace {

/// A point with room around it: max t s.t. all rows hold with a margin of t times their length, t <= 1.
Eigen::VectorXd interiorPoint(const RobustProgram& program) {
  const Eigen::Index ny = program.lawSize(), nz = program.prediction_count, n = nz + ny + 1;
  std::vector<ScenarioRow> rows;
  for (const RobustProgram::Row& from : program.rows) {
    ScenarioRow row = scenarioRow(from, n, 1, n);
    row.a.segment(nz, ny) = toDoubles(from.y);
    const double margin = row.a.norm();
    row.a[n - 1] = -margin;
    row.e[0] = nearestDouble(from.bound) - margin;
    rows.push_back(std::move(row));
  }
  ScenarioLp lp(static_cast<int>(n), 1, std::move(rows));
  const bool solved = lp.solve(Eigen::VectorXd::Ones(1)) == DualSimplex::Status::kOptimal;
  if (!solved || lp.objective() > 1.0 - tolerance::kLeastRoom)
    throw Error("robust program: no parameter in the box has a solution with room around it");
  return lp.x().segment(nz, ny);
}

/// How far y lies towards the edge: the least mu with y0 + (y - y0) / mu feasible. Predictions are scaled
/// with mu, so that only the right-hand side depends on y.
ScenarioLp gaugeProgram(const RobustProgram& program, const Eigen::VectorXd& centre) {
  const Eigen::Index ny = program.lawSize(), nz = program.prediction_count;
  std::vector<ScenarioRow> rows;
  for (const RobustProgram::Row& from : program.rows) {
    ScenarioRow row = scenarioRow(from, nz + 1, ny, nz);
    row.e = -toDoubles(from.y);
    row.a[nz] = -(nearestDouble(from.bound) + row.e.dot(centre));
    rows.push_back(std::move(row));
  }
  return ScenarioLp(static_cast<int>(nz) + 1, static_cast<int>(ny), std::move(rows));
}

class Projection {
 public:
  Projection(const RobustProgram& program, const ProjectOptions& options)
      : program_(program),
        options_(options),
        whole_(program),
        centre_(interiorPoint(program)),
        gauge_(gaugeProgram(program, centre_)),
        cone_(program.lawSize() + 1) {}

  FeasibleSet run() {
    start();
    for (bool cut_off = true; cut_off && !stopped();) {
      cut_off = cutInFloat() || (options_.exact && !stopped() && cutExactly());
      if (options_.save) options_.save(facets_);
    }
    result_.interrupted = stopped();
    result_.stats.pivots = gauge_.pivots();
    if (!result_.interrupted) collect();
    return std::move(result_);
  }

 private:
  bool stopped() const { return options_.stop != nullptr && options_.stop->load(); }

  bool isVertex(const DoubleDescription::Ray& ray) const { return ray.value[0] > 0; }

  void start() {
    std::vector<Integer> finite(at(program_.lawSize()) + 1);
    finite[0] = 1;
    cone_.add(finite);
    FeasibleSet::Facet at_infinity;  // keeps facet and row numbers alike
    facets_.push_back(std::move(at_infinity));
    for (std::size_t i = 0; i < program_.rows.size(); ++i) {
      if (program_.rows[i].hasPredictions()) continue;
      FeasibleSet::Facet facet = whole_.facetOf({Scenario{static_cast<int>(i), {}}}, {Rational(1)});
      facet.of_box = program_.rows[i].kind == RobustProgram::Kind::kBox;
      addFacet(std::move(facet));
    }
    for (const FeasibleSet::Facet& facet : options_.known) addFacet(facet);
  }

  /// Once it was stopped, the half-space is kept only to be saved.
  bool addFacet(FeasibleSet::Facet facet) {
    std::vector<Integer> row = coneRow(facet.half_space);
    if (!known_.insert(row).second) return false;
    if (!stopped()) cone_.add(row);
    facets_.push_back(std::move(facet));
    return true;
  }

  /// Tests vertices that were not tested yet; cuts off those that fail. False when none did.
  bool cutInFloat() {
    std::vector<FeasibleSet::Facet> cuts;
    for (const DoubleDescription::Ray& ray : cone_.rays()) {
      if (stopped()) break;
      if (!isVertex(ray) || tested_.count(ray.value) > 0) continue;
      std::optional<FeasibleSet::Facet> cut = testInFloat(ray.value);
      if (cut) cuts.push_back(std::move(*cut));
    }
    bool any = false;
    for (FeasibleSet::Facet& cut : cuts) any = addFacet(std::move(cut)) || any;
    if (options_.progress) options_.progress(facets_.size() - 1, cone_.rays().size(), cuts.size());
    return any;
  }

  std::optional<FeasibleSet::Facet> testInFloat(const HomogeneousPoint& point) {
    const RationalVector y = pointOf(point);
    ++result_.stats.linear_programs;
    const DualSimplex::Status status = gauge_.solve(toDoubles(y) - centre_);
    const std::vector<ScenarioLp::Tight> tight = gauge_.tight();
    if (status == DualSimplex::Status::kOptimal && gauge_.objective() > 1.0 + tolerance::kVertexOutside) {
      std::optional<FeasibleSet::Facet> facet = whole_.combine(support(tight));
      if (facet && dot(facet->half_space.a, y) > facet->half_space.b) return facet;
    }
    std::vector<Scenario> basis;
    for (const ScenarioLp::Tight& part : tight) basis.push_back(part.scenario);
    tested_.emplace(point, Tested{std::move(basis), false, {}});
    return std::nullopt;
  }

  static std::vector<Scenario> support(const std::vector<ScenarioLp::Tight>& tight) {
    double greatest = 0.0;
    for (const ScenarioLp::Tight& part : tight) greatest = std::max(greatest, part.multiplier);
    std::vector<Scenario> result;
    for (const ScenarioLp::Tight& part : tight) {
      if (part.multiplier > tolerance::kZeroMultiplier * greatest) result.push_back(part.scenario);
    }
    return result;
  }

  /// Proves every vertex that is left; cuts off those that are not feasible. False when all are.
  bool cutExactly() {
    std::vector<std::pair<const HomogeneousPoint*, Tested*>> open;
    for (const DoubleDescription::Ray& ray : cone_.rays()) {
      if (!isVertex(ray)) continue;
      const auto found = tested_.find(ray.value);
      if (!found->second.proven) open.emplace_back(&found->first, &found->second);
    }
    std::vector<std::optional<FeasibleSet::Facet>> cuts(open.size());
    std::vector<char> by_program(open.size(), 0);
    inParallel(open.size(), options_.threads, options_.stop, {}, [&](std::size_t, std::uint64_t k) {
      const HomogeneousPoint& y = *open[k].first;
      Tested& tested = *open[k].second;
      tested.prediction = whole_.predictionAt(y, tested.basis);
      if (!whole_.holds(y, tested.prediction)) {
        by_program[k] = 1;
        cuts[k] = exactCut(whole_, y, tested.basis, tested.prediction);
        if (cuts[k]) return;
      }
      tested.proven = true;
    });
    bool any = false;
    for (std::size_t k = 0; k < open.size(); ++k) {
      result_.stats.exact_programs += static_cast<std::uint64_t>(by_program[k]);
      if (!cuts[k] || !addFacet(std::move(*cuts[k]))) continue;
      ++result_.stats.exact_cuts;
      any = true;
    }
    if (options_.progress) options_.progress(facets_.size() - 1, cone_.rays().size(), 0);
    return any;
  }

  void collect() {
    result_.dimension = program_.lawSize();
    result_.proven = options_.exact;
    std::vector<TightSet> on(facets_.size());  // rays by facet, with those at infinity
    for (std::size_t r = 0; r < cone_.rays().size(); ++r) {
      for (std::size_t f = 1; f < facets_.size(); ++f) {
        if (cone_.rays()[r].tight.test(f)) on[f].set(r);
      }
    }
    std::vector<std::size_t> kept;
    for (std::size_t f = 1; f < facets_.size(); ++f) {
      bool redundant = false;
      for (std::size_t g = 1; g < facets_.size() && !redundant; ++g)
        redundant = g != f && on[g].contains(on[f]) && (!on[f].contains(on[g]) || g < f);
      if (!redundant) kept.push_back(f);
    }
    std::sort(kept.begin(), kept.end(), [&](std::size_t f, std::size_t g) {
      return std::pair(facets_[f].half_space.a, facets_[f].half_space.b) <
             std::pair(facets_[g].half_space.a, facets_[g].half_space.b);
    });
    for (std::size_t r = 0; r < cone_.rays().size(); ++r) {
      const DoubleDescription::Ray& ray = cone_.rays()[r];
      if (!isVertex(ray)) continue;
      FeasibleSet::Vertex vertex;
      vertex.y = pointOf(ray.value);
      for (std::size_t k = 0; k < kept.size(); ++k) {
        if (on[kept[k]].test(r)) vertex.facets.push_back(static_cast<int>(k));
      }
      const auto found = tested_.find(ray.value);
      if (found != tested_.end() && found->second.proven) {
        ++result_.stats.vertices_proven;
        std::vector<Integer> z{found->second.prediction.denominator * ray.value[0]};
        z.insert(z.end(), found->second.prediction.numerators.begin(),
                 found->second.prediction.numerators.end());
        vertex.prediction = pointOf(z);
      }
      result_.vertices.push_back(std::move(vertex));
    }
    std::sort(result_.vertices.begin(), result_.vertices.end(),
              [](const FeasibleSet::Vertex& a, const FeasibleSet::Vertex& b) { return a.y < b.y; });
    for (const std::size_t f : kept) result_.facets.push_back(std::move(facets_[f]));
  }

  struct Tested {
    std::vector<Scenario> basis;
    bool proven = false;
    // Numerators over the denominator times y[0].
    CommonFraction prediction{};
  };

  const RobustProgram& program_;
  const ProjectOptions& options_;
  IntegerProgram whole_;
  Eigen::VectorXd centre_;
  ScenarioLp gauge_;
  DoubleDescription cone_;
  // Facets in the order of the cone's rows.
  std::vector<FeasibleSet::Facet> facets_;
  std::set<std::vector<Integer>> known_;
  std::map<HomogeneousPoint, Tested> tested_;
  FeasibleSet result_;
};

}  // namespace

FeasibleSet projectFeasibleSet(const RobustProgram& program, const ProjectOptions& options) {
  return Projection(program, options).run();
}

bool proveFacets(const RobustProgram& program, const FeasibleSet& set) {
  const IntegerProgram whole(program);
  return std::all_of(set.facets.begin(), set.facets.end(), [&](const FeasibleSet::Facet& facet) {
    const std::optional<FeasibleSet::Facet> sum = whole.sumOf(facet.parts);
    return sum && sum->half_space.a == facet.half_space.a && sum->half_space.b == facet.half_space.b;
  });
}

bool proveVertices(const RobustProgram& program, const FeasibleSet& set) {
  const IntegerProgram whole(program);
  return std::all_of(set.vertices.begin(), set.vertices.end(), [&](const FeasibleSet::Vertex& vertex) {
    if (vertex.prediction.size() != at(program.prediction_count)) return false;
    RationalVector values = vertex.y;
    values.insert(values.end(), vertex.prediction.begin(), vertex.prediction.end());
    const std::vector<Integer> point = homogeneous(values);
    const auto z = point.begin() + program.lawSize() + 1;
    return whole.holds({point.begin(), z}, {{z, point.end()}, 1});
  });
}

}  // namespace polyfly
