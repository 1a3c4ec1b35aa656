#include "validation/map_use.hpp"

#include <cmath>

#include "online_controller/laws/axis.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

// Tolerance of the distance to the map's edge, in ranges of the parameter.
constexpr double kRoomError = 1e-4;

// Whether the map's end along it cannot be passed. The controller clips the disturbance ahead to its range. The input of the
// period before is enclosed by a range that holds all that an input may be, and a saturated input is no danger.
bool isEnclosed(const RegionMap& map, const Signal& parameter) {
  for (const AxisNames& names : kAxisNames) {
    if (parameter.name == names.disturbance_ahead) return true;
    if (parameter.name != names.previous_input) continue;
    return std::any_of(map.inputs().begin(), map.inputs().end(), [&](const Signal& input) {
      return input.name == names.input && parameter.lower <= input.lower && parameter.upper >= input.upper;
    });
  }
  return false;
}

void addTo(DistanceUse* use, double distance, double stamp) {
  use->sum += distance;
  if (distance < use->least) {
    use->least = distance;
    use->stamp = stamp;
  }
}

}  // namespace

std::pair<double, double> ParameterUse::proposedRange() const {
  // Margin as a share of the range that was met.
  constexpr double kBeyond = 0.1;
  const double more = kBeyond * (greatest - least);
  return {least < lower ? least - more : lower, greatest > upper ? greatest + more : upper};
}

std::size_t MapUse::visited() const {
  return regions() - static_cast<std::size_t>(std::count(region_samples.begin(), region_samples.end(), 0u));
}

std::vector<std::uint32_t> MapUse::neverVisited() const {
  std::vector<std::uint32_t> numbers;
  for (std::size_t region = 0; region < regions(); ++region) {
    if (region_samples[region] == 0) numbers.push_back(static_cast<std::uint32_t>(region));
  }
  return numbers;
}

double MapUse::share() const {
  return samples == 0 ? 0.0 : static_cast<double>(inside) / static_cast<double>(samples);
}

MapUseCounter::MapUseCounter(const RegionMap& map) : map_(&map) {
  use_.region_samples.resize(map.regionCount(), 0);
  for (const Signal& signal : map.parameters()) enclosed_.push_back(isEnclosed(map, signal));
  for (const Signal& signal : map.parameters()) {
    ParameterUse use;
    use.name = signal.name;
    use.unit = signal.unit;
    use.lower = signal.lower;
    use.upper = signal.upper;
    use_.parameters.push_back(use);
  }
}

SampleUse MapUseCounter::add(double stamp, const double* theta) {
  SampleUse sample;
  sample.lookup = map_->locate(theta);
  ++use_.samples;
  switch (sample.lookup.status) {
    case LookupStatus::kInside:
      ++use_.inside;
      ++use_.region_samples[sample.lookup.region];
      countDistances(stamp, theta, &sample);
      break;
    case LookupStatus::kOutsideBox:
      ++use_.outside_box;
      break;
    case LookupStatus::kOutsidePartition:
      ++use_.outside_partition;
      break;
    case LookupStatus::kNotFinite:
      ++use_.not_finite;
      break;
  }
  countParameters(theta, sample.lookup.status);
  return sample;
}

void MapUseCounter::countParameters(const double* theta, LookupStatus status) {
  for (std::size_t index = 0; index < use_.parameters.size(); ++index) {
    ParameterUse& use = use_.parameters[index];
    const double value = theta[index];
    if (!std::isfinite(value)) continue;
    use.least = std::min(use.least, value);
    use.greatest = std::max(use.greatest, value);
    // The box as the map tests it is wider by its tolerance; a sample that it holds is inside for every
    // parameter.
    if (status == LookupStatus::kOutsideBox && !(value >= use.lower && value <= use.upper)) ++use.outside;
  }
}

// Planes are scaled so that a . theta - c is the distance.
double MapUseCounter::faceDistance(std::uint32_t region, const double* theta) const {
  const std::size_t parameters = map_->parameters().size();
  const RegionView view = map_->region(region);
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t row = 0; row < view.row_count; ++row) {
    const std::int32_t reference = view.rows[row];
    const double* plane = map_->plane(static_cast<std::size_t>(std::abs(reference)) - 1);
    double beyond = -plane[parameters];
    bool passable = false;
    for (std::size_t index = 0; index < parameters; ++index) {
      beyond += plane[index] * theta[index];
      passable = passable || (plane[index] != 0.0 && !enclosed_[index]);
    }
    // A face that cannot be passed is the end of an enclosed parameter's range.
    if (!passable) continue;
    least = std::min(least, reference > 0 ? -beyond : beyond);
  }
  return std::max(0.0, least);
}

// The way from theta, which is inside, towards the end of the range until the map holds it no more: by
// halving, because maps need not be convex and need not fill their box.
double MapUseCounter::room(std::vector<double>* theta, std::size_t parameter, double end) const {
  const ParameterUse& use = use_.parameters[parameter];
  const double start = (*theta)[parameter];
  const auto holds = [&](double way) {
    (*theta)[parameter] = start + way * (end - start);
    return map_->locate(theta->data()).status == LookupStatus::kInside;
  };
  double held = 0.0;
  double lost = 1.0;
  if (holds(1.0)) {
    held = 1.0;
  } else {
    while ((lost - held) * std::abs(end - start) > kRoomError * (use.upper - use.lower)) {
      const double middle = 0.5 * (held + lost);
      (holds(middle) ? held : lost) = middle;
    }
  }
  (*theta)[parameter] = start;
  return held * std::abs(end - start);
}

void MapUseCounter::countDistances(double stamp, const double* theta, SampleUse* sample) {
  sample->face = faceDistance(sample->lookup.region, theta);
  sample->edge = std::numeric_limits<double>::infinity();
  std::vector<double> moved(theta, theta + use_.parameters.size());
  for (std::size_t index = 0; index < use_.parameters.size(); ++index) {
    ParameterUse& use = use_.parameters[index];
    if (!(use.upper > use.lower) || enclosed_[index]) continue;  // no way to go, or none beyond
    const double way = std::min(room(&moved, index, use.lower), room(&moved, index, use.upper));
    use.room = std::min(use.room, way);
    const double scaled = 2.0 * way / (use.upper - use.lower);
    if (scaled < sample->edge) {
      sample->edge = scaled;
      sample->edge_parameter = static_cast<int>(index);
    }
  }
  if (sample->edge < use_.edge.least) use_.edge_parameter = sample->edge_parameter;
  addTo(&use_.face, sample->face, stamp);
  addTo(&use_.edge, sample->edge, stamp);
}

}  // namespace polyfly
