#include "online_controller_ros/map_swap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly_ros {
namespace {

using polyfly::Error;
using polyfly::LookupStatus;
using polyfly::RegionMap;

// Greatest change as a share of an input's range, unless the request says otherwise.
constexpr double kMostChange = 0.25;
// Greatest input at rest, as a share of the input's range.
constexpr double kRestTolerance = 0.001;

double inputRange(const RegionMap& map) { return map.inputs().at(0).upper - map.inputs().at(0).lower; }

[[noreturn]] void refuse(const RegionMap& map, const std::string& rule) {
  throw Error(map.path() + ": " + rule);
}

void requireRest(const RegionMap& map) {
  const std::vector<double> rest(map.parameters().size(), 0.0);
  double input = 0.0;
  if (map.evaluate(rest.data(), &input).status != LookupStatus::kInside)
    refuse(map, "must have an answer at rest on the reference");
  if (std::abs(input) > kRestTolerance * inputRange(map))
    refuse(map, "must command nothing at rest on the reference, commands " + std::to_string(input));
}

/// The parameters of the map in force, in the order of the next one. False where one is missing there.
bool reorder(const RegionMap& now, const RegionMap& next, const double* theta, std::vector<double>& ordered) {
  ordered.clear();
  for (const polyfly::Signal& wanted : next.parameters()) {
    for (std::size_t i = 0; i < now.parameters().size(); ++i) {
      if (now.parameters()[i].name == wanted.name) ordered.push_back(theta[i]);
    }
  }
  return ordered.size() == next.parameters().size();
}

void requireSmall(const RegionMap& next, std::size_t input, double change, double share) {
  const polyfly::Signal& signal = next.inputs()[input];
  if (!(change > share * (signal.upper - signal.lower))) return;
  std::ostringstream rule;
  rule << "would change the command by " << change << " " << signal.unit
       << " at the present state, more than " << share << " of its range";
  refuse(next, rule.str());
}

}  // namespace

void requireSamePeriod(const RegionMap& now, const RegionMap& next) {
  if (now.period() != next.period()) {
    std::ostringstream rule;
    rule << "period must be that of the map in force, " << now.period() << " s, got " << next.period();
    refuse(next, rule.str());
  }
}

double requireSimilar(const RegionMap& now, const RegionMap& next, const std::vector<double>& last,
                      double most_change) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (!(most_change >= 0.0)) throw Error("most_change: must be 0 or more");
  const double share = most_change > 0.0 ? most_change : kMostChange;
  std::vector<double> theta, before(now.inputs().size()), after(next.inputs().size());
  if (last.size() != now.parameters().size()) return kNone;
  if (now.evaluate(last.data(), before.data()).status != LookupStatus::kInside) return kNone;
  if (!reorder(now, next, last.data(), theta)) return kNone;
  if (next.evaluate(theta.data(), after.data()).status != LookupStatus::kInside)
    refuse(next, "has no answer at the present state, where the map in force has one");
  double greatest = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double change = std::abs(after[i] - before[i]);
    requireSmall(next, i, change, share);
    greatest = std::max(greatest, change);
  }
  return greatest;
}

polyfly::Law lawOfSwap(const online_controller::SwapMaps::Request& request) {
  if (!request.law.empty()) return polyfly::lawOfName(request.law);
  return polyfly::lawOfName(request.robust != 0 ? "robust_explicit" : "explicit_linear");
}

LawSetup withOtherMaps(const LawSetup& setup, const online_controller::SwapMaps::Request& request,
                       const FlightSnapshot* last, std::array<double, 3>& change) {
  change.fill(std::numeric_limits<double>::quiet_NaN());
  const polyfly::Law law = lawOfSwap(request);
  const auto maps_of = [law](const LawSetup& of) -> const polyfly::MapSet& {
    return of.sources->mapsOf(law);
  };
  if (maps_of(setup).empty()) throw Error("swap_maps: this controller was started without such maps");
  const std::array<std::string, 3> wanted{request.longitudinal, request.lateral, request.vertical};
  const bool feeds_linear = law == polyfly::lawOfName("explicit_linear");
  LawSetup next = setup;
  std::array<std::string, 3>& paths = next.parameters.maps.at(static_cast<std::size_t>(law));
  for (std::size_t i = 0; i < 3; ++i) {
    if (!wanted[i].empty()) paths[i] = wanted[i];
  }
  // With the checks of the start.
  next.sources = LawSources::load(next.parameters);
  for (std::size_t i = 0; i < 3; ++i) {
    const RegionMap& now = maps_of(setup).maps[i];
    const RegionMap& map = maps_of(next).maps[i];
    const bool robust = maps_of(next).problems.at(i).minimum_peak;
    requireSamePeriod(now, map);
    if (maps_of(setup).problems.at(i).minimum_peak != robust)
      refuse(map, "must be of the kind of the map in force (tracking or minimum peak)");
    if (!robust) requireRest(map);
    // The law linear has the parameters of explicit_linear.
    const bool comparable =
        last != nullptr &&
        (last->answered.law == law || (feeds_linear && last->answered.law == polyfly::lawOfName("linear")));
    std::vector<double> theta;
    if (comparable) {
      const polyfly::AxisReport& axis = last->answered.report.axis[i];
      theta.assign(axis.theta.begin(), axis.theta.begin() + axis.size);
    }
    change[i] = requireSimilar(now, map, theta, request.most_change);
  }
  // The linear law solves the problems in the maps, unless files give it its own.
  if (setup.parameters.problems[0].empty() && feeds_linear)
    next.parameters.linear = polyfly::linearTuning(next.sources->problems);
  return next;
}

}  // namespace polyfly_ros
