#pragma once

#include <string>
#include <utility>
#include <vector>

#include "polyfly_base/provenance.hpp"
#include "polyfly_base/yaml_field.hpp"

namespace polyfly {

/// A file that `calibrate` wrote.
struct CalibrationFile {
  std::string text;
  /// Path of the file, for messages.
  std::string source;
  /// Provenance of the file itself.
  Provenance provenance;
  /// True: take numbers even where the file says that its data do not support them.
  bool force = false;
};

/// A parsed calibration file (calibration/README.md). All members throw Error naming file, field and rule.
class CalibrationDocument {
 public:
  /// Refuses what is no calibration, a kind that is unknown, and unknown keys.
  explicit CalibrationDocument(const CalibrationFile& file);

  const std::string& source() const { return file_.source; }
  const std::string& kind() const { return kind_; }

  /// Refuses data of a vehicle that is known to be of another kind than `vehicle`, by force too: multirotor or
  /// fixed_wing. `target` is the file that the numbers would go into.
  void requireVehicle(const std::string& vehicle, const std::string& target) const;

  /// Whether there is a map at these keys.
  bool has(const std::vector<std::string>& place) const;
  YamlField at(const std::vector<std::string>& place) const;

  /// The map at these keys must say `supported: true`, unless the file is taken by force. The message gives
  /// its reasons.
  void requireSupport(const std::vector<std::string>& place) const;

  /// A number of a supported map.
  double supported(const std::vector<std::string>& place, const char* key) const;
  /// The same, which must be above 0; `meaning` says what a number below would mean.
  double supportedAbove0(const std::vector<std::string>& place, const char* key, const char* meaning) const;
  /// The same of a fitted parameter whose interval must be above 0, unless the file is taken by force. A
  /// negative value is refused by force too.
  double positiveParameter(const std::string& name) const;

  /// The ends of `range` of each disturbance, by the letter of its axis; requireSupport({"axes", letter}) tells
  /// whether the data support them.
  std::vector<std::pair<std::string, std::pair<double, double>>> disturbances() const;

  /// An entry of the list `provenance` of a problem file: this file, its data, and the fields that it set.
  std::string provenanceEntry(const std::vector<std::string>& fields) const;
  /// The same as a sentence.
  std::string provenanceText(const std::vector<std::string>& fields) const;

 private:
  // Both ends of the interval of a fitted parameter.
  std::pair<double, double> intervalOf(const std::string& name) const;
  // The flights that the numbers are from.
  std::vector<YamlField> flights() const;

  CalibrationFile file_;
  YamlField root_;
  std::string kind_;
};

}  // namespace polyfly
