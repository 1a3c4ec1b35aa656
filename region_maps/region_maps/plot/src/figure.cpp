#include "map_plot/figure.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr int kLeastPixels = 100;
constexpr int kMostPixels = 10000;
constexpr double kPixelsPerPointSize = 6.0;
constexpr double kMostTicks = 6.0;  // on an axis of known range

// The least of 1, 2, 5, 10, 20, ... (and their tenths) that is not below `step`.
double roundStep(double step) {
  const double power = std::pow(10.0, std::floor(std::log10(step)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= step) return factor * power;
  }
  return 10.0 * power;
}

void checkFigure(const Figure& figure) {
  const auto good = [](int pixels) { return pixels >= kLeastPixels && pixels <= kMostPixels; };
  if (!good(figure.width) || !good(figure.height)) {
    throw Error("figure '" + figure.title + "': size: must be 100 to 10000 pixels each way");
  }
  if (figure.panels.empty() || figure.columns < 1) {
    throw Error("figure '" + figure.title + "': panels: at least one panel and one column are needed");
  }
  for (const Panel& panel : figure.panels) {
    if (panel.series.empty() && panel.patches.empty()) {
      throw Error("figure '" + figure.title + "': panel '" + panel.title + "': nothing to draw");
    }
    for (const Series& series : panel.series) {
      if (series.x.size() != series.y.size()) {
        throw Error("figure '" + figure.title + "': series '" + series.label + "': x and y differ in size");
      }
    }
  }
}

// Text for gnuplot: in single quotes nothing is special but the quote itself. gnuplot misreads some doubled
// quotes, so a typographic one takes its place.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char character : text) {
    if (character == '\'') {
      result += "\u2019";
    } else {
      result += static_cast<unsigned char>(character) < 0x20 ? ' ' : character;
    }
  }
  return result + "'";
}

// Writes one figure. Data blocks come first, named $d0, $d1, ... in the order of drawing.
class ScriptWriter {
 public:
  explicit ScriptWriter(const Figure& figure) : figure_(figure) {
    out_.imbue(std::locale::classic());
    out_.precision(9);
  }

  std::string write() {
    const int rows = rowCount();
    out_ << "set encoding utf8\n";
    for (const Panel& panel : figure_.panels) {
      writeData(panel);
    }
    out_ << "set multiplot layout " << rows << "," << figure_.columns;
    if (!figure_.title.empty()) {
      out_ << " title " << quoted(figure_.title) << " font ',16'";
    }
    out_ << "\n";
    for (const Panel& panel : figure_.panels) {
      writePanel(panel);
    }
    out_ << "unset multiplot\n";
    return out_.str();
  }

 private:
  int rowCount() const {
    return (static_cast<int>(figure_.panels.size()) + figure_.columns - 1) / figure_.columns;
  }

  void number(double value) {
    if (std::isnan(value)) {
      out_ << "NaN";
    } else {
      out_ << value;
    }
  }

  void writeData(const Panel& panel) {
    for (const Patches& patches : panel.patches) {
      out_ << "$d" << blocks_++ << " << EOD\n";
      for (const auto& polygon : patches.polygons) {
        for (std::size_t corner = 0; corner <= polygon.size() && !polygon.empty(); ++corner) {
          const auto& [x, y] = polygon[corner % polygon.size()];
          out_ << x << " " << y << "\n";
        }
        out_ << "\n";
      }
      out_ << "EOD\n";
    }
    for (const Series& series : panel.series) {
      out_ << "$d" << blocks_++ << " << EOD\n";
      for (std::size_t row = 0; row < series.x.size(); ++row) {
        number(series.x[row]);
        out_ << " ";
        number(series.y[row]);
        out_ << "\n";
      }
      out_ << "EOD\n";
    }
  }

  void writePanel(const Panel& panel) {
    out_ << "reset\nset encoding utf8\n"
         << "set border 3 lc rgb '#8a929c' lw 1\nset tics nomirror out scale 0.5 textcolor rgb '#22272e'\n"
         << "set grid back lc rgb '#dfe3e8' lw 0.7 dt solid\nset samples 2\n"
         << "set lmargin 11\nset tmargin " << (panel.subtitle.empty() ? 2.6 : 3.8) << "\nset rmargin "
         << (panel.scale ? 13 : 3) << "\n";
    out_ << "set style fill solid 1.0 noborder\n";
    writeAxes(panel);
    writeDecoration(panel);
    writeScale(panel);
    writePlot(panel);
  }

  void writeTitle(const Panel& panel) {
    if (!panel.title.empty()) {
      out_ << "set label " << quoted(panel.title) << " at graph 0, graph 1 left offset 0,"
           << (panel.subtitle.empty() ? "0.9" : "2.1") << " font ',14'\n";
    }
    if (!panel.subtitle.empty()) {
      out_ << "set label " << quoted(panel.subtitle) << " at graph 0, graph 1 left offset 0,0.8 font ',11'\n";
    }
  }

  void writeAxes(const Panel& panel) {
    writeTitle(panel);
    if (!panel.x_label.empty()) {
      out_ << "set xlabel " << quoted(panel.x_label) << " offset 0,0.3\n";
    }
    out_ << "set ylabel " << quoted(panel.y_label) << "\n";
    out_
        << "set key at graph 1, graph 1 right bottom horizontal maxrows 1 samplen 2 height 0.4 noautotitle\n";
    if (panel.log_y) out_ << "set logscale y\n";
    if (panel.equal_axes) out_ << "set size ratio -1\n";
    writeRange("x", panel.x_range);
    writeRange("y", panel.y_range);
    writeTicks("x", panel.x_range, false, {});
    writeTicks("y", panel.y_range, panel.log_y, panel.y_ticks);
  }

  using Names = std::vector<std::pair<double, std::string>>;

  // Where the range is known, few enough ticks that their labels do not touch; gnuplot's own choice
  // elsewhere.
  void writeTicks(const char* axis, const std::optional<Panel::Range>& range, bool logarithmic,
                  const Names& names) {
    if (!names.empty()) {
      out_ << "set " << axis << "tics (";
      for (std::size_t tick = 0; tick < names.size(); ++tick) {
        out_ << (tick == 0 ? "" : ", ") << quoted(names[tick].second) << " " << names[tick].first;
      }
      out_ << ")\n";
    } else if (range && !logarithmic && range->first < range->second) {
      out_ << "set " << axis << "tics " << roundStep((range->second - range->first) / kMostTicks) << "\n";
    }
  }

  void writeRange(const char* axis, const std::optional<Panel::Range>& range) {
    if (range) {
      out_ << "set " << axis << "range [" << range->first << ":" << range->second << "]\n";
    } else if (axis[0] == 'x') {
      out_ << "set autoscale xfix\n";
    }
  }

  void writeDecoration(const Panel& panel) {
    for (const Band& band : panel.bands) {
      out_ << "set object rectangle from " << band.from << ", graph 0 to " << band.to
           << ", graph 1 behind fc rgb " << quoted(band.color) << " fs solid noborder\n";
    }
    // Arrows without heads stand in for lines, because they may end at the panel's edge.
    for (const Rule& bound : panel.bounds) {
      out_ << "set arrow from graph 0, first " << bound.value << " to graph 1, first " << bound.value;
      writeRuleStyle(bound);
      if (!bound.label.empty()) {
        out_ << "set label " << quoted(bound.label) << " at graph 0.995, first " << bound.value
             << " right offset 0,0.5 front font ',11' textcolor rgb " << quoted(bound.color) << "\n";
      }
    }
    // Labels of neighbouring marks are staggered so that they do not cover each other.
    double height = 0.95;
    for (const Rule& mark : panel.marks) {
      out_ << "set arrow from first " << mark.value << ", graph 0 to first " << mark.value << ", graph 1";
      writeRuleStyle(mark);
      if (!mark.label.empty()) {
        out_ << "set label " << quoted(mark.label) << " at first " << mark.value << ", graph " << height
             << " left offset 0.5,0 front font ',11' textcolor rgb " << quoted(mark.color) << "\n";
        height -= 0.09;
      }
    }
  }

  void writeRuleStyle(const Rule& rule) {
    out_ << " nohead front lc rgb " << quoted(rule.color) << " lw 1.3 dt " << (rule.solid ? "solid" : "(6,4)")
         << "\n";
  }

  void writeScale(const Panel& panel) {
    if (!panel.scale) {
      return;
    }
    const ColorScale& scale = *panel.scale;
    out_ << "set cbrange [" << scale.lower << ":" << scale.upper << "]\nset cblabel " << quoted(scale.label)
         << "\nset colorbox user origin graph 1.03, graph 0 size graph 0.025, graph 1\nset palette maxcolors "
         << scale.colors.size() << " defined (";
    for (std::size_t index = 0; index < scale.colors.size(); ++index) {
      out_ << (index == 0 ? "" : ", ") << index << " " << quoted(scale.colors[index]);
    }
    out_ << ")\n";
  }

  void writePlot(const Panel& panel) {
    out_ << "plot ";
    const char* separator = "";
    if (panel.scale) {
      // Nothing visible: without an element that uses the palette its bar would not be drawn.
      out_ << "NaN with points palette notitle";
      separator = ", \\\n  ";
    }
    for (const Patches& patches : panel.patches) {
      out_ << separator << "$d" << drawn_++ << " using 1:2 ";
      writePatchStyle(patches);
      separator = ", \\\n  ";
    }
    for (const Series& series : panel.series) {
      out_ << separator << "$d" << drawn_++ << " using 1:2 ";
      writeSeriesStyle(series);
      separator = ", \\\n  ";
    }
    out_ << "\n";
  }

  void writePatchStyle(const Patches& patches) {
    if (patches.fill.empty()) {
      out_ << "with lines lw " << patches.width << " lc rgb " << quoted(patches.border);
      return;
    }
    out_ << "with filledcurves closed fc rgb " << quoted(patches.fill) << " fs solid 1.0";
    if (patches.border.empty()) {
      out_ << " noborder";
    } else {
      out_ << " border lc rgb " << quoted(patches.border) << " lw " << patches.width;
    }
  }

  void writeSeriesStyle(const Series& series) {
    switch (series.style) {
      case Series::Style::kLine:
        out_ << "with lines";
        break;
      case Series::Style::kSteps:
        out_ << "with steps";
        break;
      case Series::Style::kPoints:
        out_ << "with points pt 7 ps " << series.width / kPixelsPerPointSize;
        break;
      case Series::Style::kBars:
        out_ << "with boxes fs solid 1.0 border lc rgb '#ffffff'";
        break;
    }
    if (series.style == Series::Style::kBars) {
      out_ << " fc rgb " << quoted(series.color);
    } else {
      out_ << " lw " << series.width << " lc rgb " << quoted(series.color);
    }
    if (!series.label.empty()) {
      out_ << " title " << quoted(series.label);
    }
  }

  const Figure& figure_;
  std::ostringstream out_;
  int blocks_ = 0;  // data blocks written
  int drawn_ = 0;   // data blocks used by plot commands
};

}  // namespace

std::string figureScript(const Figure& figure) {
  checkFigure(figure);
  return ScriptWriter(figure).write();
}

}  // namespace polyfly
