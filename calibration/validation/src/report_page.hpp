#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "identification/fit_loop.hpp"
#include "identification/provenance.hpp"
#include "map_plot/figure.hpp"
#include "validation/report.hpp"

namespace polyfly {

/// Style of the report page; no font, script or image comes from elsewhere.
extern const char* const kReportStyle;

/// Closes what the head of a page has opened.
constexpr const char* kPageEnd = "</main></body></html>\n";

/// The text with the characters replaced that mean something in HTML.
std::string escaped(const std::string& text);

/// Head of a calibration's page: title, flights with their checksums, and what speaks against the numbers.
void writeCalibrationHead(const std::vector<Provenance>& flights, const std::vector<std::string>& sentences,
                          std::ostream& out);

/// A section with one picture.
void writeFigureSection(const ReportFigure& figure, std::ostream& out);

/// A number with so many significant digits, and all digits before the point. A dash where there is no number.
std::string number(double value, int digits = 3);

/// Whether the data bound a parameter at all: its interval is finite and of a size that means something. A delay at
/// the end of its search has no interval, and is bounded.
bool isBounded(const FittedParameter& parameter);

/// The 95 % interval, or that the data do not bound the value.
std::string intervalText(const FittedParameter& parameter);

/// The value and half of its interval, or the value alone where the data do not bound it.
std::string valueWithin(const FittedParameter& parameter);

/// What one of several flights says.
struct FlightNumbers {
  std::string file;
  std::vector<FittedParameter> parameters;
};

/// A table of several flights, which have the same parameters. Writes nothing if there is none.
void writeFlights(const std::vector<FlightNumbers>& flights, std::ostream& out);

/// Mark behind a heading: whether the data support what it stands over.
std::string supportMark(bool supported);

/// The picture as an element of the page. Runs gnuplot. Throws Error.
std::string inlineSvg(const Figure& figure);

/// Writes the page as `index.html` and its numbers as `data_name` into the folder, which is made where it is
/// missing. No half a file is left. Throws Error naming the folder or the file.
void writePage(const std::string& folder, const std::string& html, const std::string& data_name,
               const std::string& data);

}  // namespace polyfly
