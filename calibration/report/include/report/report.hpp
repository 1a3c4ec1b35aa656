#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "map_plot/figure.hpp"

namespace polyfly {

/// The numbers of a report, in the order in which they are written.
using Json = nlohmann::ordered_json;

/// A number at the head of a page.
struct ReportTile {
  std::string value;
  std::string label;
  bool good = true;
};

/// Texts under the names of their columns.
struct ReportTable {
  struct Row {
    std::vector<std::string> cells;
    /// False: the row stands out.
    bool good = true;
  };
  std::vector<std::string> columns;
  std::vector<Row> rows;
};

/// A link to a page beside the report.
struct ReportLink {
  std::string text;
  /// Relative to the report, escaped as in a URL.
  std::string address;
};

/// A part of a page: sentences, then what there is of links, a table and a picture.
struct ReportSection {
  std::string heading;
  std::vector<std::string> sentences = {};
  std::vector<ReportLink> links = {};
  std::optional<ReportTable> table = {};
  std::optional<Figure> figure = {};
};

/// What a tool found, for people: the source of page and console text.
struct Report {
  std::string title;
  /// Lines under the title.
  std::vector<std::string> sources;
  /// Only a good verdict is green.
  bool good = false;
  std::string verdict;
  /// Sentences behind the verdict.
  std::vector<std::string> reasons;
  std::vector<ReportTile> tiles;
  std::vector<ReportSection> sections;
};

/// A column of a table that shows fields of JSON objects.
struct ReportColumn {
  /// What makes a row stand out.
  enum class Rule { kNone, kZero /** any other number */, kTrue /** false */ };

  std::string name;
  /// Pointer to the field (RFC 6901).
  std::string field;
  Rule rule = Rule::kNone;
};

/// One row for each of an array's objects.
ReportTable tableOf(const Json& rows, const std::vector<ReportColumn>& columns);

/// One column for each of an array's objects, and a row for each of `lines`; `head` points to the names of the columns.
ReportTable tableAcross(const Json& objects, const std::string& head, const std::vector<ReportColumn>& lines);

/// A value for people: three significant digits, lists separated by commas, objects as "name value". A dash where
/// there is none.
std::string wordsOn(const Json& value);

/// A number with so many significant digits, and all digits before the point. A dash where there is no number.
std::string number(double value, int digits = 3);

/// The last part of a path.
std::string fileName(const std::string& path);

/// A share in percent, never rounded up to 100.
std::string percent(double share);

/// The page as one HTML text with its pictures inside. Runs gnuplot. Throws Error.
std::string toHtml(const Report& report);

/// The same without pictures, for a terminal. It ends with the verdict and its reasons.
std::string toText(const Report& report);

/// As text in UTF-8, whatever the names of files hold.
std::string dumped(const Json& json);

/// Writes the page as `index.html` and its numbers as `data_name` into the folder, which is made where it is
/// missing. No half a file is left. Throws Error naming the folder or the file.
void writePage(const std::string& folder, const Report& report, const std::string& data_name,
               const std::string& data);

}  // namespace polyfly
