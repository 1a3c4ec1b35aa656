#include <algorithm>
#include <cmath>
#include <cstdio>

#include "map_plot/figure.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"
#include "polyfly_base/write_file.hpp"
#include "run_gnuplot.hpp"

namespace polyfly {
namespace {

ImageFormat formatOf(const std::string& path) {
  if (endsWith(path, ".svg")) {
    return ImageFormat::kSvg;
  }
  if (endsWith(path, ".png")) {
    return ImageFormat::kPng;
  }
  throw Error(path + ": ending: a picture is named .svg or .png");
}

// Appends every extreme of series[from, to) in order of x: first, least, greatest, last; and every gap with the
// samples on both its sides, so that the curve ends where its data end.
void appendExtremes(const Series& series, std::size_t from, std::size_t to, Series* out) {
  std::size_t least = from;
  std::size_t greatest = from;
  std::vector<std::size_t> kept = {from, to - 1};
  for (std::size_t index = from; index < to; ++index) {
    if (std::isnan(series.y[index])) {
      if (index > from) kept.push_back(index - 1);
      kept.push_back(index);
      if (index + 1 < to) kept.push_back(index + 1);
      continue;
    }
    if (!(series.y[index] >= series.y[least])) least = index;
    if (!(series.y[index] <= series.y[greatest])) greatest = index;
  }
  kept.push_back(least);
  kept.push_back(greatest);
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  for (const std::size_t index : kept) {
    out->x.push_back(series.x[index]);
    out->y.push_back(series.y[index]);
  }
}

}  // namespace

std::string renderFigure(const Figure& figure, ImageFormat format) {
  const std::string size = std::to_string(figure.width) + "," + std::to_string(figure.height);
  std::string script = figureScript(figure);
  switch (format) {
    case ImageFormat::kSvg:
      script = "set terminal svg noenhanced size " + size +
               " dynamic background '#ffffff' font 'Helvetica,13'\n" + script;
      break;
    case ImageFormat::kPng:
      script =
          "set terminal pngcairo noenhanced size " + size + " background '#ffffff' font 'Sans,10'\n" + script;
      break;
  }
  return runGnuplot(script);
}

void writeFigure(const Figure& figure, const std::string& path) {
  writeFileAtomically(path, renderFigure(figure, formatOf(path)));
}

Series thinned(const Series& series, std::size_t points) {
  constexpr std::size_t kPerStretch = 4;  // kept points
  const std::size_t stretches = std::max<std::size_t>(points / kPerStretch, 1);
  if (series.x.size() <= points || series.x.size() != series.y.size()) {
    return series;
  }
  Series result = series;
  result.x.clear();
  result.y.clear();
  const std::size_t count = series.x.size();
  for (std::size_t stretch = 0; stretch < stretches; ++stretch) {
    const std::size_t from = count * stretch / stretches;
    const std::size_t to = count * (stretch + 1) / stretches;
    if (from < to) appendExtremes(series, from, to, &result);
  }
  return result;
}

}  // namespace polyfly
