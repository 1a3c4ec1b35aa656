#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>

#include "calibration/report.hpp"
#include "map_plot/slice.hpp"
#include "online_controller/axis.hpp"

namespace polyfly {
namespace {

using Style = Series::Style;

constexpr std::size_t kPoints = 1200;  // of a curve that is drawn
constexpr const char* kReferenceColor = "#b9c1c9";
constexpr double kReferenceWidth = 5.0;    // [px]: wider than what was flown, so that both are seen
constexpr std::size_t kDots = 1500;        // of a cloud that is drawn
constexpr std::size_t kNamedRegions = 12;  // up to here regions have a line of their own in the picture
constexpr int kWidth = 1040;               // [px]
constexpr const char* kAxisColors[3] = {palette::kBlue, palette::kVermilion, palette::kGreen};
constexpr const char* kAxisLetters[3] = {"x", "y", "z"};

// A curve over the samples; `value` gives NaN where there is nothing to draw.
template <class Value>
Series overTime(const ReportContent& content, const std::string& label, const std::string& color,
                Value value) {
  Series series;
  series.label = label;
  series.color = color;
  const double start = content.samples.front().state.stamp;
  for (const ReplaySample& sample : content.samples) {
    series.x.push_back(sample.state.stamp - start);
    series.y.push_back(value(sample));
  }
  return thinned(series, kPoints);
}

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

Panel timePanel(const std::string& title, const std::string& y_label) {
  Panel panel;
  panel.title = title;
  panel.x_label = "time [s]";
  panel.y_label = y_label;
  return panel;
}

// The range of the values with a margin of a tenth on each side.
Panel::Range padded(double least, double greatest, double least_width) {
  const double width = std::max(greatest - least, least_width);
  const double middle = 0.5 * (least + greatest);
  return {middle - 0.6 * width, middle + 0.6 * width};
}

Panel topView(const ReportContent& content) {
  Panel panel;
  panel.title = "From above";
  panel.x_label = "x [m]";
  panel.y_label = "y [m]";
  panel.equal_axes = true;
  Series flown;
  Series reference;
  for (const ReplaySample& sample : content.samples) {
    flown.x.push_back(sample.state.position.x());
    flown.y.push_back(sample.state.position.y());
    if (!sample.has_reference) continue;
    reference.x.push_back(sample.reference.position.x());
    reference.y.push_back(sample.reference.position.y());
  }
  reference.label = "reference";
  reference.color = kReferenceColor;
  reference.width = kReferenceWidth;
  flown.label = "flown";
  Series start;
  start.label = "start";
  start.style = Style::kPoints;
  start.color = palette::kVermilion;
  start.width = 6.0;
  start.x = {flown.x.front()};
  start.y = {flown.y.front()};
  panel.series = {reference, flown, start};
  return panel;
}

ReportFigure flightFigure(const ReportContent& content) {
  ReportFigure result;
  result.heading = "The flight from above";
  result.caption = "Where the vehicle flew (blue) on top of where it should have flown (grey).";
  result.figure.panels = {topView(content)};
  result.figure.width = kWidth;
  result.figure.height = 430;
  return result;
}

ReportFigure heightFigure(const ReportContent& content) {
  ReportFigure result;
  result.heading = "Height and speed";
  result.caption = "Height and speed over time (blue) on top of those of the reference (grey).";
  const auto referenceOf = [&content](auto value) {
    Series series = overTime(content, "reference", kReferenceColor, [value](const ReplaySample& sample) {
      return sample.has_reference ? value(sample.reference) : kNothing;
    });
    series.width = kReferenceWidth;
    return series;
  };
  Panel height = timePanel("Height", "z [m]");
  height.series = {referenceOf([](const auto& at) { return at.position.z(); }),
                   overTime(content, "flown", palette::kBlue,
                            [](const ReplaySample& sample) { return sample.state.position.z(); })};
  Panel speed = timePanel("Speed", "|v| [m/s]");
  speed.series = {referenceOf([](const auto& at) { return at.velocity.norm(); }),
                  overTime(content, "flown", palette::kBlue,
                           [](const ReplaySample& sample) { return sample.state.velocity.norm(); })};
  result.figure.panels = {height, speed};
  result.figure.columns = 2;
  result.figure.width = kWidth;
  result.figure.height = 340;
  return result;
}

ReportFigure errorFigure(const ReportContent& content) {
  ReportFigure result;
  result.heading = "Tracking error";
  result.caption =
      "Flown position minus reference along each axis; where the reference rests at the end (shaded) the "
      "error must "
      "vanish although the wind goes on.";
  Panel panel = timePanel("", "flown − reference [m]");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    panel.series.push_back(
        overTime(content, kAxisLetters[axis], kAxisColors[axis], [axis](const ReplaySample& sample) {
          const auto along = static_cast<Eigen::Index>(axis);
          return sample.has_reference ? sample.state.position[along] - sample.reference.position[along]
                                      : kNothing;
        }));
  }
  if (content.validation.hold) {
    const double start = content.samples.front().state.stamp;
    panel.bands = {{content.validation.hold->from - start, content.validation.hold->to - start}};
  }
  result.figure.panels = {panel};
  result.figure.width = kWidth;
  result.figure.height = 340;
  return result;
}

Panel commandPanel(const ReportContent& content, const std::string& title, const std::string& y_label,
                   double AttitudeCommand::*entry, Panel::Range bounds) {
  Panel panel = timePanel(title, y_label);
  Series series;
  const double start = content.samples.front().state.stamp;
  for (const FlightLog::Command& command : content.log.commands) {
    series.x.push_back(command.stamp - start);
    series.y.push_back(command.command.*entry);
  }
  panel.series = {thinned(series, kPoints)};
  panel.bounds = {{bounds.first, "least", palette::kVermilion},
                  {bounds.second, "greatest", palette::kVermilion}};
  panel.y_range = padded(bounds.first, bounds.second, 0.0);
  return panel;
}

ReportFigure commandFigure(const ReportContent& content) {
  const MultirotorOptions& options = content.options;
  ReportFigure result;
  result.heading = "Commands and their bounds";
  result.caption =
      "What was sent to the attitude controller, as recorded; the dashed lines are the bounds that it must "
      "not cross.";
  result.figure.panels = {
      commandPanel(content, "Roll", "roll [rad]", &AttitudeCommand::roll,
                   {-options.angle_max, options.angle_max}),
      commandPanel(content, "Pitch", "pitch [rad]", &AttitudeCommand::pitch,
                   {-options.angle_max, options.angle_max}),
      commandPanel(content, "Yaw rate", "yaw rate [rad/s]", &AttitudeCommand::yaw_rate,
                   {-options.yaw_rate_max, options.yaw_rate_max}),
      commandPanel(content, "Thrust", "thrust [N]", &AttitudeCommand::thrust,
                   {options.mass * options.thrust_min, options.mass * options.thrust_max})};
  result.figure.columns = 2;
  result.figure.width = kWidth;
  result.figure.height = 560;
  return result;
}

// Regions over time. Few regions get a named line each, many keep their numbers.
Panel regionPanel(const ReportContent& content, std::size_t axis) {
  const AxisValidation& used = content.validation.axes[axis];
  std::set<std::int64_t> met;
  for (const ReplaySample& sample : content.samples) {
    if (sample.report.axis[axis].region >= 0) met.insert(sample.report.axis[axis].region);
  }
  const bool named = met.size() <= kNamedRegions;
  Panel panel = timePanel(
      used.axis + ": " + std::to_string(met.size()) + " of " + std::to_string(used.regions) + " regions",
      named ? "" : "region");
  panel.series = {overTime(content, "", kAxisColors[axis], [&](const ReplaySample& sample) {
    const std::int64_t region = sample.report.axis[axis].region;
    if (region < 0) return kNothing;
    return named ? static_cast<double>(std::distance(met.begin(), met.find(region)))
                 : static_cast<double>(region);
  })};
  panel.series[0].style = Style::kSteps;
  panel.series[0].width = 2.2;
  if (!named) {
    panel.y_range = padded(0.0, static_cast<double>(used.regions), 1.0);
    return panel;
  }
  for (const std::int64_t region : met) {
    panel.y_ticks.emplace_back(static_cast<double>(panel.y_ticks.size()), "region " + std::to_string(region));
  }
  panel.y_range = {-0.6, std::max(0.6, static_cast<double>(met.size()) - 0.4)};
  return panel;
}

ReportFigure regionFigure(const ReportContent& content) {
  ReportFigure result;
  result.heading = "Active region over time";
  result.caption =
      "Which region's law answered each sample; a level line means that one affine law flew all along, a "
      "jump "
      "that the set of active constraints changed, a gap that there was no answer.";
  constexpr double kFrame = 110.0;  // of a panel: title and axis [px]
  double height = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.figure.panels.push_back(regionPanel(content, axis));
    const std::size_t lines = result.figure.panels.back().y_ticks.size();
    height = std::max(height, lines > 0 ? 40.0 + 18.0 * static_cast<double>(lines) : 130.0);
  }
  result.figure.width = kWidth;
  result.figure.height = static_cast<int>(3.0 * (height + kFrame));
  return result;
}

// The value of a parameter in the middle of all that the flight met, so that the slice shows where the flight
// was.
double medianOf(const ReportContent& content, std::size_t axis, std::size_t parameter) {
  std::vector<double> values;
  for (const ReplaySample& sample : content.samples) {
    const AxisReport& report = sample.report.axis[axis];
    if (report.lookup == LookupStatus::kInside) values.push_back(report.theta[parameter]);
  }
  const Signal& signal = content.maps[axis]->parameters()[parameter];
  if (values.empty()) return std::clamp(0.0, signal.lower, signal.upper);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return std::clamp(*middle, signal.lower, signal.upper);
}

// The flight's parameters projected on the slice.
Series visitedPoints(const ReportContent& content, std::size_t axis, const Slice& cut) {
  Series points;
  points.color = palette::kInk;
  points.style = Style::kPoints;
  const std::size_t stride = content.samples.size() / kDots + 1;
  for (std::size_t index = 0; index < content.samples.size(); index += stride) {
    const ReplaySample& sample = content.samples[index];
    const AxisReport& report = sample.report.axis[axis];
    if (!sample.has_reference || report.size == 0) continue;
    points.x.push_back(report.theta[static_cast<std::size_t>(cut.x)]);
    points.y.push_back(report.theta[static_cast<std::size_t>(cut.y)]);
  }
  return points;
}

std::string unitOf(const RegionMap& map, int parameter) {
  const Signal& signal = map.parameters()[static_cast<std::size_t>(parameter)];
  return signal.name + " [" + signal.unit + "]";
}

// The slice around the points, none if they lie outside the map altogether.
std::optional<Slice> sliceNear(const RegionMap& map, SliceRequest request, const Series& points) {
  if (points.x.empty()) return std::nullopt;
  const auto [left, right] = std::minmax_element(points.x.begin(), points.x.end());
  const auto [low, high] = std::minmax_element(points.y.begin(), points.y.end());
  request.x_window = padded(*left, *right, 0.02);
  request.y_window = padded(*low, *high, 0.02);
  const Slice whole = slice(map, {request.x, request.y, request.at});
  const auto apart = [](const Panel::Range& one, const Panel::Range& other) {
    return one.second <= other.first || other.second <= one.first;
  };
  if (apart(*request.x_window, whole.x_range) || apart(*request.y_window, whole.y_range)) return std::nullopt;
  return slice(map, request);
}

ReportFigure sliceFigure(const ReportContent& content, std::size_t axis) {
  const RegionMap& map = *content.maps[axis];
  const AxisNames& names = kAxisNames[axis];
  SliceRequest request;
  request.x = names.position_error;
  request.y = names.velocity_error;
  for (std::size_t parameter = 0; parameter < map.parameters().size(); ++parameter) {
    const std::string& name = map.parameters()[parameter].name;
    if (name != request.x && name != request.y)
      request.at.emplace_back(name, medianOf(content, axis, parameter));
  }
  const Slice cut = slice(map, request);
  const Series points = visitedPoints(content, axis, cut);
  Panel whole = slicePanel(map, cut);
  whole.title = "Whole map: " + std::to_string(cut.polygons.size()) + " of " +
                std::to_string(map.regionCount()) + " regions are cut";
  if (!points.x.empty()) whole.series = {points};
  std::vector<Panel> panels = {whole};
  const std::optional<Slice> closer = sliceNear(map, request, points);
  if (closer) {
    panels.push_back(slicePanel(map, *closer));
    panels.back().title = "Where the flight was: " + std::to_string(closer->polygons.size()) + " regions";
    panels.back().series = {points};
  }
  ReportFigure result;
  result.heading = std::string("Partition, ") + names.axis + " axis";
  result.caption =
      "A slice of the map through " + unitOf(map, cut.x) + " and " + unitOf(map, cut.y) +
      " with the other parameters at their median of the flight: lines part the regions, colour is the "
      "explicit law's answer, the dark dots are what the flight visited (it also moves off the slice).";
  result.figure.panels = panels;
  result.figure.columns = 2;
  result.figure.width = kWidth;
  result.figure.height = 430;
  return result;
}

ReportFigure agreementFigure(const ReportContent& content) {
  ReportFigure result;
  result.heading = "Explicit against online";
  result.caption =
      "Difference between the map's answer and an online QP solved at the same parameters, for every sample; "
      "the ordinate "
      "is logarithmic and equal answers lie on its lower edge.";
  constexpr double kFloor = 1e-17;  // stands for zero on the logarithmic axis
  Panel panel = timePanel("", "|explicit − online| [unit of the input]");
  panel.log_y = true;
  double greatest = 1e-9;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const AxisValidation& used = content.validation.axes[axis];
    Series series;
    series.label = used.input + " [" + used.input_unit + "]";
    series.color = kAxisColors[axis];
    series.style = Style::kPoints;
    for (const auto& [stamp, difference] : used.qp_series) {
      series.x.push_back(stamp - content.samples.front().state.stamp);
      series.y.push_back(std::max(difference, kFloor));
      greatest = std::max(greatest, difference);
    }
    if (!series.x.empty()) panel.series.push_back(thinned(series, kPoints));
  }
  panel.y_range = {kFloor, 10.0 * greatest};
  result.figure.panels = {panel};
  result.figure.width = kWidth;
  result.figure.height = 320;
  return result;
}

ReportFigure latencyFigure(const ReportContent& content) {
  ReportFigure result;
  result.heading = "Look-up time";
  result.caption =
      "Time of one look-up with its law, measured in batches of 16 on the parameters of this flight: in "
      "their order "
      "(left) and shuffled, so that neither caches nor branch prediction help (right); the last bar also "
      "holds what took longer.";
  std::vector<double> all;
  for (const AxisValidation& axis : content.validation.axes) {
    all.insert(all.end(), axis.lookups.in_order.begin(), axis.lookups.in_order.end());
    all.insert(all.end(), axis.lookups.shuffled.begin(), axis.lookups.shuffled.end());
  }
  // The tail beyond is counted in the last bar.
  const double lower = 0.8 * *std::min_element(all.begin(), all.end());
  const double upper = std::max(1.3 * percentiles(all).p99, lower + 10.0);
  for (const bool shuffled : {false, true}) {
    std::vector<double> times;
    for (const AxisValidation& axis : content.validation.axes) {
      const std::vector<double>& part = shuffled ? axis.lookups.shuffled : axis.lookups.in_order;
      times.insert(times.end(), part.begin(), part.end());
    }
    const Percentiles share = percentiles(times);
    Panel panel;
    panel.title = shuffled ? "Shuffled" : "In the order of the flight";
    panel.x_label = "time per look-up [ns]";
    panel.y_label = "batches";
    panel.x_range = {lower, upper};
    panel.series = {histogram(times, lower, upper, 50, false)};
    panel.marks = {
        {share.p50, "median " + std::to_string(std::lround(share.p50)) + " ns", palette::kInk},
        {share.p99, "99 % below " + std::to_string(std::lround(share.p99)) + " ns", palette::kVermilion}};
    result.figure.panels.push_back(panel);
  }
  result.figure.columns = 2;
  result.figure.width = kWidth;
  result.figure.height = 340;
  return result;
}

Series trueDisturbance(const ReportContent& content, Eigen::Index axis) {
  Series truth;
  truth.label = "true";
  truth.color = kReferenceColor;
  truth.width = 2.5;
  for (const FlightLog::Disturbance& sample : content.log.disturbances) {
    truth.x.push_back(sample.stamp - content.samples.front().state.stamp);
    truth.y.push_back(sample.acceleration[axis]);
  }
  return thinned(truth, kPoints);
}

ReportFigure disturbanceFigure(const ReportContent& content) {
  ReportFigure result;
  result.heading = "Disturbance estimate";
  const bool known = !content.log.disturbances.empty();
  result.caption =
      known ? "What the observer took for wind (coloured) on top of the wind that the simulator made (grey)."
            : "What the observer took for wind; the log does not hold the true one.";
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Panel panel = timePanel(std::string("Along ") + kAxisLetters[axis],
                            std::string("d_") + kAxisLetters[axis] + " [m/s²]");
    if (known) panel.series = {trueDisturbance(content, static_cast<Eigen::Index>(axis))};
    panel.series.push_back(
        overTime(content, "estimate", kAxisColors[axis],
                 [axis](const ReplaySample& sample) { return sample.report.axis[axis].disturbance; }));
    result.figure.panels.push_back(panel);
  }
  result.figure.width = kWidth;
  result.figure.height = 640;
  return result;
}

}  // namespace

std::vector<ReportFigure> reportFigures(const ReportContent& content) {
  std::vector<ReportFigure> figures;
  if (content.samples.empty()) {
    return figures;
  }
  figures.push_back(flightFigure(content));
  figures.push_back(heightFigure(content));
  if (content.validation.tracked_samples > 0) figures.push_back(errorFigure(content));
  if (!content.log.commands.empty()) figures.push_back(commandFigure(content));
  if (content.validation.tracked_samples > 0) {
    figures.push_back(regionFigure(content));
    for (const std::size_t axis : {std::size_t{1}, std::size_t{0}, std::size_t{2}}) {
      figures.push_back(sliceFigure(content, axis));
    }
    const auto compared = [](const AxisValidation& axis) { return axis.qp_compared > 0; };
    const auto& axes = content.validation.axes;
    if (std::any_of(axes.begin(), axes.end(), compared)) {
      figures.push_back(agreementFigure(content));
      figures.push_back(latencyFigure(content));
    }
    figures.push_back(disturbanceFigure(content));
  }
  return figures;
}

}  // namespace polyfly
