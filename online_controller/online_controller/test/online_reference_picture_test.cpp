// Draws what ReferenceSchedule makes of a trajectory that comes while another one is in force: the picture in
// FLIGHT.md. The file in doc/ must be what the code does; POLYFLY_DRAW=1 writes it anew.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "online_controller/reference/reference_schedule.hpp"
#include "project_root.hpp"

namespace {

using polyfly::ReferenceSchedule;
using polyfly::ReferenceTrajectory;
using polyfly::TrajectorySample;

constexpr double kWidth = 640.0, kRow = 130.0, kLeft = 20.0, kTop = 34.0, kHeight = 84.0;
// End of the time axis [s].
constexpr double kEnd = 6.0;
// End of the position axis [m].
constexpr double kGreatest = 1.2;

struct Panel {
  const char* title;
  // Start of the new trajectory [s].
  double start;
  // Number of points of the new trajectory.
  int points;
};

constexpr Panel kPanels[] = {
    {"starts within the old one: replaces it from its first point on", 1.75, 7},
    {"starts up to 0.5 s after its end: appended, the way between is interpolated", 3.4, 5},
    {"starts later: the last point is held at rest until then", 4.4, 4},
};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

double across(double time) { return kLeft + (kWidth - 2.0 * kLeft) * time / kEnd; }
double down(int panel, double position) {
  return panel * kRow + kTop + kHeight * (1.0 - position / kGreatest);
}

double oldWay(double time) { return 0.15 + 0.2 * time; }
double newWay(double time, double start) { return 0.95 - 0.15 * std::cos(1.5 * (time - start)); }

ReferenceTrajectory made(int points, const std::function<double(double)>& way) {
  std::vector<TrajectorySample> samples(static_cast<std::size_t>(points));
  for (int i = 0; i < points; ++i) {
    TrajectorySample& sample = samples[static_cast<std::size_t>(i)];
    sample.time = 0.5 * i;
    sample.position.x() = way(sample.time);
  }
  return ReferenceTrajectory(std::move(samples));
}

void drawPoints(std::string& svg, int panel, const ReferenceTrajectory& trajectory, double start,
                const char* style) {
  for (const TrajectorySample& sample : trajectory.samples()) {
    svg += "<circle cx=\"" + number(across(start + sample.time)) + "\" cy=\"" +
           number(down(panel, sample.position.x())) + "\" r=\"4\" " + style + "/>\n";
  }
}

// A jump is drawn as a gap: the reference is not between its ends.
void drawFlown(std::string& svg, int panel, ReferenceSchedule& schedule) {
  constexpr double kStep = 0.02, kJump = 0.1;
  double before = schedule.sample(0.0)->position.x();
  svg += "<path fill=\"none\" stroke=\"#222\" stroke-width=\"1.6\" d=\"M" + number(across(0.0)) + "," +
         number(down(panel, before));
  for (int k = 1; k * kStep <= kEnd; ++k) {
    const double now = schedule.sample(k * kStep)->position.x();
    svg += (std::abs(now - before) > kJump ? " M" : " L") + number(across(k * kStep)) + "," +
           number(down(panel, now));
    before = now;
  }
  svg += "\"/>\n";
}

std::string picture() {
  const int panels = static_cast<int>(std::size(kPanels));
  const std::string size = "width=\"" + number(kWidth) + "\" height=\"" + number(panels * kRow) + "\"";
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" " + size +
                    " font-family=\"sans-serif\" font-size=\"13\">\n<rect " + size + " fill=\"#fff\"/>\n";
  for (int panel = 0; panel < panels; ++panel) {
    const Panel& shown = kPanels[panel];
    const double base = down(panel, 0.0);
    svg += "<text x=\"" + number(kLeft) + "\" y=\"" + number(panel * kRow + 20.0) + "\">" + shown.title +
           "</text>\n<path stroke=\"#bbb\" d=\"M" + number(kLeft) + "," + number(base) + " H" +
           number(kWidth - kLeft) + "\"/>\n";
    const ReferenceTrajectory old_one = made(7, oldWay);
    const ReferenceTrajectory new_one =
        made(shown.points, [&](double time) { return newWay(shown.start + time, shown.start); });
    ReferenceSchedule schedule;
    schedule.set(old_one, 0.0);
    schedule.set(new_one, shown.start);
    drawFlown(svg, panel, schedule);
    drawPoints(svg, panel, old_one, 0.0, "fill=\"#fff\" stroke=\"#888\"");
    drawPoints(svg, panel, new_one, shown.start, "fill=\"#2a6fbb\"");
  }
  return svg + "</svg>\n";
}

TEST(ReferencePicture, IsWhatTheScheduleDoes) {
  const std::string path = polyfly::projectRoot() + "/online_controller/doc/references.svg";
  if (std::getenv("POLYFLY_DRAW") != nullptr) std::ofstream(path) << picture();
  std::ifstream stream(path);
  const std::string shown{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  EXPECT_TRUE(shown == picture()) << path << " does not show what the code does";
}

}  // namespace
