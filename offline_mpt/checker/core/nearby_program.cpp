// Statement 6: each answer is the optimum of a program with nearly the same bounds and cost.
#include <algorithm>

#include "core/certificate.hpp"
#include "core/tags.hpp"

namespace checker {

/// Where a look-up answers, the solution z of the region's active set meets its conditions but for small violations. It is
/// the optimum if the bounds give way by those of slacks, and f changes by A' times those of multipliers.
void Certificate::boundChanges(std::size_t index, const Region& region) const {
  Vector costs(n_);
  for (std::size_t i = 0; i < m_; ++i) {
    bound_change_ = std::max(bound_change_, violationOf(index, region, tag::origin(tag::kSlack, i)));
    const Fraction multiplier = violationOf(index, region, tag::origin(tag::kMultiplier, i));
    for (std::size_t k = 0; k < n_; ++k) costs[k] += abs(data("A").at(i, k)) * multiplier;
  }
  for (const Fraction& change : costs) cost_change_ = std::max(cost_change_, change);
}

/// How much below zero a condition can be where a look-up answers, in its unit. A condition that the map does not have is
/// a sum of listed rows and of what is left, which is not below its least value in the box.
Fraction Certificate::violationOf(std::size_t index, const Region& region, const std::string& origin) const {
  const auto condition = region.rows.find(origin);
  if (condition == region.rows.end() || leastInBox(condition->second) >= 0) return 0;
  const Claim& claim = claims_[index];
  const Fraction& unit = region.units.at(origin);
  for (std::size_t f = 0; f < region.own; ++f)
    if (claim.listed[f] == origin) return unit * region.violated[f];
  const auto& [scale, weights] = claim.proofs.at("follows " + origin);
  std::vector<const Row*> from;
  for (const Row& row : region.listed) from.push_back(&row);
  int most = bitsOf(condition->second);
  for (const auto& [place, weight] : weights) most = std::max(most, bitsOf(region.listed[place]));
  Fraction sum = -leastInBox(remainder(&condition->second, scale, weights, from));
  for (const auto& [place, weight] : weights)
    sum += weight * region.violated[place] * powerOfTwo(most - bitsOf(region.listed[place]));
  sum /= scale * powerOfTwo(most - bitsOf(condition->second));
  return unit * std::max(Fraction(0), sum);
}

}  // namespace checker
