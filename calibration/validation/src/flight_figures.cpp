#include "flight_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <string>
#include <utility>

namespace polyfly {
namespace {

using Style = Series::Style;

constexpr const char* kAxisLetters[3] = {"x", "y", "z"};
constexpr const char* kReferenceColor = "#b9c1c9";
// Line width [px]. It is wider than the flown curve, so that both are seen.
constexpr double kReferenceWidth = 5.0;
// Greatest number of regions that are named beside the picture.
constexpr std::size_t kNamedRegions = 12;
// Lower end of the logarithmic axis of distances.
constexpr double kFloor = 1e-4;

double startOf(const ReportContent& content) { return content.samples.front().state.stamp; }

// A curve over the samples, against seconds since the first.
template <class Value>
Series overTime(const ReportContent& content, const std::string& label, const std::string& color,
                Value value) {
  return curve(label, color, startOf(content), content.samples, [value](const ReplaySample& sample) {
    return std::make_pair(sample.state.stamp, static_cast<double>(value(sample)));
  });
}

// Seen from above: y against x, with gaps where samples are missing. `position` may be NaN.
template <class Position>
Series pathOf(const ReportContent& content, const std::string& label, const std::string& color,
              Position position) {
  Series x, y;
  for (const ReplaySample& sample : content.samples) {
    const Eigen::Vector3d at = position(sample);
    x.x.push_back(sample.state.stamp);
    x.y.push_back(at.x());
    y.x.push_back(sample.state.stamp);
    y.y.push_back(at.y());
  }
  Series path;
  path.label = label;
  path.color = color;
  path.x = withGaps(x).y;
  path.y = withGaps(y).y;
  return path;
}

ReportSection flightFigure(const ReportContent& content) {
  Panel panel;
  panel.x_label = "x [m]";
  panel.y_label = "y [m]";
  panel.equal_axes = true;
  Series reference = pathOf(content, "reference", kReferenceColor, [](const ReplaySample& sample) {
    return sample.has_reference ? sample.reference.position : Eigen::Vector3d::Constant(kNothing).eval();
  });
  reference.width = kReferenceWidth;
  const Series flown = pathOf(content, "flown", palette::kBlue,
                              [](const ReplaySample& sample) { return sample.state.position; });
  Series start;
  start.label = "start";
  start.style = Style::kPoints;
  start.color = palette::kVermilion;
  start.width = 6.0;
  start.x = {flown.x.front()};
  start.y = {flown.y.front()};
  panel.series = {reference, flown, start};
  return pictured("The flight from above",
                  "Where the vehicle flew (blue) on top of where it should have flown (grey).", {panel},
                  row_height::kView);
}

ReportSection heightFigure(const ReportContent& content) {
  std::vector<Panel> panels;
  const auto add = [&](const std::string& title, const std::string& label, auto value) {
    Series reference = overTime(content, "reference", kReferenceColor, [value](const ReplaySample& sample) {
      return sample.has_reference ? value(sample.reference) : kNothing;
    });
    reference.width = kReferenceWidth;
    panels.push_back(timePanel(title, label));
    panels.back().series = {reference,
                            overTime(content, "flown", palette::kBlue,
                                     [value](const ReplaySample& sample) { return value(sample.state); })};
  };
  add("Height", "z [m]", [](const auto& at) { return at.position.z(); });
  add("Speed", "|v| [m/s]", [](const auto& at) { return at.velocity.norm(); });
  return pictured("Height and speed",
                  "Height and speed over time (blue) on top of those of the reference (grey).", panels,
                  row_height::kAlone, 2);
}

ReportSection errorFigure(const ReportContent& content) {
  Panel panel = timePanel("", "flown − reference [m]");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto along = static_cast<Eigen::Index>(axis);
    panel.series.push_back(
        overTime(content, kAxisLetters[axis], kAxisColors[axis], [along](const ReplaySample& sample) {
          return sample.has_reference ? sample.state.position[along] - sample.reference.position[along]
                                      : kNothing;
        }));
  }
  const std::optional<HoldOffset>& hold = content.validation.hold;
  if (hold) panel.bands = {{hold->from - startOf(content), hold->to - startOf(content)}};
  return pictured("Tracking error",
                  "Flown position minus reference along each axis; where the reference rests at the end "
                  "(shaded) the error must vanish although the wind goes on.",
                  {panel}, row_height::kAlone);
}

ReportSection commandFigure(const ReportContent& content) {
  const MultirotorOptions& options = content.options;
  std::vector<Panel> panels;
  const auto add = [&](const std::string& title, const std::string& label, double AttitudeCommand::*entry,
                       double least, double greatest) {
    Panel panel = timePanel(title, label);
    panel.series = {curve("", palette::kBlue, startOf(content), content.log.commands,
                          [entry](const FlightLog::Command& command) {
                            return std::make_pair(command.stamp, command.command.*entry);
                          })};
    panel.bounds = {{least, "least"}, {greatest, "greatest"}};
    panel.y_range = padded(least, greatest, 0.0);
    panels.push_back(panel);
  };
  add("Roll", "roll [rad]", &AttitudeCommand::roll, -options.angle_max, options.angle_max);
  add("Pitch", "pitch [rad]", &AttitudeCommand::pitch, -options.angle_max, options.angle_max);
  add("Yaw rate", "yaw rate [rad/s]", &AttitudeCommand::yaw_rate, -options.yaw_rate_max,
      options.yaw_rate_max);
  add("Thrust", "thrust [N]", &AttitudeCommand::thrust, options.mass * options.thrust_min,
      options.mass * options.thrust_max);
  return pictured(
      "Commands and their bounds",
      "What was sent to the attitude controller, as recorded; the dashed lines are the bounds that "
      "it must not cross.",
      panels, row_height::kPaired, 2);
}

// Regions over time. Each region that was visited has a line of its own; of many, evenly spaced ones are named.
Panel regionPanel(const ReportContent& content, std::size_t axis) {
  const AxisValidation& used = content.validation.axes[axis];
  std::set<std::int64_t> visited;
  for (const ReplaySample& sample : content.samples) {
    if (sample.report.axis[axis].region >= 0) visited.insert(sample.report.axis[axis].region);
  }
  const std::vector<std::int64_t> met(visited.begin(), visited.end());
  Panel panel = timePanel(
      used.axis + ": " + std::to_string(met.size()) + " of " + std::to_string(used.regions()) + " regions",
      "");
  panel.series = {overTime(content, "", kAxisColors[axis], [&](const ReplaySample& sample) {
    const std::int64_t region = sample.report.axis[axis].region;
    const auto line = std::lower_bound(met.begin(), met.end(), region);
    return region < 0 ? kNothing : static_cast<double>(std::distance(met.begin(), line));
  })};
  // Then there is nothing to fit a range to.
  if (met.empty()) panel.x_range = padded(0.0, content.samples.back().state.stamp - startOf(content), 1.0);
  panel.series[0].style = Style::kSteps;
  const std::size_t step = met.size() / (kNamedRegions + 1) + 1;
  for (std::size_t line = 0; line < met.size(); line += step)
    panel.y_ticks.emplace_back(static_cast<double>(line), "region " + std::to_string(met[line]));
  panel.y_range = {-0.6, std::max(0.6, static_cast<double>(met.size()) - 0.4)};
  return panel;
}

ReportSection regionFigure(const ReportContent& content) {
  // Height of a panel's title and axis, and of a named region [px].
  constexpr std::size_t kFrame = 150;
  constexpr std::size_t kLine = 18;
  std::size_t lines = 0;
  std::vector<Panel> panels;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    panels.push_back(regionPanel(content, axis));
    lines = std::max(lines, panels.back().y_ticks.size());
  }
  return pictured("Active region over time",
                  "Which region's law answered each sample, of the regions that were visited. A level line "
                  "means that one affine law flew all along, a jump that the set of active constraints "
                  "changed, a gap that there was no answer.",
                  std::move(panels), static_cast<int>(kFrame + kLine * lines));
}

ReportSection distanceFigure(const ReportContent& content) {
  std::vector<Panel> panels;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const AxisValidation& used = content.validation.axes[axis];
    if (used.edge_series.empty()) continue;
    Panel panel = timePanel(used.axis, "distance [-]");
    const auto add = [&](const std::string& label, const std::string& color, std::size_t entry) {
      panel.series.push_back(
          curve(label, color, startOf(content), used.edge_series, [entry](const std::array<double, 3>& row) {
            return std::make_pair(row[0],
                                  std::isfinite(row[entry]) ? std::max(row[entry], kFloor) : kNothing);
          }));
    };
    add("nearest face", palette::kGrey, 1);
    add("edge of the map", kAxisColors[axis], 2);
    panel.log_y = true;
    panel.y_range = {kFloor, 2.0};
    for (const Excursion& excursion : used.excursions)
      panel.bands.push_back({excursion.from - startOf(content), excursion.to - startOf(content)});
    panels.push_back(panel);
  }
  return pictured(
      "Distance to the map's edge",
      "How far the parameters could still have moved, along the one that is nearest to it, before "
      "the map ended (coloured), and how far the nearest face of the region was (grey); ranges are "
      "scaled to -1 .. 1. Shaded: outside the map.",
      panels, row_height::kStacked);
}

// All of the estimate, and of the truth what is not a short push. Both may have gaps.
Panel::Range disturbanceRange(const std::vector<double>& estimate, const std::vector<double>& truth) {
  // Least width of the drawn range [m/s^2].
  constexpr double kLeastWidth = 0.02;
  // One of so many samples is cut off at each end.
  constexpr std::size_t kCut = 50;
  const auto isFinite = [](double value) { return std::isfinite(value); };
  std::vector<double> known;
  std::copy_if(truth.begin(), truth.end(), std::back_inserter(known), isFinite);
  std::sort(known.begin(), known.end());
  const auto cut = static_cast<std::ptrdiff_t>(known.size() / kCut);
  std::vector<double> values(known.begin() + cut, known.end() - cut);
  std::copy_if(estimate.begin(), estimate.end(), std::back_inserter(values), isFinite);
  if (values.empty()) return padded(0.0, 0.0, kLeastWidth);
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  return padded(*least, *greatest, kLeastWidth);
}

ReportSection disturbanceFigure(const ReportContent& content) {
  std::vector<Panel> panels;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto along = static_cast<Eigen::Index>(axis);
    Panel panel = timePanel(std::string("Along ") + kAxisLetters[axis],
                            std::string("d_") + kAxisLetters[axis] + " [m/s²]");
    Series truth = curve("true", kReferenceColor, startOf(content), content.log.disturbances,
                         [along](const FlightLog::Disturbance& sample) {
                           return std::make_pair(sample.stamp, sample.acceleration[along]);
                         });
    truth.width = 2.5;
    const Series estimate =
        overTime(content, "estimate", kAxisColors[axis],
                 [axis](const ReplaySample& sample) { return sample.report.axis[axis].disturbance; });
    panel.y_range = disturbanceRange(estimate.y, truth.y);
    if (!truth.x.empty()) panel.series = {truth};
    panel.series.push_back(estimate);
    panels.push_back(panel);
  }
  return pictured(
      "Disturbance estimate",
      "What the observer took for wind (coloured) on top of the wind that a simulator made (grey), "
      "where the log holds it. Short pushes may leave the picture.",
      panels, row_height::kStacked);
}

}  // namespace

std::vector<ReportSection> flightFigures(const ReportContent& content) {
  std::vector<ReportSection> figures;
  if (content.samples.empty()) return figures;
  figures = {flightFigure(content), heightFigure(content)};
  const bool is_tracked = content.validation.tracked_samples > 0;
  if (is_tracked) figures.push_back(errorFigure(content));
  if (!content.log.commands.empty()) figures.push_back(commandFigure(content));
  if (!is_tracked) return figures;
  figures.push_back(regionFigure(content));
  const auto& axes = content.validation.axes;
  if (std::any_of(axes.begin(), axes.end(), [](const AxisValidation& axis) { return axis.inside > 0; }))
    figures.push_back(distanceFigure(content));
  figures.push_back(disturbanceFigure(content));
  return figures;
}

}  // namespace polyfly
