#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "validation/replay.hpp"

namespace polyfly {

// Follows a replay along its record. They go together until the replay does not know what the controller knew, and again
// once the commands agree. From then on the law is told what was sent: its estimates rest on that, and by its own commands
// it would never find the controller's.
class RecordFollower {
 public:
  // Keeps the log and the maps. `mass` [kg] scales thrust; commands agree up to `tolerance` [rad, rad/s, m/s^2].
  RecordFollower(const FlightLog& log, const AxisMaps& maps, double mass, double tolerance);

  // Judges the last sample, and takes back what it said of the last ones where these show it to be wrong. Returns what was
  // sent in place of the law's answer; nullptr: that itself.
  const AttitudeCommand* follow(std::vector<ReplaySample>* samples);

  // Whether no command agreed, in a record that does not tell that it begins in flight.
  bool isOfAnother() const { return may_begin_late_ && statuses_.empty() && !went_together_; }
  // From the begin on, differences count.
  void beginTogether() { may_begin_late_ = false; }

 private:
  bool isHole(double from, double to) const;
  bool wasLostBefore(double stamp) const;
  void judgeAltered(bool has_errors, std::vector<ReplaySample>* samples);

  AxisMaps maps_;
  double mass_;
  double tolerance_;
  std::map<double, const AttitudeCommand*> commands_;
  std::map<double, const FlightLog::Status*> statuses_;
  // Times at which the node noticed silence.
  std::set<double> silences_;
  // Stamps of odometry without command, or of commands without odometry.
  std::set<double> alone_;
  std::vector<TimeSpan> lost_;
  // Whether something is lost, and nobody knows when.
  bool is_lost_somewhere_ = false;
  // Longest time between samples that is no hole [s].
  double longest_ = 0.0;
  bool may_begin_late_ = false;
  // Why record and replay do not go together. Empty where they do.
  std::optional<Ignorance> ignorance_;
  // Where messages seem to be altered, until that is known.
  std::optional<std::size_t> first_altered_;
  // Whether the commands agreed since the last hole. Never again where one may be anywhere.
  bool is_proven_ = true;
  bool went_together_ = false;
  // Whether record and replay ever were apart.
  bool was_apart_ = false;
  // Samples in a row, up to the last one, whose commands agree.
  std::size_t agreeing_ = 0;
};

}  // namespace polyfly
