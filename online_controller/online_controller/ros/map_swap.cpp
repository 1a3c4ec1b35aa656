#include "online_controller_ros/map_swap.hpp"

#include <cmath>
#include <limits>
#include <sstream>

#include "online_controller_ros/law_sources.hpp"
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

void requireSamePeriod(const RegionMap& now, const RegionMap& next) {
  if (now.period() != next.period()) {
    std::ostringstream rule;
    rule << "period must be that of the map in force, " << now.period() << " s, got " << next.period();
    refuse(next, rule.str());
  }
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

/// How far the answers lie apart at the last sample, NaN where the map in force has none.
double changeAt(const RegionMap& now, const RegionMap& next, const polyfly::AxisReport& last) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> theta;
  double before = 0.0, after = 0.0;
  if (last.size != static_cast<int>(now.parameters().size())) return kNone;
  if (now.evaluate(last.theta.data(), &before).status != LookupStatus::kInside) return kNone;
  if (!reorder(now, next, last.theta.data(), theta)) return kNone;
  if (next.evaluate(theta.data(), &after).status != LookupStatus::kInside)
    refuse(next, "has no answer at the present state, where the map in force has one");
  return std::abs(after - before);
}

void requireSmall(const RegionMap& next, double change, double share) {
  if (!(change > share * inputRange(next))) return;
  std::ostringstream rule;
  rule << "would change the command by " << change << " " << next.inputs().at(0).unit
       << " at the present state, more than " << share << " of its range";
  refuse(next, rule.str());
}

}  // namespace

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
  if (!(request.most_change >= 0.0)) throw Error("swap_maps: most_change: must be 0 or more");
  const double share = request.most_change > 0.0 ? request.most_change : kMostChange;
  const std::array<std::string, 3> wanted{request.longitudinal, request.lateral, request.vertical};
  const bool feeds_linear = law == polyfly::lawOfName("explicit_linear");
  LawSetup next = setup;
  std::array<std::string, 3>& paths = next.files.maps.at(static_cast<std::size_t>(law));
  for (std::size_t i = 0; i < 3; ++i) {
    if (!wanted[i].empty()) paths[i] = wanted[i];
  }
  // With the checks of the start.
  next.sources = LawSources::load(next.files, next.nonlinear.model, next.controller);
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
        last != nullptr && (last->law == law || (feeds_linear && last->law == polyfly::lawOfName("linear")));
    if (!comparable) continue;
    change[i] = changeAt(now, map, last->report.axis[i]);
    requireSmall(map, change[i], share);
  }
  // The linear law solves the problems in the maps, unless files give it its own.
  if (setup.files.problems[0].empty() && feeds_linear)
    next.linear = polyfly::linearTuning(next.sources->problems);
  return next;
}

}  // namespace polyfly_ros
