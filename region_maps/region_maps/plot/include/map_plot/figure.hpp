#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace polyfly {

/// Colours that people with any of the common colour-vision deficiencies can tell apart (Okabe and Ito).
namespace palette {
constexpr const char* kBlue = "#0072b2";
constexpr const char* kVermilion = "#d55e00";
constexpr const char* kGreen = "#009e73";
constexpr const char* kPurple = "#cc79a7";
constexpr const char* kInk = "#22272e";
constexpr const char* kGrey = "#8a929c";
}  // namespace palette

/// One curve of a panel.
struct Series {
  enum class Style {
    kLine,
    /// Holds each value until the next x.
    kSteps,
    /// A dot for each sample.
    kPoints,
  };

  /// Text in the legend. Empty: none.
  std::string label;
  std::vector<double> x;
  /// A NaN interrupts the line.
  std::vector<double> y;
  Style style = Style::kLine;
  /// Red, green and blue as six hexadecimal digits after a hash, as palette::kBlue.
  std::string color = palette::kBlue;
  /// Width of the line, or approximate diameter of a dot.
  double width = 1.8;  ///< [px]
};

/// A dashed line across the panel, a bound of y.
struct Rule {
  double value = 0.0;
  std::string label;  ///< written at the line; none if empty
  std::string color = palette::kVermilion;
};

/// A shaded interval of x.
struct Band {
  double from = 0.0;
  double to = 0.0;
  std::string color = "#fdf1dc";
};

/// Filled polygons of one colour.
struct Patches {
  /// Each a ring of (x, y), closed by the writer.
  std::vector<std::vector<std::pair<double, double>>> polygons;
  /// Fill colour, as that of a Series. Empty: outline only.
  std::string fill;
  /// Border colour. Empty: none.
  std::string border;
  /// Width of the border.
  double width = 0.6;  ///< [px]
};

/// What the fill colours of the patches mean; drawn as a bar to the right of the panel.
struct ColorScale {
  double lower = 0.0;
  double upper = 1.0;
  std::string label;
  /// Colours from lower to upper, at equal distances.
  std::vector<std::string> colors;
};

/// One coordinate system. Axes carry their unit in the label, for example "time [s]".
struct Panel {
  using Range = std::pair<double, double>;

  std::string title;
  std::string subtitle;  ///< a second, smaller line
  std::string x_label;
  std::string y_label;
  std::vector<Patches> patches;  ///< drawn first, in order
  std::vector<Band> bands;
  std::vector<Series> series;
  std::vector<Rule> bounds;
  std::optional<Range> x_range;  ///< fitted to the data otherwise
  std::optional<Range> y_range;
  std::optional<ColorScale> scale;
  bool equal_axes = false;  ///< one unit of x is as long as one of y
  bool log_y = false;
  std::vector<std::pair<double, std::string>> y_ticks;  ///< names in place of numbers, if any
};

/// A picture of panels in rows and columns.
struct Figure {
  std::string title;
  int width = 960;            ///< [px], 100..10000
  int height = 480;           ///< [px], 100..10000
  int columns = 1;            ///< >= 1
  std::vector<Panel> panels;  ///< row by row
};

enum class ImageFormat { kSvg, kPng };

/// The picture as the bytes of an image file. Runs `gnuplot`. Throws Error when it is not installed or fails, or when
/// the figure breaks a rule above (empty, sizes of x and y differ).
std::string renderFigure(const Figure& figure, ImageFormat format);

/// Renders by the ending of `path` (.svg or .png), writes beside it and renames. Throws Error naming the
/// path.
void writeFigure(const Figure& figure, const std::string& path);

/// The gnuplot commands and data of a figure: everything but the terminal. Deterministic.
std::string figureScript(const Figure& figure);

/// The same curve with at most about `points` points, keeping the extremes of each stretch, so that no peak
/// is lost.
Series thinned(const Series& series, std::size_t points);

}  // namespace polyfly
