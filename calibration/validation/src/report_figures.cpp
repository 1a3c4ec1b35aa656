#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "report_parts.hpp"

namespace polyfly {
namespace {

// Width of the page's text [px].
constexpr int kFigureWidth = 1040;

using Style = Series::Style;

constexpr const char* kAxisLetters[3] = {"x", "y", "z"};
constexpr const char* kReferenceColor = "#b9c1c9";
// Line width [px]. It is wider than the flown curve, so that both are seen.
constexpr double kReferenceWidth = 5.0;

// Positions by their times.
struct PathOverTime {
  Series x;
  Series y;

  void add(double time, const Eigen::Vector3d& position) {
    x.x.push_back(time);
    x.y.push_back(position.x());
    y.x.push_back(time);
    y.y.push_back(position.y());
  }

  // y against x, with gaps where samples are missing.
  Series seenFromAbove() const {
    Series path;
    path.x = withGaps(x).y;
    path.y = withGaps(y).y;
    return path;
  }
};

Panel topView(const ReportContent& content) {
  Panel panel;
  panel.x_label = "x [m]";
  panel.y_label = "y [m]";
  panel.equal_axes = true;
  PathOverTime flown_path;
  PathOverTime reference_path;
  for (const ReplaySample& sample : content.samples) {
    flown_path.add(sample.state.stamp, sample.state.position);
    if (sample.has_reference) reference_path.add(sample.state.stamp, sample.reference.position);
  }
  Series flown = flown_path.seenFromAbove();
  Series reference = reference_path.seenFromAbove();
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
  result.figure = pageFigure({topView(content)}, row_height::kView);
  return result;
}

ReportFigure heightFigure(const ReportContent& content) {
  ReportFigure result;
  result.heading = "Height and speed";
  result.caption = "Height and speed over time (blue) on top of those of the reference (grey).";
  const auto reference_of = [&content](auto value) {
    Series series = overTime(content, "reference", kReferenceColor, [value](const ReplaySample& sample) {
      return sample.has_reference ? value(sample.reference) : kNothing;
    });
    series.width = kReferenceWidth;
    return series;
  };
  Panel height = timePanel("Height", "z [m]");
  height.series = {reference_of([](const auto& at) { return at.position.z(); }),
                   overTime(content, "flown", palette::kBlue,
                            [](const ReplaySample& sample) { return sample.state.position.z(); })};
  Panel speed = timePanel("Speed", "|v| [m/s]");
  speed.series = {reference_of([](const auto& at) { return at.velocity.norm(); }),
                  overTime(content, "flown", palette::kBlue,
                           [](const ReplaySample& sample) { return sample.state.velocity.norm(); })};
  result.figure = pageFigure({height, speed}, row_height::kAlone, 2);
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
  result.figure = pageFigure({panel}, row_height::kAlone);
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
  panel.series = {thinned(series, kCurvePoints)};
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
  result.figure =
      pageFigure({commandPanel(content, "Roll", "roll [rad]", &AttitudeCommand::roll,
                               {-options.angle_max, options.angle_max}),
                  commandPanel(content, "Pitch", "pitch [rad]", &AttitudeCommand::pitch,
                               {-options.angle_max, options.angle_max}),
                  commandPanel(content, "Yaw rate", "yaw rate [rad/s]", &AttitudeCommand::yaw_rate,
                               {-options.yaw_rate_max, options.yaw_rate_max}),
                  commandPanel(content, "Thrust", "thrust [N]", &AttitudeCommand::thrust,
                               {options.mass * options.thrust_min, options.mass * options.thrust_max})},
                 row_height::kPaired, 2);
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
  return thinned(truth, kCurvePoints);
}

// All of the estimate, and of the truth what is not a short push.
Panel::Range disturbanceRange(const ReportContent& content, std::size_t axis) {
  // Least width of the drawn range [m/s^2].
  constexpr double kLeastWidth = 0.02;
  // One of so many samples is cut off at each end.
  constexpr std::size_t kCut = 50;
  std::vector<double> truth;
  for (const FlightLog::Disturbance& sample : content.log.disturbances) {
    const double value = sample.acceleration[static_cast<Eigen::Index>(axis)];
    if (std::isfinite(value)) truth.push_back(value);
  }
  std::sort(truth.begin(), truth.end());
  const auto cut = static_cast<std::ptrdiff_t>(truth.size() / kCut);
  std::vector<double> values(truth.begin() + cut, truth.end() - cut);
  for (const ReplaySample& sample : content.samples) values.push_back(sample.report.axis[axis].disturbance);
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  return padded(*least, *greatest, kLeastWidth);
}

ReportFigure disturbanceFigure(const ReportContent& content) {
  ReportFigure result;
  result.heading = "Disturbance estimate";
  const bool known = !content.log.disturbances.empty();
  result.caption =
      known ? "What the observer took for wind (coloured) on top of the wind that the simulator made (grey), "
              "whose short pushes may leave the picture."
            : "What the observer took for wind; the log does not hold the true one.";
  std::vector<Panel> panels;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Panel panel = timePanel(std::string("Along ") + kAxisLetters[axis],
                            std::string("d_") + kAxisLetters[axis] + " [m/s²]");
    if (known) panel.series = {trueDisturbance(content, static_cast<Eigen::Index>(axis))};
    panel.series.push_back(
        overTime(content, "estimate", kAxisColors[axis],
                 [axis](const ReplaySample& sample) { return sample.report.axis[axis].disturbance; }));
    panel.y_range = disturbanceRange(content, axis);
    panels.push_back(panel);
  }
  result.figure = pageFigure(std::move(panels), row_height::kStacked);
  return result;
}

}  // namespace

Panel timePanel(const std::string& title, const std::string& y_label) {
  Panel panel;
  panel.title = title;
  panel.x_label = "time [s]";
  panel.y_label = y_label;
  return panel;
}

Figure pageFigure(std::vector<Panel> panels, int row_height, int columns) {
  Figure figure;
  const auto count = static_cast<int>(panels.size());
  figure.panels = std::move(panels);
  figure.columns = columns;
  figure.width = kFigureWidth;
  figure.height = row_height * std::max(1, (count + columns - 1) / columns);
  return figure;
}

Panel::Range padded(double least, double greatest, double least_width) {
  const double width = std::max(greatest - least, least_width);
  const double middle = 0.5 * (least + greatest);
  return {middle - 0.6 * width, middle + 0.6 * width};
}

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
    figures.push_back(heatFigure(content));
    const auto held = [](const AxisValidation& axis) { return axis.inside > 0; };
    if (std::any_of(content.validation.axes.begin(), content.validation.axes.end(), held)) {
      figures.push_back(distanceFigure(content));
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
