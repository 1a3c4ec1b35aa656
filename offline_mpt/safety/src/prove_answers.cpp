#include <algorithm>
#include <utility>

#include "polytope_sets/analyze_map.hpp"
#include "region_maps/region_map.hpp"
#include "safety_filter/prove_filter.hpp"
#include "safety_filter/uncertain_model.hpp"
#include "tolerances.hpp"

namespace polyfly {
namespace {

// A look-up may break half-spaces of the region that answers by this many tolerances of its map: what
// `certify` proves (offline_mpt/CERTIFICATE.md).
constexpr int kLookupTolerances = 8;

bool passesWishes(const RegionMap& map, std::size_t n, std::size_t nu) {
  bool found = false;
  const std::size_t columns = n + nu + 1;
  for (std::size_t i = 0; i < map.regionCount(); ++i) {
    const RegionView region = map.region(i);
    if (region.active_count > 0) continue;
    found = true;
    const double* law = map.law(region.law);
    for (std::size_t row = 0; row < nu; ++row) {
      for (std::size_t j = 0; j < columns; ++j) {
        if (law[row * columns + j] != (j == n + row ? 1.0 : 0.0)) return false;
      }
    }
  }
  return found;
}

/// Parameters of S and the map's box at which a look-up may answer with this region.
ExactPolytope reach(const RegionMap& map, const ExactPolytope& set, std::size_t index) {
  ExactPolytope result = regionPolytope(map, index, kLookupTolerances * Rational(map.tolerance()));
  for (ExactHalfSpace row : set.rows) {
    row.a.resize(map.parameters().size());
    result.rows.push_back(std::move(row));
  }
  return result;
}

/// The answer of a law, with the greatest error of its rounding.
struct Answer {
  RationalVector u;
  RationalVector error;
};

Answer answerOf(const double* law, std::size_t nu, const RationalVector& theta) {
  Answer answer;
  const std::size_t columns = theta.size() + 1;
  for (std::size_t i = 0; i < nu; ++i) {
    const double* row = law + i * columns;
    Rational sum(row[theta.size()]), size = abs(sum);
    for (std::size_t j = 0; j < theta.size(); ++j) {
      const Rational term = Rational(row[j]) * theta[j];
      sum += term;
      size += abs(term);
    }
    answer.u.push_back(sum);
    answer.error.push_back(size * Rational(tolerance::kSumRounding) *
                           static_cast<unsigned long>(columns + 2));
  }
  return answer;
}

/// What limiting entry j of an answer to the range of the input may change.
Rational beyondRange(const UncertainModel& model, const Answer& answer, std::size_t j) {
  const Rational above = answer.u[j] + answer.error[j] - model.u_upper[j];
  const Rational under = model.u_lower[j] - answer.u[j] + answer.error[j];
  return std::max<Rational>(0, std::max(above, under));
}

/// The greatest part of the slack that an answer at theta needs: its excess over a row, divided by what the
/// slack is worth in this row. A convex function of theta: the greatest value is at a vertex.
Rational neededPart(const UncertainModel& model, const SafeSet& set, const RationalVector& theta,
                    const Answer& answer) {
  Rational part = 0;
  for (Eigen::Index i = 0; i < set.G.rows(); ++i) {
    // A row without the input holds in all of S.
    if (set.G.row(i).isZero(0.0)) continue;
    Rational excess(-set.b[i]), worth = 0;
    for (std::size_t j = 0; j < answer.u.size(); ++j) {
      const Rational entry(set.G(i, static_cast<Eigen::Index>(j)));
      excess += entry * answer.u[j] + abs(entry) * (answer.error[j] + beyondRange(model, answer, j));
    }
    for (std::size_t j = 0; j < model.slack.size(); ++j) {
      excess -= Rational(set.M(i, static_cast<Eigen::Index>(j))) * theta[j];
      worth += abs(Rational(set.H(i, static_cast<Eigen::Index>(j)))) * model.slack[j];
    }
    if (excess > 0) part = std::max<Rational>(part, excess / worth);
  }
  return part;
}

}  // namespace

FilterAnswers proveAnswers(const RegionMap& map, const SafetyFilterProblem& problem) {
  FilterAnswers answers;
  const auto n = static_cast<std::size_t>(problem.augmentedCount());
  const std::size_t nu = problem.inputs.size();
  answers.passes_wishes = passesWishes(map, n, nu);
  const ExactPolytope set = exactSet(*problem.safe_set);
  const UncertainModel model = uncertainModel(problem);
  Rational part = 0;
  for (std::size_t i = 0; i < map.regionCount(); ++i) {
    for (const RationalVector& theta : vertices(reach(map, set, i)))
      part = std::max(
          part, neededPart(model, *problem.safe_set, theta, answerOf(map.law(map.region(i).law), nu, theta)));
  }
  answers.used = part.get_d();
  answers.within_slack = part <= 1;
  return answers;
}

}  // namespace polyfly
