#include "map_plot/figure.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "error_of.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

const double kNaN = std::numeric_limits<double>::quiet_NaN();

Figure smallFigure() {
  Series line;
  line.label = "speed";
  line.x = {0.0, 1.0, 2.0, 3.0};
  line.y = {0.0, 1.0, kNaN, 2.0};
  Panel panel;
  panel.title = "Speed";
  panel.x_label = "time [s]";
  panel.y_label = "v_x [m/s]";
  panel.series = {line};
  panel.bounds = {{1.5, "bound"}};
  panel.marks = {{2.0, "here"}};
  panel.bands = {{0.5, 1.0}};
  Figure figure;
  figure.panels = {panel};
  return figure;
}

// Straight pieces that a line of this colour is drawn from.
long piecesOf(Series series) {
  series.color = "#123456";
  Figure figure;
  figure.panels.emplace_back();
  figure.panels.back().series = {series};
  const std::string svg = renderFigure(figure, ImageFormat::kSvg);
  const std::size_t from = svg.find("stroke='rgb( 18,  52,  86)'");
  EXPECT_NE(from, std::string::npos);
  const std::string path = svg.substr(from, svg.find("/>", from) - from);
  return std::count(path.begin(), path.end(), 'L');
}

// Sets an environment variable for the life of the object.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name), before_(std::getenv(name)) {
    setenv(name, value, 1);
  }
  ~Environment() { setenv(name_, before_.c_str(), 1); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
  std::string before_;
};

bool exists(const std::string& path) {
  struct stat info;
  return stat(path.c_str(), &info) == 0;
}

TEST(RenderFigure, svgHoldsTitleLabelsAndLegendAsText) {
  const std::string svg = renderFigure(smallFigure(), ImageFormat::kSvg);
  for (const char* text : {"<svg", "Speed", "time [s]", "v_x [m/s]", "speed", "bound", "here", "</svg>"}) {
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  }
}

TEST(RenderFigure, nanInterruptsALine) {
  Series line;
  line.x = {0.0, 1.0, 2.0, 3.0, 4.0};
  line.y = {0.0, 1.0, 1.5, 1.0, 2.0};
  EXPECT_EQ(piecesOf(line), 4);
  line.y[2] = kNaN;
  EXPECT_EQ(piecesOf(line), 2);
}

TEST(RenderFigure, isTheSameEveryTime) {
  EXPECT_EQ(renderFigure(smallFigure(), ImageFormat::kSvg), renderFigure(smallFigure(), ImageFormat::kSvg));
}

TEST(RenderFigure, pngHasItsSignature) {
  EXPECT_EQ(renderFigure(smallFigure(), ImageFormat::kPng).substr(0, 4), "\x89PNG");
}

TEST(RenderFigure, drawsEveryKindOfElement) {
  Figure figure = smallFigure();
  Panel panel = figure.panels[0];
  panel.series.clear();
  for (const auto style :
       {Series::Style::kLine, Series::Style::kSteps, Series::Style::kPoints, Series::Style::kBars}) {
    Series series;
    series.x = {1.0, 2.0, 3.0};
    series.y = {1.0, 3.0, 2.0};
    series.style = style;
    panel.series.push_back(series);
  }
  panel.patches = {{{{{1, 1}, {2, 1}, {2, 2}}}, "#ff0000", "#000000", 1.0},
                   {{{{1, 1}, {2, 1}, {2, 2}}}, "", "#000000", 1.0}};
  panel.scale = ColorScale{0.0, 1.0, "u [rad]", {"#000000", "#ffffff"}};
  panel.log_y = true;
  panel.y_ticks = {{1.0, "first"}, {2.0, "two"}};
  figure.panels.push_back(panel);
  figure.columns = 2;
  const std::string svg = renderFigure(figure, ImageFormat::kSvg);
  EXPECT_NE(svg.find("u [rad]"), std::string::npos);
  EXPECT_NE(svg.find("two"), std::string::npos);
}

TEST(RenderFigure, textIsNeverACommand) {
  const std::string witness = testing::TempDir() + "polyfly_injected";
  Figure figure = smallFigure();
  for (const std::string& attack : {"'; system('touch " + witness + "'); '", "`touch " + witness + "`",
                                    "\nsystem 'touch " + witness + "'\n", "\"; !touch " + witness + "\n"}) {
    figure.title = figure.panels[0].title = figure.panels[0].x_label = attack;
    figure.panels[0].series[0].label = figure.panels[0].bounds[0].label = attack;
    renderFigure(figure, ImageFormat::kSvg);
    EXPECT_FALSE(exists(witness)) << attack;
  }
}

TEST(RenderFigure, refusesFiguresThatBreakTheRules) {
  Figure figure = smallFigure();
  figure.panels[0].series[0].y.pop_back();
  EXPECT_NE(errorOf([&] { renderFigure(figure, ImageFormat::kSvg); }).find("differ in size"),
            std::string::npos);
  figure.panels[0].series.clear();
  EXPECT_NE(errorOf([&] { renderFigure(figure, ImageFormat::kSvg); }).find("nothing to draw"),
            std::string::npos);
  figure.panels.clear();
  EXPECT_NE(errorOf([&] { renderFigure(figure, ImageFormat::kSvg); }).find("at least one panel"),
            std::string::npos);
  figure = smallFigure();
  figure.width = 0;
  EXPECT_NE(errorOf([&] { renderFigure(figure, ImageFormat::kSvg); }).find("pixels"), std::string::npos);
}

TEST(RenderFigure, saysWhenGnuplotIsMissing) {
  const Environment path("PATH", "/nonexistent");
  EXPECT_NE(errorOf([] { renderFigure(smallFigure(), ImageFormat::kSvg); }).find("gnuplot: "),
            std::string::npos);
}

TEST(RenderFigure, saysWhatGnuplotComplainsOf) {
  Figure figure = smallFigure();
  figure.panels[0].series[0].color = "no such colour";
  EXPECT_NE(errorOf([&] { renderFigure(figure, ImageFormat::kSvg); }).find("gnuplot: failed: "),
            std::string::npos);
}

TEST(WriteFigure, namesTheFileThatCannotBeWritten) {
  EXPECT_EQ(errorOf([] { writeFigure(smallFigure(), "picture.bmp"); }),
            "picture.bmp: ending: a picture is named .svg or .png");
  EXPECT_EQ(errorOf([] { writeFigure(smallFigure(), "/nonexistent/picture.svg"); }),
            "/nonexistent/picture.svg: cannot be written: No such file or directory");
}

TEST(Histogram, countsEveryFiniteValueOnce) {
  const std::vector<double> values = {0.5, 1.0, 1.5, 2.5, 9.0, -4.0, kNaN, 3.0};
  const Series bars = histogram(values, 0.0, 3.0, 3);
  EXPECT_EQ(bars.y, (std::vector<double>{2.0, 2.0, 3.0}));
  EXPECT_EQ(bars.x, (std::vector<double>{0.5, 1.5, 2.5}));
}

TEST(Histogram, refusesEmptyRanges) {
  EXPECT_THROW(histogram({1.0}, 1.0, 1.0, 3), Error);
  EXPECT_THROW(histogram({1.0}, 0.0, 1.0, 0), Error);
}

TEST(Thinned, keepsPeaksAndGaps) {
  Series series;
  for (int index = 0; index < 10000; ++index) {
    series.x.push_back(index);
    series.y.push_back(std::sin(0.01 * index));
  }
  series.y[4321] = 50.0;
  series.y[7777] = -50.0;
  series.y[100] = kNaN;
  const Series few = thinned(series, 400);
  EXPECT_LE(few.x.size(), 500u);
  EXPECT_EQ(few.x.front(), 0.0);
  EXPECT_EQ(few.x.back(), 9999.0);
  EXPECT_TRUE(std::is_sorted(few.x.begin(), few.x.end()));
  EXPECT_EQ(std::count(few.y.begin(), few.y.end(), 50.0), 1);
  EXPECT_EQ(std::count(few.y.begin(), few.y.end(), -50.0), 1);
  EXPECT_EQ(std::count_if(few.y.begin(), few.y.end(), [](double y) { return std::isnan(y); }), 1);
  EXPECT_EQ(thinned(few, 1000).x, few.x);
  // Both samples beside a gap stay, so that the curve ends there.
  for (const double beside : {99.0, 101.0})
    EXPECT_EQ(std::count(few.x.begin(), few.x.end(), beside), 1) << beside;
  series.y[105] = kNaN;
  const Series gaps = thinned(series, 400);
  EXPECT_EQ(std::count_if(gaps.y.begin(), gaps.y.end(), [](double y) { return std::isnan(y); }), 2);
}

}  // namespace
}  // namespace polyfly
