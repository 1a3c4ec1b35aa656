// Answers of a safety filter's map keep the state in the safe set.
#include <algorithm>
#include <cstdlib>

#include "core/lookups.hpp"
#include "problem/filter_match.hpp"
#include "problem/filter_model.hpp"
#include "problem/polyhedron.hpp"

namespace checker {
namespace {

class Answers {
 public:
  Answers(const FilterProblem& problem, const Map& map)
      : problem_(problem),
        map_(map),
        model_(filterModel(problem)),
        scaling_(map),
        n_(problem.size()),
        nu_(problem.inputCount()),
        p_(n_ + nu_) {
    require(map.p == p_ && map.q == nu_, "the map has another number of signals");
  }

  void confirm(const Progress& progress) const {
    requireWishes();
    for (std::size_t r = 0; r < map_.regions.size(); ++r) {
      if (progress) progress("answers of region", r, map_.regions.size());
      requireKept(r);
    }
  }

 private:
  const double* lawOf(std::size_t region, std::size_t j) const {
    return map_.laws.data() + (map_.regions[region].law * nu_ + j) * (p_ + 1);
  }

  /// The law without active rows is the wish itself.
  void requireWishes() const {
    for (std::size_t r = 0; r < map_.regions.size(); ++r) {
      if (map_.regions[r].active_count > 0) continue;
      for (std::size_t j = 0; j < nu_; ++j) {
        for (std::size_t k = 0; k <= p_; ++k)
          require(lawOf(r, j)[k] == (k == n_ + j ? 1.0 : 0.0), "an admissible wish comes back changed");
      }
    }
  }

  /// Where a look-up may answer with the region, and the state is in the safe set.
  Polyhedron reachOf(const Map::Region& region) const {
    std::vector<ExactHalfSpace> rows;
    for (std::size_t j = 0; j < p_; ++j) {
      for (const int sign : {1, -1}) {
        rows.push_back({Vector(p_), Fraction(sign > 0 ? map_.bounds[2 * j + 1] : -map_.bounds[2 * j])});
        rows.back().a[j] = sign;
      }
    }
    for (std::size_t i = 0; i < problem_.H.rows; ++i) {
      rows.push_back({Vector(p_), problem_.k.at(i, 0)});
      for (std::size_t j = 0; j < n_; ++j) rows.back().a[j] = problem_.H.at(i, j);
    }
    for (std::size_t i = region.first_row; i < std::size_t{region.first_row} + region.row_count; ++i) {
      const double* plane =
          map_.planes.data() + (static_cast<std::size_t>(std::abs(map_.rows[i])) - 1) * (p_ + 1);
      const int sign = map_.rows[i] > 0 ? 1 : -1;
      rows.push_back({Vector(p_), sign * Fraction(plane[p_]) + kReach * Fraction(map_.tolerance)});
      for (std::size_t j = 0; j < p_; ++j) rows.back().a[j] = sign * Fraction(plane[j]);
    }
    return Polyhedron(std::move(rows));
  }

  /// How far the answer may be from the law, by rounding and where it is limited to the range of the input.
  Fraction errorOf(const Polyhedron& reach, const double* law, const FilterProblem::Range& range) const {
    const Fraction rounding = scaling_.roundingOf(law, 1);
    Fraction excess;
    for (const int sign : {1, -1}) {
      Vector a(p_);
      for (std::size_t k = 0; k < p_; ++k) a[k] = sign * Fraction(law[k]);
      const std::optional<Fraction> greatest = reach.greatest(a);
      require(greatest.has_value(), "the answers of a region have no bound");
      const Fraction end = sign > 0 ? Fraction(range.second) : Fraction(-range.first);
      excess = std::max(excess, Fraction(*greatest + sign * Fraction(law[p_]) + rounding - end));
    }
    return rounding + excess;
  }

  /// G_i u <= b_i + M_i xi + what the margin is worth in row i.
  void requireKept(std::size_t r) const {
    const Polyhedron reach = reachOf(map_.regions[r]);
    if (reach.isEmpty()) return;
    Vector errors;
    for (std::size_t j = 0; j < nu_; ++j) errors.push_back(errorOf(reach, lawOf(r, j), problem_.inputs[j]));
    for (std::size_t i = 0; i < problem_.G.rows; ++i) {
      ExactHalfSpace row{Vector(p_), problem_.b.at(i, 0)};
      bool has_input = false;
      for (std::size_t j = 0; j < nu_; ++j) {
        const Fraction& weight = problem_.G.at(i, j);
        has_input = has_input || weight != 0;
        for (std::size_t k = 0; k < p_; ++k) row.a[k] += weight * Fraction(lawOf(r, j)[k]);
        row.bound -= weight * Fraction(lawOf(r, j)[p_]) + abs(weight) * errors[j];
      }
      // The others hold in all of the safe set.
      if (!has_input) continue;
      for (std::size_t j = 0; j < n_; ++j) {
        row.a[j] -= problem_.M.at(i, j);
        row.bound += abs(problem_.H.at(i, j)) * model_.slack[j];
      }
      require(reach.isWithin(row), "an answer of region " + std::to_string(r) +
                                       " needs more than the margin of row " + std::to_string(i));
    }
  }

  const FilterProblem& problem_;
  const Map& map_;
  const FilterModel model_;
  const Scaling scaling_;
  const std::size_t n_, nu_, p_;
};

}  // namespace

void confirmAnswers(const FilterProblem& problem, const Map& map, const Progress& progress) {
  Answers(problem, map).confirm(progress);
}

}  // namespace checker
