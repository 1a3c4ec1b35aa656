#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "calibration/report.hpp"
#include "identification/provenance.hpp"
#include "map_plot/figure.hpp"

namespace polyfly {

/// Style of the report page; no font, script or image comes from elsewhere.
extern const char* const kReportStyle;

/// The text with the characters replaced that mean something in HTML.
std::string escaped(const std::string& text);

/// Head of a calibration's page: title, source with its checksum, and what speaks against the numbers.
void writeCalibrationHead(const Provenance& data, const std::vector<std::string>& sentences,
                          std::ostream& out);

/// A section with one picture.
void writeFigureSection(const ReportFigure& figure, std::ostream& out);

/// A number with so many significant digits, a dash where there is none.
std::string number(double value, int digits = 3);

/// The picture as an element of the page. Runs gnuplot. Throws Error.
std::string inlineSvg(const Figure& figure);

/// Makes a folder and those above it. Throws Error naming it.
void makeFolder(const std::string& folder);

/// Writes beside the path and renames, so that no half a file is left. Throws Error naming the path.
void writeWhole(const std::string& text, const std::filesystem::path& path);

}  // namespace polyfly
