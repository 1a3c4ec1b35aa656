#include <cmath>
#include <map>
#include <memory>

#include "identification/loop_record.hpp"
#include "online_controller/laws/axis.hpp"
#include "online_controller/laws/axis_law.hpp"
#include "region_maps/region_map.hpp"
#include "validation_parts.hpp"

namespace polyfly {
namespace {

// How far a parameter is out of its range; 0 in it.
double beyondRange(const Signal& signal, double value) {
  return std::max({0.0, signal.lower - value, value - signal.upper});
}

// Collects stretches of consecutive samples outside the map.
class ExcursionCollector {
 public:
  ExcursionCollector(const FlightLog& log, const RegionMap& map, std::vector<Excursion>* found)
      : recorded_(log.statusesByStamp()), map_(map), found_(found) {}

  void add(const ReplaySample& sample, const AxisReport& report) {
    if (report.lookup == LookupStatus::kInside) {
      open_ = false;
      return;
    }
    if (!open_ || isFarStep(found_->back().to, sample.state.stamp)) begin(sample, report);
    Excursion& excursion = found_->back();
    excursion.to = sample.state.stamp;
    ++excursion.samples;
    ++excursion.statuses.at(static_cast<std::size_t>(statusOf(sample)));
    if (parameter_ < 0 || report.size == 0) return;
    const auto index = static_cast<std::size_t>(parameter_);
    excursion.beyond = std::max(excursion.beyond, beyondRange(map_.parameters()[index], report.theta[index]));
  }

 private:
  void begin(const ReplaySample& sample, const AxisReport& report) {
    Excursion excursion;
    excursion.from = sample.state.stamp;
    excursion.cause = report.lookup;
    parameter_ = report.lookup == LookupStatus::kOutsideBox ? report.outside_parameter : -1;
    if (parameter_ >= 0) {
      const Signal& signal = map_.parameters()[static_cast<std::size_t>(parameter_)];
      excursion.parameter = signal.name;
      excursion.unit = signal.unit;
    }
    found_->push_back(excursion);
    open_ = true;
  }

  // What the controller reported in flight; where none was recorded, what the replay says.
  ControlStatus statusOf(const ReplaySample& sample) const {
    const auto found = recorded_.find(sample.state.stamp);
    return found == recorded_.end() ? sample.report.status : found->second->status;
  }

  std::map<double, const FlightLog::Status*> recorded_;
  const RegionMap& map_;
  std::vector<Excursion>* found_;
  bool open_ = false;
  int parameter_ = -1;
};

}  // namespace

AxisValidation validateAxis(const std::vector<ReplayedFlight>& flights, const RegionMap& map,
                            std::size_t index) {
  AxisValidation axis;
  axis.axis = kAxisNames[index].axis;
  axis.input = map.inputs().front().name;
  axis.input_unit = map.inputs().front().unit;
  // None for a map of a minimum-peak robust MPC; `offline_mpt verify --exact` proves it.
  AxisLaw law(map, problemOf(map, axis.axis));
  law.solveOutside();
  MapUseCounter counter(map);
  std::vector<double> thetas;
  std::vector<double> input(map.inputs().size());
  std::vector<double> solved(map.inputs().size());
  const std::vector<double> nothing(map.parameters().size(), std::numeric_limits<double>::quiet_NaN());
  DifferenceCollector qp;
  DifferenceCollector tracking;
  for (const ReplayedFlight& flight : flights) {
    ExcursionCollector excursions(flight.log, map, &axis.excursions);
    for (const ReplaySample& sample : flight.samples) {
      if (!sample.has_reference || !sample.is_known) continue;
      const AxisReport& report = sample.report.axis[index];
      const double stamp = sample.state.stamp;
      const auto along = static_cast<Eigen::Index>(index);
      tracking.add(sample.state.position[along] - sample.reference.position[along], stamp);
      excursions.add(sample, report);
      // Where no parameters could be assembled, the odometry or the reference was not finite.
      const SampleUse use = counter.add(stamp, report.size > 0 ? report.theta.data() : nothing.data());
      if (use.lookup.status != LookupStatus::kInside) continue;
      axis.edge_series.push_back({stamp, use.face, use.edge});
      thetas.insert(thetas.end(), report.theta.begin(), report.theta.begin() + report.size);
      if (!law.solvesOutside()) continue;
      map.evaluate(report.theta.data(), input.data());
      if (law.solve(report.theta.data(), solved.data()).status == LookupStatus::kInside) {
        qp.add(input.front() - solved.front(), stamp);
        axis.qp_series.push_back({stamp, std::abs(input.front() - solved.front())});
      } else {
        ++axis.qp_failures;
      }
    }
  }
  static_cast<MapUse&>(axis) = counter.use();
  axis.qp = qp.result();
  axis.qp_compared = qp.count();
  axis.tracking = tracking.result();
  axis.lookup_times = measureLookups(map, thetas);
  axis.lookup_ns = percentiles(axis.lookup_times);
  return axis;
}

}  // namespace polyfly
