#include "validation/map_comparison.hpp"

#include <algorithm>

#include "online_axis.hpp"
#include "online_controller/laws/axis.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"
#include "validation/difference.hpp"

namespace polyfly {
namespace {

// Where each parameter of the other map stands among those of the one that flew.
std::vector<std::size_t> placesByName(const RegionMap& flown, const RegionMap& other) {
  std::vector<std::size_t> places;
  for (const Signal& signal : other.parameters()) {
    const auto found = std::find_if(flown.parameters().begin(), flown.parameters().end(),
                                    [&signal](const Signal& own) { return own.name == signal.name; });
    if (found == flown.parameters().end()) {
      throw Error(other.path() + ": parameters: " + signal.name + " is not among those of " + flown.path() +
                  ", so the two cannot be compared on its flight");
    }
    places.push_back(static_cast<std::size_t>(found - flown.parameters().begin()));
  }
  return places;
}

}  // namespace

MapComparison compareMaps(const std::vector<ReplayedFlight>& flights, const RegionMap& flown,
                          const RegionMap& other, std::size_t axis) {
  const std::vector<std::size_t> places = placesByName(flown, other);
  MapComparison result;
  result.axis = kAxisNames.at(axis).axis;
  result.path = other.path();
  result.input_unit = other.inputs().front().unit;
  OnlineAxis online(other);
  MapUseCounter counter(other);
  DifferenceCollector difference;
  DifferenceCollector qp;
  std::vector<double> theta(places.size());
  std::vector<double> thetas;
  std::vector<double> flown_input(flown.inputs().size());
  std::vector<double> other_input(other.inputs().size());
  for (const ReplayedFlight& flight : flights) {
    for (const ReplaySample& sample : flight.samples) {
      const AxisReport& report = sample.report.axis.at(axis);
      if (!sample.has_reference || report.size == 0) continue;
      for (std::size_t index = 0; index < places.size(); ++index)
        theta[index] = report.theta.at(places[index]);
      const bool held =
          flown.evaluate(report.theta.data(), flown_input.data()).status == LookupStatus::kInside;
      const bool holds = counter.add(sample.state.stamp, theta.data()).lookup.status == LookupStatus::kInside;
      result.only_flown += held && !holds ? 1 : 0;
      result.only_other += holds && !held ? 1 : 0;
      if (!holds) continue;
      other.evaluate(theta.data(), other_input.data());
      thetas.insert(thetas.end(), theta.begin(), theta.end());
      if (held) difference.add(flown_input.front() - other_input.front(), sample.state.stamp);
      if (!online.solves()) continue;
      const std::optional<double> solved = online.input(theta.data());
      if (solved) qp.add(other_input.front() - *solved, sample.state.stamp);
      result.qp_failures += solved ? 0 : 1;
    }
  }
  result.use = counter.use();
  result.both = difference.count();
  result.difference = difference.result();
  result.qp = qp.result();
  result.lookup_ns = percentiles(measureLookups(other, thetas).in_order);
  return result;
}

MapChoice chooseMaps(const std::vector<const RegionMap*>& maps) {
  std::vector<const RegionMap*> first;
  std::array<bool, 3> taken{};
  MapChoice choice;
  for (const RegionMap* map : maps) {
    const std::size_t axis = axisOf(*map);
    if (taken[axis]) {
      choice.others.push_back({axis, map});
    } else {
      first.push_back(map);
      taken[axis] = true;
    }
  }
  choice.flown = assignAxes(first);
  return choice;
}

}  // namespace polyfly
