#include "validation/flight_slice.hpp"

#include <algorithm>

#include "online_controller/laws/axis.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

double medianInside(const std::vector<ReplaySample>& samples, std::size_t axis, std::size_t parameter,
                    const Signal& signal) {
  std::vector<double> values;
  for (const ReplaySample& sample : samples) {
    const AxisReport& report = sample.report.axis[axis];
    if (report.lookup == LookupStatus::kInside) values.push_back(report.theta[parameter]);
  }
  if (values.empty()) return std::clamp(0.0, signal.lower, signal.upper);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return std::clamp(*middle, signal.lower, signal.upper);
}

}  // namespace

SliceRequest flightSlice(const std::vector<ReplaySample>& samples, const RegionMap& map, std::size_t axis) {
  SliceRequest request;
  request.x = kAxisNames[axis].position_error;
  request.y = kAxisNames[axis].velocity_error;
  for (std::size_t parameter = 0; parameter < map.parameters().size(); ++parameter) {
    const Signal& signal = map.parameters()[parameter];
    if (signal.name != request.x && signal.name != request.y)
      request.at.emplace_back(signal.name, medianInside(samples, axis, parameter, signal));
  }
  return request;
}

}  // namespace polyfly
