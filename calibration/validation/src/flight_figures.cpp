#include "flight_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace polyfly {
namespace {

using Style = Series::Style;

constexpr const char* kAxisLetters[3] = {"x", "y", "z"};
constexpr const char* kReferenceColor = "#b9c1c9";
// Line width [px]. It is wider than the flown curve, so that both are seen.
constexpr double kReferenceWidth = 5.0;

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
    Panel panel = timePanel(title, label);
    Series reference = overTime(content, "reference", kReferenceColor, [value](const ReplaySample& sample) {
      return sample.has_reference ? value(sample.reference) : kNothing;
    });
    reference.width = kReferenceWidth;
    panel.series = {reference, overTime(content, "flown", palette::kBlue,
                                        [value](const ReplaySample& sample) { return value(sample.state); })};
    panels.push_back(panel);
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
    Series series;
    const double start = content.samples.front().state.stamp;
    for (const FlightLog::Command& command : content.log.commands) {
      series.x.push_back(command.stamp - start);
      series.y.push_back(command.command.*entry);
    }
    panel.series = {thinned(series, kCurvePoints)};
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

// All of the estimate, and of the truth what is not a short push.
Panel::Range disturbanceRange(const std::vector<double>& estimate, std::vector<double> truth) {
  // Least width of the drawn range [m/s^2].
  constexpr double kLeastWidth = 0.02;
  // One of so many samples is cut off at each end.
  constexpr std::size_t kCut = 50;
  std::sort(truth.begin(), truth.end());
  const auto cut = static_cast<std::ptrdiff_t>(truth.size() / kCut);
  std::vector<double> values(truth.begin() + cut, truth.end() - cut);
  values.insert(values.end(), estimate.begin(), estimate.end());
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  return padded(*least, *greatest, kLeastWidth);
}

ReportSection disturbanceFigure(const ReportContent& content) {
  std::vector<Panel> panels;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Panel panel = timePanel(std::string("Along ") + kAxisLetters[axis],
                            std::string("d_") + kAxisLetters[axis] + " [m/s²]");
    Series truth;
    truth.label = "true";
    truth.color = kReferenceColor;
    truth.width = 2.5;
    for (const FlightLog::Disturbance& sample : content.log.disturbances) {
      const double value = sample.acceleration[static_cast<Eigen::Index>(axis)];
      if (!std::isfinite(value)) continue;
      truth.x.push_back(sample.stamp - content.samples.front().state.stamp);
      truth.y.push_back(value);
    }
    if (!truth.x.empty()) panel.series = {thinned(truth, kCurvePoints)};
    panel.series.push_back(
        overTime(content, "estimate", kAxisColors[axis],
                 [axis](const ReplaySample& sample) { return sample.report.axis[axis].disturbance; }));
    panel.y_range = disturbanceRange(panel.series.back().y, truth.y);
    panels.push_back(panel);
  }
  return pictured(
      "Disturbance estimate",
      "What the observer took for wind (coloured) on top of the wind that a simulator made (grey), "
      "where the log holds it. Short pushes may leave the picture.",
      panels, row_height::kStacked);
}

ReportSection distanceFigure(const ReportContent& content) {
  // Lower end of the logarithmic axis.
  constexpr double kFloor = 1e-4;
  std::vector<Panel> panels;
  const double start = content.samples.front().state.stamp;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const AxisValidation& used = content.validation.axes[axis];
    if (used.edge_series.empty()) continue;
    Series face, edge;
    face.label = "nearest face";
    face.color = palette::kGrey;
    edge.label = "edge of the map";
    edge.color = kAxisColors[axis];
    const auto drawn = [&](double distance) {
      return std::isfinite(distance) ? std::max(distance, kFloor) : kNothing;
    };
    for (const auto& [stamp, to_face, to_edge] : used.edge_series) {
      face.x.push_back(stamp - start);
      face.y.push_back(drawn(to_face));
      edge.x.push_back(stamp - start);
      edge.y.push_back(drawn(to_edge));
    }
    Panel panel = timePanel(used.axis, "distance [-]");
    panel.log_y = true;
    panel.y_range = {kFloor, 2.0};
    for (const Excursion& excursion : used.excursions)
      panel.bands.push_back({excursion.from - start, excursion.to - start});
    panel.series = {thinned(withGaps(face), kCurvePoints), thinned(withGaps(edge), kCurvePoints)};
    panels.push_back(panel);
  }
  return pictured(
      "Distance to the map's edge",
      "How far the parameters could still have moved, along the one that is nearest to it, before "
      "the map ended (coloured), and how far the nearest face of the region was (grey); ranges are "
      "scaled to -1 .. 1. Shaded: outside the map.",
      panels, row_height::kStacked);
}

ReportSection agreementFigure(const ReportContent& content) {
  constexpr double kFloor = 1e-17;  // stands for zero on the logarithmic axis
  Panel panel = timePanel("", "|explicit − online| [unit of the input]");
  panel.log_y = true;
  double greatest = 1e-9;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const AxisValidation& used = content.validation.axes[axis];
    Series series;
    series.label = withUnit(used.input, used.input_unit);
    series.color = kAxisColors[axis];
    series.style = Style::kPoints;
    for (const auto& [stamp, difference] : used.qp_series) {
      series.x.push_back(stamp - content.samples.front().state.stamp);
      series.y.push_back(std::max(difference, kFloor));
      greatest = std::max(greatest, difference);
    }
    if (!series.x.empty()) panel.series.push_back(thinned(series, kCurvePoints));
  }
  panel.y_range = {kFloor, 10.0 * greatest};
  return pictured("Explicit against online",
                  "Difference between the map's answer and an online QP solved at the same parameters, for "
                  "every sample; the ordinate is logarithmic and equal answers lie on its lower edge.",
                  {panel}, row_height::kAlone);
}

ReportSection latencyFigure(const ReportContent& content) {
  std::array<std::vector<double>, 2> times;
  for (const AxisValidation& axis : content.validation.axes) {
    times[0].insert(times[0].end(), axis.lookups.in_order.begin(), axis.lookups.in_order.end());
    times[1].insert(times[1].end(), axis.lookups.shuffled.begin(), axis.lookups.shuffled.end());
  }
  std::vector<double> all = times[0];
  all.insert(all.end(), times[1].begin(), times[1].end());
  // The tail beyond is counted in the last bar.
  const double lower = 0.8 * *std::min_element(all.begin(), all.end());
  const double upper = std::max(1.3 * percentiles(all).p99, lower + 10.0);
  std::vector<Panel> panels;
  for (const std::vector<double>& part : times) {
    const Percentiles share = percentiles(part);
    Panel panel;
    panel.title = panels.empty() ? "In the order of the flight" : "Shuffled";
    panel.x_label = "time per look-up [ns]";
    panel.y_label = "batches";
    panel.x_range = {lower, upper};
    panel.series = {histogram(part, lower, upper, 50)};
    const std::vector<double>& counts = panel.series[0].y;
    panel.y_range = {0.0, 1.25 * *std::max_element(counts.begin(), counts.end())};  // room for the labels
    panel.marks = {{share.p50, "median " + number(share.p50) + " ns", palette::kInk},
                   {share.p99, "99 % below " + number(share.p99) + " ns"}};
    panels.push_back(panel);
  }
  return pictured("Look-up time",
                  "Time of one look-up with its law, measured in batches of 16 on the parameters of this "
                  "flight: in their order (left) and shuffled, so that neither caches nor branch prediction "
                  "help (right); the last bar also holds what took longer.",
                  panels, row_height::kAlone, 2);
}

}  // namespace

std::vector<ReportSection> flightFigures(const ReportContent& content) {
  std::vector<ReportSection> figures;
  if (content.samples.empty()) return figures;
  const auto any = [&content](std::size_t AxisValidation::*count) {
    const auto& axes = content.validation.axes;
    return std::any_of(axes.begin(), axes.end(), [count](const auto& axis) { return axis.*count > 0; });
  };
  figures.push_back(flightFigure(content));
  figures.push_back(heightFigure(content));
  if (content.validation.tracked_samples > 0) figures.push_back(errorFigure(content));
  if (!content.log.commands.empty()) figures.push_back(commandFigure(content));
  if (content.validation.tracked_samples == 0) return figures;
  for (ReportSection& figure : mapFigures(content)) figures.push_back(std::move(figure));
  const bool any_inside = any(&AxisValidation::inside);
  if (any_inside) figures.push_back(distanceFigure(content));
  if (any(&AxisValidation::qp_compared)) figures.push_back(agreementFigure(content));
  if (any_inside) figures.push_back(latencyFigure(content));
  figures.push_back(disturbanceFigure(content));
  return figures;
}

}  // namespace polyfly
